//! Obstacles in the form of a body: tapered capsules, fitted to its skin.
//!
//! Design: `docs/design/characters.md`.

use bevy::math::DVec3;
use bevy::prelude::*;
use drape_solver::MeshError;
use drape_solver::error::{finite, in_range};

use crate::environment::obstacle_shape::ObstacleShape;
use crate::render::from_mesh::capsule_fit::{FittedBalls, SkinPiece};
use crate::render::from_mesh::reading::{MeshFault, VertexSkin, skin};
use crate::render::from_mesh::source::MeshParts;

/// Pieces of skin to which a capsule is fitted at most: more change nothing that could be seen.
const MOST_PIECES: usize = 2000;

/// Length of the least segment of a capsule, as a part of its radius.
const LEAST_LENGTH: f32 = 1e-3;

/// Fits a tapered capsule to the skin of each joint of a [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh): put it on the entity of the
/// character's body, beside its [`Mesh3d`], and cloth keeps off that body.
///
/// Once mesh and joints are there, each capsule is spawned as a child of its joint, as an [`Obstacle`](crate::environment::Obstacle) with
/// [`BodyCollider`] and a [`Name`]. Edit them like any others. The body gets [`BodyCollidersReport`]. A change of this component, or
/// inserting it again, replaces the capsules; removing it removes them.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn dress(mut commands: Commands, body: Entity) {
/// let colliders = BodyColliders::default().except_named("jaw").except_named("left finger*");
/// commands.entity(body).insert(BodyColliders { friction: 0.3, ..colliders });
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct BodyColliders {
    /// Names of the joints that get a capsule; all of them if it is empty. A name that ends in `*` stands for all that begin so.
    pub only: Vec<String>,
    /// Names of joints that get none, written likewise. No capsule covers their skin, nor that of lesser joints below them.
    pub except: Vec<String>,
    /// The part of the body's skin that a joint must move to get a capsule, 0 to 1. The skin of lesser joints goes with the joint
    /// above.
    pub least_share: f32,
    /// The part of a joint's skin that lies inside its capsule, above 0 to 1.
    pub coverage: f32,
    /// A length that is added to all radii, in the mesh's coordinates; below 0 it is taken off.
    pub margin: f32,
    /// Friction coefficient of the obstacles, 0 or more.
    pub friction: f32,
}

impl Default for BodyColliders {
    /// All joints that move a hundredth of the skin, nine tenths of it inside.
    fn default() -> Self {
        Self {
            only: Vec::new(),
            except: Vec::new(),
            least_share: 0.01,
            coverage: 0.9,
            margin: 0.0,
            friction: 0.5,
        }
    }
}

/// Marks an obstacle that [`BodyColliders`] have made.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
pub struct BodyCollider {
    /// The entity with the [`BodyColliders`].
    #[entities]
    pub body: Entity,
}

/// A joint of a skin, as [`BodyColliders::fit`] needs it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinJoint {
    /// Its name; empty if it has none.
    pub name: String,
    /// Index of the nearest joint above it.
    pub parent: Option<usize>,
    /// From the mesh's coordinates into the joint's.
    pub inverse_bind_pose: Mat4,
}

/// A capsule that was fitted to the skin of a joint.
#[derive(Clone, Debug)]
pub struct FittedCapsule {
    /// Index of the joint.
    pub joint: usize,
    /// Its [`ObstacleShape::TaperedCapsule`].
    pub shape: ObstacleShape,
    /// Its place in the joint's coordinates.
    pub transform: Transform,
}

/// The distances of a skin from something, in the mesh's coordinates, by area.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct SkinDistances {
    /// Half of the skin is nearer.
    pub median: f32,
    /// 99 % of the skin is nearer.
    pub percentile_99: f32,
    /// The greatest.
    pub greatest: f32,
}

/// The fit of [`BodyColliders`], in the bind pose; on the entity of the body.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct BodyCollidersReport {
    /// Number of capsules.
    pub capsules: usize,
    /// The skin outside of all capsules; 0 for what is inside.
    pub outside: SkinDistances,
    /// The skin below the surface of the capsules, which stand out by as much; 0 for what is outside. Skin within the body counts,
    /// as that of parts which overlap.
    pub inside: SkinDistances,
}

impl BodyColliders {
    /// Leaves out the joints of this name, written as in [`except`](Self::except).
    pub fn except_named(mut self, name: impl Into<String>) -> Self {
        self.except.push(name.into());
        self
    }

    /// Takes the joints of this name, written as in [`only`](Self::only), beside others that are named.
    pub fn and_named(mut self, name: impl Into<String>) -> Self {
        self.only.push(name.into());
        self
    }

    fn validate(&self) -> Result<(), MeshError> {
        in_range("least_share", self.least_share, 0.0, 1.0)?;
        in_range("coverage", self.coverage, f32::EPSILON, 1.0)?;
        finite("margin", self.margin)?;
        in_range("friction", self.friction, 0.0, f32::MAX)?;
        Ok(())
    }

    fn takes(&self, name: &str) -> bool {
        !is_listed(&self.except, name) && (self.only.is_empty() || is_listed(&self.only, name))
    }

    /// Fits the capsules to a skinned mesh, in its bind pose.
    ///
    /// # Errors
    /// [`MeshFault`] naming the fault of mesh, skin or field.
    pub fn fit(
        &self,
        mesh: &Mesh,
        joints: &[SkinJoint],
    ) -> Result<(Vec<FittedCapsule>, BodyCollidersReport), MeshFault> {
        self.validate()?;
        let pieces = skin_of_joints(mesh, joints.len())?;
        let area = |pieces: &[SkinPiece]| pieces.iter().map(|piece| piece.area).sum::<f64>();
        let least = f64::from(self.least_share) * pieces.iter().map(|pieces| area(pieces)).sum::<f64>();
        let is_taken: Vec<bool> = joints.iter().map(|joint| self.takes(&joint.name)).collect();
        let has_capsule: Vec<bool> =
            (0..joints.len()).map(|joint| is_taken[joint] && area(&pieces[joint]) >= least).collect();
        let mut skins = vec![Vec::new(); joints.len()];
        for (joint, pieces) in pieces.into_iter().enumerate().filter(|&(joint, _)| is_taken[joint]) {
            // The way up is no longer than there are joints, whatever their parents say.
            let above = core::iter::successors(Some(joint), |&joint| joints[joint].parent);
            let is_above = |&joint: &usize| joint < joints.len() && is_taken[joint];
            let mut owner = above.take(joints.len()).take_while(is_above);
            if let Some(owner) = owner.find(|&joint| has_capsule[joint]) {
                skins[owner].extend(pieces);
            }
        }
        let mut fitted: Vec<(usize, FittedBalls)> = Vec::new();
        for (joint, skin) in skins.iter().enumerate().filter(|&(joint, _)| has_capsule[joint]) {
            // An odd stride takes corners and middles of faces alike.
            let stride = skin.len().div_ceil(MOST_PIECES) | 1;
            let sample: Vec<SkinPiece> = skin.iter().step_by(stride).copied().collect();
            let Some(mut balls) = FittedBalls::of_skin(&sample, bone(joints, joint)) else { continue };
            let distances = sample.iter().map(|piece| (balls.distance(piece.place), piece.area));
            let mut distances: Vec<(f64, f64)> = distances.collect();
            let growth = quantile(&mut distances, self.coverage.into()) + f64::from(self.margin);
            let least = 0.01 * balls.radii[0].max(balls.radii[1]);
            balls.radii = balls.radii.map(|radius| (radius + growth).max(least));
            fitted.push((joint, balls));
        }
        if fitted.is_empty() {
            return Err(MeshFault::NoColliders);
        }
        let report = report(&skins, &fitted);
        let capsules = fitted.into_iter().filter_map(|(joint, balls)| capsule(joint, &balls, &joints[joint]));
        Ok((capsules.collect(), report))
    }
}

fn is_listed(names: &[String], name: &str) -> bool {
    names.iter().any(|listed| match listed.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => listed == name,
    })
}

/// The skin of each joint: the faces that follow it most.
fn skin_of_joints(mesh: &Mesh, joints: usize) -> Result<Vec<Vec<SkinPiece>>, MeshFault> {
    let parts = MeshParts::of(mesh)?;
    parts.check_faces()?;
    let vertices = skin(mesh)?.ok_or(MeshFault::NoSkin)?;
    let used = vertices.iter().flat_map(VertexSkin::used).map(|(joint, _)| usize::from(joint)).max();
    if let Some(joint) = used.filter(|&joint| joint >= joints) {
        return Err(MeshFault::NoSuchJoint { joint, count: joints });
    }
    let mut pieces = vec![Vec::new(); joints];
    let mut shares = vec![0.0_f32; joints];
    for face in &parts.faces {
        let corners = face.map(|corner| Vec3::from(parts.positions[corner as usize]).as_dvec3());
        let of_corners = || face.iter().flat_map(|&corner| vertices[corner as usize].used());
        of_corners().for_each(|(joint, weight)| shares[usize::from(joint)] += weight);
        let most = of_corners().max_by(|a, b| {
            let share = |joint: u16| shares[usize::from(joint)];
            // The first of equals.
            share(a.0).total_cmp(&share(b.0)).then(b.0.cmp(&a.0))
        });
        of_corners().for_each(|(joint, _)| shares[usize::from(joint)] = 0.0);
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let Some((joint, _)) = most.filter(|_| area > 0.0 && area.is_finite()) else { continue };
        let pieces = &mut pieces[usize::from(joint)];
        // Corners and middle, by the rule that is exact for squares.
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        pieces.extend(corners.map(|place| SkinPiece { place, area: area / 12.0 }));
        pieces.push(SkinPiece { place: middle, area: 0.75 * area });
    }
    Ok(pieces)
}

/// The way from a joint to the middle of those below it, in the mesh's coordinates.
fn bone(joints: &[SkinJoint], joint: usize) -> Option<DVec3> {
    let place = |joint: &SkinJoint| joint.inverse_bind_pose.inverse().transform_point3(Vec3::ZERO).as_dvec3();
    let below: Vec<DVec3> = joints.iter().filter(|other| other.parent == Some(joint)).map(place).collect();
    let middle = below.iter().sum::<DVec3>() / below.len() as f64;
    (!below.is_empty()).then(|| middle - place(&joints[joint])).filter(|way| way.is_finite())
}

/// The capsule in the joint's coordinates; none if its bind pose has no inverse.
fn capsule(joint: usize, balls: &FittedBalls, skin: &SkinJoint) -> Option<FittedCapsule> {
    let [bottom, top] = balls.centres.map(DVec3::as_vec3);
    let [bottom_radius, top_radius] = balls.radii.map(|radius| radius as f32);
    let length = bottom.distance(top).max(LEAST_LENGTH * bottom_radius.max(top_radius));
    let turn = Quat::from_rotation_arc(Vec3::Y, (top - bottom).normalize_or(Vec3::Y));
    let place = Mat4::from_rotation_translation(turn, bottom.midpoint(top));
    let mut transform = Transform::from_matrix(skin.inverse_bind_pose * place);
    // Exporters leave rounding in the scale. A capsule that is scaled unevenly would be no capsule.
    let even = Vec3::splat(transform.scale.element_sum() / 3.0);
    if transform.scale.abs_diff_eq(even, 1e-3 * even.x.abs()) {
        transform.scale = even;
    }
    let shape = ObstacleShape::TaperedCapsule { bottom_radius, top_radius, length };
    transform.is_finite().then_some(FittedCapsule { joint, shape, transform })
}

fn report(skins: &[Vec<SkinPiece>], fitted: &[(usize, FittedBalls)]) -> BodyCollidersReport {
    let stride = skins.iter().map(Vec::len).sum::<usize>().div_ceil(10 * MOST_PIECES) | 1;
    let pieces = skins.iter().flatten().step_by(stride);
    let distances: Vec<(f64, f64)> = pieces
        .map(|piece| {
            let distances = fitted.iter().map(|(_, balls)| balls.distance(piece.place));
            (distances.fold(f64::INFINITY, f64::min), piece.area)
        })
        .collect();
    let of = |side: f64| {
        let distances = distances.iter().map(|&(distance, area)| ((side * distance).max(0.0), area));
        let mut distances: Vec<(f64, f64)> = distances.collect();
        let [median, percentile_99, greatest] =
            [0.5, 0.99, 1.0].map(|part| quantile(&mut distances, part) as f32);
        SkinDistances { median, percentile_99, greatest }
    };
    BodyCollidersReport { capsules: fitted.len(), outside: of(1.0), inside: of(-1.0) }
}

/// The value below which a `part` of the values lies, by their weights; 0 of none.
fn quantile(values: &mut [(f64, f64)], part: f64) -> f64 {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = part * values.iter().map(|&(_, weight)| weight).sum::<f64>();
    let found = values.iter().find(|&&(_, weight)| {
        left -= weight;
        left <= 0.0
    });
    found.or(values.last()).map_or(0.0, |&(value, _)| value)
}
