//! Bodies without a surface, such as ropes and rigs, drawn as tubes.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::bones::BoneCloth;
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::prelude::*;
use bevy_drape::rig::StickKind;

/// Sides of a tube.
const SIDES: u32 = 10;
/// Thickness of a tube: radius in metres.
pub const RADIUS: f32 = 0.012;
/// Colour of tubes.
pub const COLOUR: Color = Color::srgb(0.55, 0.40, 0.26);

/// Colours by which several such bodies are told apart.
const COLOURS: [Color; 3] = [COLOUR, Color::srgb(0.62, 0.24, 0.20), Color::srgb(0.22, 0.38, 0.58)];

/// Draws every body without a surface.
pub struct TubesPlugin;

impl Plugin for TubesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, spawn_tubes).add_systems(PostUpdate, (write_tubes, despawn_tubes));
    }
}

/// An empty mesh, for [`write`].
pub fn empty() -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, Vec::<Vec3>::new())
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, Vec::<Vec3>::new())
        .with_inserted_indices(Indices::U32(Vec::new()))
}

/// The rings of a tube with round ends, from its first end to its last: which end, and the angle to its middle plane.
const RINGS: [(usize, f32); 6] =
    [(0, -FRAC_PI_2), (0, -FRAC_PI_4), (0, 0.0), (1, 0.0), (1, FRAC_PI_4), (1, FRAC_PI_2)];

/// Makes a tube of this radius (in metres), with round ends, in `mesh` for each pair of ends.
pub fn write(mesh: &mut Mesh, tubes: impl IntoIterator<Item = [Vec3; 2]>, radius: f32) {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for ends in tubes {
        let Some(along) = (ends[1] - ends[0]).try_normalize() else { continue };
        let (side, up) = along.any_orthonormal_pair();
        for (ring, (end, tilt)) in RINGS.into_iter().enumerate() {
            let first = positions.len() as u32;
            for corner in 0..SIDES {
                let angle = TAU * corner as f32 / SIDES as f32;
                let outward = side * angle.cos() + up * angle.sin();
                let normal = outward * tilt.cos() + along * tilt.sin();
                positions.push(ends[end] + normal * radius);
                normals.push(normal);
                if ring > 0 {
                    let (here, next) = (first + corner, first + (corner + 1) % SIDES);
                    let (below, below_next) = (here - SIDES, next - SIDES);
                    indices.extend([below, below_next, here, below_next, next, here]);
                }
            }
        }
    }
    mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, positions);
    mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
    mesh.insert_indices(Indices::U32(indices));
}

/// The material of tubes.
pub fn material() -> StandardMaterial {
    StandardMaterial {
        base_color: COLOUR,
        perceptual_roughness: 0.9,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}

/// Bodies that nothing else draws.
type Bare = (Without<HasTubes>, Without<RigidTetrahedron>, Without<RopeMesh>, Without<BoneCloth>);

/// Draws the structural sticks of a body without a surface.
#[derive(Component)]
struct TubesOf(Entity);

/// Marks a body whose tubes are shown.
#[derive(Component)]
struct HasTubes;

fn spawn_tubes(
    bodies: Query<(Entity, &Sticks), Bare>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut count: Local<usize>,
    mut commands: Commands,
) {
    for (entity, sticks) in &bodies {
        commands.entity(entity).insert(HasTubes);
        if sticks.faces().is_empty() {
            let base_color = COLOURS[*count % COLOURS.len()];
            *count += 1;
            commands.spawn((
                TubesOf(entity),
                Mesh3d(meshes.add(empty())),
                MeshMaterial3d(materials.add(StandardMaterial { base_color, ..material() })),
                // Its bounds change with every step.
                NoFrustumCulling,
            ));
        }
    }
}

fn write_tubes(
    tubes: Query<(&TubesOf, &Mesh3d)>,
    bodies: Query<(&Particles, &Sticks, Option<&BodySurface>)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (&TubesOf(body), mesh) in &tubes {
        let (Ok((particles, sticks, surface)), Some(mut mesh)) = (bodies.get(body), meshes.get_mut(mesh))
        else {
            continue;
        };
        let structural = sticks.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
        let ends = structural
            .flat_map(drape_solver::StickBatch::range)
            .map(|stick| sticks.stick(stick).map(|end| particles.position(end as usize)));
        // Limbs are as thick as they are simulated.
        let thickness = surface.map_or(0.0, |surface| surface.thickness);
        write(&mut mesh, ends, thickness.max(RADIUS));
    }
}

fn despawn_tubes(
    tubes: Query<(Entity, &TubesOf)>,
    bodies: Query<(), With<Particles>>,
    mut commands: Commands,
) {
    for (entity, &TubesOf(body)) in &tubes {
        if !bodies.contains(body) {
            commands.entity(entity).despawn();
        }
    }
}
