//! Measures of a cape after a step, taken from outside.

use bevy::math::Affine3A;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::prelude::*;
use bevy_drape::render::WeldedVertices;
use bevy_drape::step::MotionLimitCounts;
use drape_solver::state::measure::stretch;

use drape_examples::character::{Character, FULL_DISTANCE, cape_mesh, inverse_bind_poses};

/// The worst of all steps so far.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Worst {
    pub steps: usize,
    /// Greatest depth of a particle in a capsule, conflicts aside, in metres.
    pub depth: f32,
    /// The same of any particle.
    pub depth_of_conflicts: f32,
    /// Greatest distance of a particle beyond its painted limit, in metres.
    pub excess: f32,
    /// Greatest distance of a pin from its place, in metres.
    pub pin_error: f32,
    /// Conflicts that were counted, and steps in which fewer were counted than there were.
    pub conflicts: usize,
    pub uncounted: usize,
    /// Greatest speed besides the root's, in m/s, and strain.
    pub speed: f32,
    pub rms_stretch: f64,
    pub max_stretch: f64,
    /// Greatest distance from the hips, in metres.
    pub away: f32,
}

/// Skin of the cape's vertices.
#[derive(Resource)]
pub struct Skin {
    /// The bone of each joint of the skin, and its place in the rest pose, inverted.
    bones: Vec<(usize, Affine3A)>,
    places: Vec<[f32; 3]>,
    joints: Vec<[u16; 4]>,
    weights: Vec<[f32; 4]>,
    colours: Vec<[f32; 4]>,
    /// Smooth normals of the vertices.
    normals: Vec<Vec3>,
}

impl Default for Skin {
    fn default() -> Self {
        Self::new(&cape_mesh(), inverse_bind_poses().into_iter().enumerate())
    }
}

impl Skin {
    /// That of a mesh. `bones` are the bone and the inverse bind pose of each joint.
    pub fn new(mesh: &Mesh, bones: impl Iterator<Item = (usize, Mat4)>) -> Self {
        let read = |attribute| mesh.attribute(attribute).cloned().expect("an attribute");
        let (
            VertexAttributeValues::Float32x3(places),
            VertexAttributeValues::Uint16x4(joints),
            VertexAttributeValues::Float32x4(weights),
            VertexAttributeValues::Float32x4(colours),
        ) = (
            read(Mesh::ATTRIBUTE_POSITION),
            read(Mesh::ATTRIBUTE_JOINT_INDEX),
            read(Mesh::ATTRIBUTE_JOINT_WEIGHT),
            read(Mesh::ATTRIBUTE_COLOR),
        )
        else {
            panic!("another mesh");
        };
        let mut normals = vec![Vec3::ZERO; places.len()];
        let corners: Vec<usize> = mesh.indices().expect("indices").iter().collect();
        for &[a, b, c] in corners.as_chunks().0 {
            for [at, next, last] in [[a, b, c], [b, c, a], [c, a, b]] {
                let [next, last] = [next, last].map(|end| Vec3::from(places[end]) - Vec3::from(places[at]));
                // Max's weights (1999).
                normals[at] += next.cross(last) / (next.length_squared() * last.length_squared());
            }
        }
        let bones = bones.map(|(bone, inverse)| (bone, Affine3A::from_mat4(inverse))).collect();
        Self { bones, places, joints, weights, colours, normals }
    }

    /// The animated place of each vertex.
    pub fn posed(&self, joint: impl Fn(usize) -> Affine3A) -> Vec<Vec3> {
        let matrices: Vec<Affine3A> =
            self.bones.iter().map(|&(bone, inverse)| joint(bone) * inverse).collect();
        let vertices = self.places.iter().zip(&self.joints).zip(&self.weights);
        let posed = vertices.map(|((&place, joints), weights)| {
            let parts = joints.iter().zip(weights);
            parts.map(|(&j, &w)| matrices[usize::from(j)].transform_point3(place.into()) * w).sum()
        });
        posed.collect()
    }
}

impl Skin {
    /// The direction outwards at the animated place of each vertex; joints only turn.
    pub fn normals(&self, joint: impl Fn(usize) -> Affine3A) -> Vec<Vec3> {
        let vertices = self.normals.iter().zip(&self.joints).zip(&self.weights);
        let turned = vertices.map(|((&normal, joints), weights)| {
            let parts = joints.iter().zip(weights);
            // The inverse transpose of the blend, which squeezes a little.
            let blend: Mat3 = parts.fold(Mat3::ZERO, |sum, (&j, &w)| {
                sum + Mat3::from(joint(self.bones[usize::from(j)].0).matrix3) * w
            });
            (blend.inverse().transpose() * normal).normalize()
        });
        turned.collect()
    }

    /// The painted limit of a vertex, as a part of the full distance.
    pub fn limit(&self, vertex: usize) -> f32 {
        self.colours[vertex][1]
    }
}

/// At the end of each step.
pub fn measure(
    character: Res<Character>,
    skin: Res<Skin>,
    places: Query<&GlobalTransform>,
    capes: Query<(&Particles, &Sticks, &WeldedVertices, &Fabric, Option<&BodySurface>)>,
    obstacles: Query<&Obstacle>,
    counts: Res<MotionLimitCounts>,
    mut worst: ResMut<Worst>,
) {
    let Ok((particles, sticks, welded, fabric, surface)) = capes.get(character.cape) else { return };
    let place = |entity: Entity| places.get(entity).expect("placed").affine();
    let posed = skin.posed(|joint| place(character.joints[joint]));
    let thickness = surface.copied().unwrap_or(fabric.surface()).thickness;
    let capsules = character.capsules.iter().map(|&capsule| {
        let obstacle = obstacles.get(capsule).expect("a capsule");
        let shape = obstacle.shape.solid(None).expect("valid").expect("a capsule");
        (place(capsule).inverse(), shape)
    });
    let capsules: Vec<_> = capsules.collect();
    let mut deep = 0;
    for (vertex, target) in posed.iter().enumerate() {
        let i = welded.particle(vertex).expect("a corner");
        let position = particles.position(i);
        let limit = skin.limit(vertex) * FULL_DISTANCE;
        let off = position.distance(*target);
        if particles.is_pinned(i) {
            worst.pin_error = worst.pin_error.max(off);
            continue;
        }
        worst.excess = worst.excess.max(off - limit);
        let depth = capsules.iter().map(|(pose, shape)| -shape.distance(pose.transform_point3(position)));
        let depth = depth.fold(f32::NEG_INFINITY, f32::max);
        worst.depth_of_conflicts = worst.depth_of_conflicts.max(depth);
        let is_at_limit = off > limit - 1e-4;
        if depth + thickness > 2e-3 && is_at_limit {
            deep += 1;
        } else {
            worst.depth = worst.depth.max(depth);
        }
    }
    worst.steps += 1;
    worst.conflicts += counts.conflicts;
    worst.uncounted += usize::from(counts.conflicts < deep);
    let stretch = stretch(particles, sticks);
    worst.rms_stretch = worst.rms_stretch.max(stretch.rms);
    worst.max_stretch = worst.max_stretch.max(stretch.max);
    worst.speed = worst.speed.max(particles.greatest_speed());
    let hips = Vec3::from(place(character.joints[0]).translation);
    worst.away = particles.positions().map(|position| position.distance(hips)).fold(worst.away, f32::max);
}
