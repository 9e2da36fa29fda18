//! A cape without capsules below it: backstops keep it behind its wearer's back, and drives at its animated pose.

use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::prelude::*;
use bevy_drape::render::{BackstopPaint, PoseDrivePaint, WeldedVertices};
use bevy_drape::snapshot::Snapshot;
use drape_solver::StateHasher;

use crate::measure::Skin;
use crate::*;
use drape_examples::character::{self, Character, FULL_DISTANCE};

/// How far behind its animated place a vertex may go, in metres, and the radius of its sphere.
const BACKSTOP: BackstopPaint =
    BackstopPaint { radius: None, full_radius: 0.4, distance: None, full_distance: 0.02 };

/// The character in a cape with this paint besides its limits, without a capsule.
fn dressed(backstop: Option<BackstopPaint>, pose_drive: Option<PoseDrivePaint>) -> (App, Character) {
    let mut app = app();
    let character = character::spawn(app.world_mut(), BodySurface { drag: 1.0, ..default() });
    let mut cape = app.world_mut().get_mut::<ClothMesh>(character.cape).expect("a cape");
    cape.paint = ClothPaint { backstop, pose_drive, ..cape.paint.clone() };
    for &capsule in &character.capsules {
        app.world_mut().despawn(capsule);
    }
    app.finish();
    app.cleanup();
    one_step_a_frame(&mut app);
    (app, character)
}

/// Goes on with the animation by this many steps.
fn go(app: &mut App, character: &mut Character, steps: usize, mut look: impl FnMut(&App, &Character)) {
    for _ in 0..steps {
        character.advance(character.time + 1.0 / 60.0);
        character.write(app.world_mut());
        app.update();
        look(app, character);
    }
}

/// Measures of a cape after a step, in metres.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    /// Greatest depth of a particle in the sphere behind it.
    depth: f32,
    /// Greatest distance beyond a limit.
    excess: f32,
    /// Mean distance from the animated place.
    mean: f32,
}

/// Measures the cape against the skin of its mesh, which is worked out here anew.
fn off(app: &App, character: &Character, skin: &Skin) -> Off {
    let matrices = |joint: usize| global(app, character.joints[joint]).affine();
    let (posed, normals) = (skin.posed(matrices), skin.normals(matrices));
    let body = particles(app, character.cape);
    let welded = app.world().get::<WeldedVertices>(character.cape).expect("built");
    let mut off = Off::default();
    for (vertex, (place, normal)) in posed.iter().zip(normals).enumerate() {
        let i = welded.particle(vertex).expect("a corner");
        let away = body.position(i).distance(*place);
        off.mean += away / posed.len() as f32;
        if body.is_pinned(i) {
            continue;
        }
        let centre = *place - normal * (BACKSTOP.full_distance + BACKSTOP.full_radius);
        off.depth = off.depth.max(BACKSTOP.full_radius - body.position(i).distance(centre));
        off.excess = off.excess.max(away - skin.limit(vertex) * FULL_DISTANCE);
    }
    off
}

/// The worst while it runs, turns about and jumps; after a second in which it puts the cape on.
fn worst_of_a_run(backstop: Option<BackstopPaint>, pose_drive: Option<PoseDrivePaint>) -> Off {
    let (mut app, mut character) = dressed(backstop, pose_drive);
    character.advance(8.5);
    go(&mut app, &mut character, 60, |_, _| {});
    let (mut worst, skin) = (Off::default(), Skin::default());
    go(&mut app, &mut character, 420, |app, character| {
        let now = off(app, character, &skin);
        worst.depth = worst.depth.max(now.depth);
        worst.excess = worst.excess.max(now.excess);
        worst.mean += now.mean / 420.0;
    });
    assert!(app.world().resource::<Refusals>().is_empty());
    worst
}

/// No particle is behind its backstop, and none beyond its limit, in any step of a run with jumps and an about-turn. Without
/// backstops the cape sinks into the back.
#[test]
fn no_particle_of_a_running_characters_cape_is_behind_its_backstop() {
    let worst = worst_of_a_run(Some(BACKSTOP), None);
    println!("cape: with backstops {worst:?}");
    assert!(worst.depth < 1e-4, "{} m behind a backstop", worst.depth);
    assert!(worst.excess < 1e-4, "{} m beyond a limit", worst.excess);
    let without = worst_of_a_run(None, None);
    println!("cape: without {without:?}");
    assert!(without.depth > 0.1, "{} m: nothing to keep it out of", without.depth);
}

/// A drive draws the cape to its animated pose, the nearer the stiffer it is.
#[test]
fn a_driven_cape_is_nearer_to_its_animation() {
    let mean = |pose_drive| worst_of_a_run(Some(BACKSTOP), pose_drive).mean;
    let drive = |full_frequency| Some(PoseDrivePaint { full_frequency, ..default() });
    let [free, soft, stiff] = [None, drive(10.0), drive(60.0)].map(mean);
    println!("cape: {free} m off, driven softly {soft} m, stiffly {stiff} m");
    assert!(soft < 0.8 * free && stiff < 0.3 * free, "{free} {soft} {stiff}");
}

#[test]
fn backstops_and_drives_are_teleported_with_their_character() {
    for is_marked in [false, true] {
        let (mut app, mut character) = dressed(Some(BACKSTOP), Some(default()));
        app.world_mut().entity_mut(character.cape).insert(WorldMotion::of(character.root));
        go(&mut app, &mut character, 60, |_, _| {});
        character.place += if is_marked { Vec3::X } else { Vec3::new(40.0, 0.0, 3.0) };
        character.heading += 2.0;
        if is_marked {
            app.world_mut().entity_mut(character.cape).insert(TeleportCloth);
        }
        let skin = Skin::default();
        go(&mut app, &mut character, 60, |app, character| {
            let speed = particles(app, character.cape).greatest_speed();
            assert!(speed < 10.0, "{speed} m/s, marked: {is_marked}");
            assert!(off(app, character, &skin).depth < 1e-4);
        });
    }
}

#[test]
fn a_restored_world_with_backstops_and_drives_goes_on_with_the_same_bits() {
    let (mut app, mut character) = dressed(Some(BACKSTOP), Some(default()));
    let hash = |app: &App, cape: Entity| StateHasher::new().particles(particles(app, cape)).finish();
    go(&mut app, &mut character, 60, |_, _| {});
    let (snapshot, there) = (Snapshot::take(app.world_mut()), character.clone());
    go(&mut app, &mut character, 60, |_, _| {});
    let expected = hash(&app, character.cape);
    snapshot.restore(app.world_mut()).expect("the same scene");
    let mut character = there;
    go(&mut app, &mut character, 60, |_, _| {});
    assert_eq!(hash(&app, character.cape), expected);
}
