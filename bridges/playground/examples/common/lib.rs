//! The playgrounds of all engines share the places and colours of their scene, its curtain and net, its camera, and the verdict at
//! its end.
#![cfg(feature = "examples")]

use core::f32::consts::{FRAC_PI_2, FRAC_PI_3};

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_bridge::{InertialFrame, ObstacleOf};
use drape_examples::feature::{Feature, Paint, Verdict};

/// Colour of posts, beams and the wrecking ball.
pub const STEEL: Paint = Paint::rgb(0.33, 0.35, 0.38);
/// Colour of crates.
pub const WOOD: Paint = Paint::rgb(0.62, 0.42, 0.22);
/// Colour of the curtain.
const VELVET: Paint = Paint::rgb(0.60, 0.13, 0.16);
/// Colour of the net.
const CANVAS: Paint = Paint::rgb(0.16, 0.42, 0.46);
/// Colour of the rope.
pub const HEMP: Paint = Paint::rgb(0.72, 0.58, 0.34);
/// Colour of the character.
pub const COAT: Paint = Paint::rgb(0.92, 0.72, 0.22);

/// Places and sizes in metres of all that stands fast.
pub const FIXTURES: [(Vec3, Vec3); 13] = [
    // The frame of the net.
    (Vec3::new(-3.24, 0.55, -0.84), Vec3::new(0.08, 1.1, 0.08)),
    (Vec3::new(-1.56, 0.55, -0.84), Vec3::new(0.08, 1.1, 0.08)),
    (Vec3::new(-3.24, 0.55, 0.84), Vec3::new(0.08, 1.1, 0.08)),
    (Vec3::new(-1.56, 0.55, 0.84), Vec3::new(0.08, 1.1, 0.08)),
    (Vec3::new(-2.4, 1.08, -0.84), Vec3::new(1.6, 0.05, 0.06)),
    (Vec3::new(-2.4, 1.08, 0.84), Vec3::new(1.6, 0.05, 0.06)),
    (Vec3::new(-3.24, 1.08, 0.0), Vec3::new(0.06, 0.05, 1.6)),
    (Vec3::new(-1.56, 1.08, 0.0), Vec3::new(0.06, 0.05, 1.6)),
    // The frame of the curtain.
    (Vec3::new(-0.94, 1.1, 0.0), Vec3::new(0.08, 2.2, 0.08)),
    (Vec3::new(0.94, 1.1, 0.0), Vec3::new(0.08, 2.2, 0.08)),
    (Vec3::new(0.0, 2.24, 0.0), Vec3::new(1.96, 0.08, 0.08)),
    // The crane.
    (Vec3::new(2.6, 1.4, -1.2), Vec3::new(0.14, 2.8, 0.14)),
    (Vec3::new(2.6, 2.74, -0.53), Vec3::new(0.12, 0.12, 1.2)),
];

/// The middle of the net.
pub const NET: Vec3 = Vec3::new(-2.4, 1.08, 0.0);
/// Side of the net in metres.
const NET_SIDE: f32 = 1.6;
/// Side of a crate in metres.
pub const CRATE: f32 = 0.3;
/// Density of crates in kg/m^3.
pub const WOOD_DENSITY: f32 = 150.0;
/// Height of the upper edge of the curtain in metres.
const RAIL: f32 = 2.18;
/// Size of each of the two halves of the curtain in metres.
const HALF_CURTAIN: Vec2 = Vec2::new(0.88, 2.1);
/// Radius of the character in metres.
pub const CHARACTER_RADIUS: f32 = 0.25;
/// Length of the character between the middles of its round ends, in metres.
pub const CHARACTER_LENGTH: f32 = 1.1;
/// Start of the character, which walks along Z.
pub const CHARACTER: Vec3 = Vec3::new(0.0, 0.81, -0.9);
/// Speed of the character in m/s.
pub const WALK: f32 = 1.0;
/// The point that the rope hangs on.
pub const HOOK: Vec3 = Vec3::new(2.6, 2.66, 0.0);
/// Length of the rope to the middle of the ball, in metres.
pub const ROPE: f32 = 2.0;
/// Radius of the ball in metres.
pub const BALL_RADIUS: f32 = 0.22;
/// Density of the ball in kg/m^3.
pub const BALL_DENSITY: f32 = 900.0;

/// All particles along the border of a cloth.
fn border(cloth: &Cloth) -> ClothPins {
    let UVec2 { x: columns, y: rows } = cloth.particles;
    let ends = |index: u32, count: u32| index == 0 || index == count - 1;
    let is_border = |i: &u32| ends(i % columns, columns) || ends(i / columns, rows);
    ClothPins::Indices((0..columns * rows).filter(is_border).collect())
}

/// Hangs two halves of a curtain that meet in the middle.
fn hang_curtain(mut commands: Commands) {
    for side in [-0.5, 0.5] {
        let half = Cloth { size: HALF_CURTAIN, ..default() }.with_spacing(0.04);
        let place = Transform::from_xyz(side * 1.02 * HALF_CURTAIN.x, RAIL - 0.5 * HALF_CURTAIN.y, 0.0);
        commands.spawn((half, Fabric::COTTON, place, VELVET));
    }
}

/// Stretches a net in its frame.
fn stretch_net(mut commands: Commands) {
    let lying = Quat::from_rotation_x(-FRAC_PI_2);
    let net = Cloth::new(NET_SIDE, NET_SIDE);
    let net = net.clone().with_pins(border(&net));
    commands.spawn((net, Fabric::NET, Transform::from_translation(NET).with_rotation(lying), CANVAS));
}

/// Crates above the net.
pub fn falling_crates() -> impl Iterator<Item = Transform> {
    (0..4).map(|index| {
        let angle = 2.0 * index as f32;
        let aside = Quat::from_rotation_y(-angle) * Vec3::X * 0.3;
        let turn = Quat::from_euler(EulerRot::XYZ, 0.3 * angle, angle, 0.2);
        Transform::from_translation(NET + aside + Vec3::Y * (0.25 + 0.35 * index as f32)).with_rotation(turn)
    })
}

/// A wall of crates in the way of the ball.
pub fn stacked_crates() -> impl Iterator<Item = Transform> {
    let rows = (0..3).flat_map(|row| (0..3 - row).map(move |column| (row, column)));
    rows.map(|(row, column)| {
        let aside = column as f32 - 0.5 * (2 - row) as f32;
        Transform::from_xyz(HOOK.x - 0.65, CRATE * (0.5 + row as f32), 1.04 * CRATE * aside)
    })
}

/// The ball at the end of its rope, drawn aside.
pub fn ball_place() -> Vec3 {
    HOOK + Quat::from_rotation_z(FRAC_PI_3) * Vec3::NEG_Y * ROPE
}

/// A crate that the net catches.
#[derive(Component)]
pub struct Caught;

/// A crate that the ball hits, and where it stood.
#[derive(Component)]
pub struct Stacked(pub Vec3);

/// The wrecking ball.
#[derive(Component)]
pub struct WreckingBall;

/// The playground of an engine, of which `build` adds everything.
pub const fn playground(title: &'static str, build: fn(&mut App)) -> Feature {
    Feature {
        title,
        controls: "",
        eye: Vec3::new(0.9, 2.75, 5.75),
        target: Vec3::new(-0.12, 1.15, 0.0),
        picture_time: 1.1,
        build,
    }
}

/// Spawns the cloth, draws the scene by its obstacles, and judges it at its end.
pub struct PlaygroundPlugin;

impl Plugin for PlaygroundPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Verdict(judge))
            .add_observer(paint_obstacle)
            .add_systems(Startup, (hang_curtain, stretch_net));
    }
}

/// Obstacles are drawn. That of a dynamic body is disabled while it is far from cloth, so another is drawn, which moves with the body and
/// touches nothing.
pub fn paint_obstacle(
    added: On<Add<ObstacleOf>>,
    obstacles: Query<(&ObstacleOf, &Obstacle, &InertialFrame)>,
    paints: Query<&Paint>,
    mut commands: Commands,
) {
    let Ok((of, obstacle, frame)) = obstacles.get(added.entity) else { return };
    let Ok(&paint) = paints.get(of.0) else { return };
    let at = Transform { translation: frame.centre, rotation: frame.axes, ..default() };
    let looks = (obstacle.clone(), DrapeLayers::new(0, 0), paint, at);
    commands.entity(of.0).insert_if_new(Visibility::default()).with_child(looks);
    commands.entity(added.entity).insert(Mesh3d::default());
}

fn judge(world: &mut World) -> Result<String, String> {
    let mut caught = world.query_filtered::<&Transform, With<Caught>>();
    let mut lowest = f32::INFINITY;
    for at in caught.iter(world).map(|place| place.translation) {
        let aside = (at - NET).abs();
        if !(at.is_finite() && aside.x.max(aside.z) < 0.5 * NET_SIDE && at.y > CRATE) {
            return Err(format!("a crate is not in the net, but at {at}"));
        }
        lowest = lowest.min(at.y);
    }
    let mut scattered = 0;
    for (Stacked(from), place) in world.query::<(&Stacked, &Transform)>().iter(world) {
        let at = place.translation;
        if !(at.is_finite() && at.y > 0.4 * CRATE) {
            return Err(format!("a crate of the stack is below the floor, at {at}"));
        }
        scattered += usize::from(at.distance(*from) > 0.5 * CRATE);
    }
    let mut balls = world.query_filtered::<&Transform, With<WreckingBall>>();
    let ball = balls.single(world).map_err(|error| error.to_string())?;
    let rope = ball.translation.distance(HOOK);
    if rope.is_nan() || rope > 1.01 * ROPE {
        return Err(format!("the ball is {rope} m from its hook, on a rope of {ROPE} m"));
    }
    Ok(format!(
        "the net holds its crates {lowest:.2} m above the floor; the ball scattered {scattered} crates; its rope is {rope:.3} m long"
    ))
}
