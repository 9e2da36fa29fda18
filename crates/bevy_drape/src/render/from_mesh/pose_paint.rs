//! Backstops and drives painted on the vertices of a mesh.

use bevy::prelude::*;
use drape_solver::{Backstop, MeshCloth, PoseDrive};

use crate::attach::animated_pose::turned_normal;
use crate::render::from_mesh::paint::{ClothPaint, PaintChannel, paint};
use crate::render::from_mesh::reading::{MeshFault, faces, positions};

/// Backstops of a cloth: a sphere behind the animated position of each vertex, which the vertex may not enter. They keep a
/// cape out of the back below it at the cost of a sphere a vertex, and work where capsules fit badly.
///
/// Behind is against the smooth normal of the mesh's faces, which must look away from the body. The sphere has no friction.
/// Unreal's and Unity's cloth have the same numbers, in other units.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct BackstopPaint {
    /// Radius of the spheres: 1 stands for [`full_radius`](Self::full_radius); 0, black, is no backstop. None, the default:
    /// the full radius everywhere.
    pub radius: Option<PaintChannel>,
    /// Radius in metres that a value of 1 stands for, 0 to 1e6; 0.5 by default. Larger spheres are flatter, and vertices do
    /// not slip around them; above some 30 m rounding is felt.
    pub full_radius: f32,
    /// Distance behind its animated position that a vertex may go: 1 stands for [`full_distance`](Self::full_distance). None,
    /// the default: the full distance everywhere.
    pub distance: Option<PaintChannel>,
    /// Distance in metres that a value of 1 stands for, to 1e6; 0, the default, stops each vertex at its animated position. Below 0
    /// it stops in front of it.
    pub full_distance: f32,
}

impl Default for BackstopPaint {
    fn default() -> Self {
        Self { radius: None, full_radius: 0.5, distance: None, full_distance: 0.0 }
    }
}

/// Drives of a cloth towards its animated pose: a damped spring from each vertex to its animated position, which bends the
/// cloth to the will of an animator without holding it as a pin does. The motion is the same in steps and substeps of any
/// length, and stable for any number.
///
/// Unreal's cloth has an animation drive, in numbers without a unit.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct PoseDrivePaint {
    /// Angular frequency: 1 stands for [`full_frequency`](Self::full_frequency); 0, black, is no drive. None, the default: the
    /// full frequency everywhere.
    pub frequency: Option<PaintChannel>,
    /// Angular frequency in rad/s that a value of 1 stands for, 0 to 10 000; 10 by default. Left alone, the vertex comes back
    /// within some `3 / frequency` seconds, and sags under gravity by `9.81 / frequency^2` metres.
    pub full_frequency: f32,
    /// Damping ratio: 1 stands for [`full_damping`](Self::full_damping). None, the default: the full damping everywhere.
    pub damping: Option<PaintChannel>,
    /// Damping ratio that a value of 1 stands for, 0 to 1000: 0 swings for ever, 1, the default, comes back as fast as can
    /// be without swinging over, more comes back slower.
    pub full_damping: f32,
}

impl Default for PoseDrivePaint {
    fn default() -> Self {
        Self { frequency: None, full_frequency: 10.0, damping: None, full_damping: 1.0 }
    }
}

impl ClothPaint {
    /// The channels that say how the cloth follows an animation.
    pub(super) fn pose_channels(&self) -> impl Iterator<Item = &PaintChannel> {
        let backstop = self.backstop.iter().flat_map(|paint| [&paint.radius, &paint.distance]);
        let drive = self.pose_drive.iter().flat_map(|paint| [&paint.frequency, &paint.damping]);
        [&self.max_distance].into_iter().chain(backstop).chain(drive).flatten()
    }

    /// Gives free particles their painted limits, backstops and drives, at their places. `transform` takes the mesh there.
    pub(super) fn follow_pose(
        &self,
        cloth: &mut MeshCloth,
        mesh: &Mesh,
        transform: &GlobalTransform,
    ) -> Result<(), MeshFault> {
        self.limit(cloth, mesh)?;
        self.stop(cloth, mesh, transform)?;
        self.drive(cloth, mesh)
    }

    /// Limits the motion of free particles. Of several vertices in one place the least limit counts.
    fn limit(&self, cloth: &mut MeshCloth, mesh: &Mesh) -> Result<(), MeshFault> {
        let Some(channel) = &self.max_distance else { return Ok(()) };
        if !(self.full_distance >= 0.0 && self.full_distance.is_finite()) {
            return Err(MeshFault::BadFullDistance(self.full_distance));
        }
        let painted = paint(mesh, channel, cloth.particle_of_vertex.len())?;
        for (value, particle) in painted.into_iter().zip(&cloth.particle_of_vertex) {
            let Some(i) = particle.map(|particle| particle as usize) else { continue };
            let distance = value.clamp(0.0, 1.0) * self.full_distance;
            let known = cloth.particles.motion_limit(i).map_or(f32::INFINITY, |(_, known)| known);
            if !cloth.particles.is_pinned(i) && distance < known {
                let place = cloth.particles.position(i);
                cloth.particles.set_motion_limit(i, place, distance);
            }
        }
        Ok(())
    }

    /// Puts backstops behind free particles. Of several vertices in one place the largest sphere counts. Where faces look
    /// in opposite directions there is no normal, and no backstop.
    fn stop(&self, cloth: &mut MeshCloth, mesh: &Mesh, transform: &GlobalTransform) -> Result<(), MeshFault> {
        let Some(paint) = &self.backstop else { return Ok(()) };
        let full = Backstop { distance: paint.full_distance, radius: paint.full_radius };
        full.validate().map_err(MeshFault::BadPaint)?;
        let vertices = cloth.particle_of_vertex.len();
        let radii = parts(mesh, paint.radius.as_ref(), vertices)?;
        let distances = parts(mesh, paint.distance.as_ref(), vertices)?;
        let normals = particle_normals(cloth, mesh)?;
        let matrix = transform.affine().matrix3;
        for vertex in 0..vertices {
            let Some(i) = cloth.particle_of_vertex[vertex].map(|particle| particle as usize) else {
                continue;
            };
            let backstop =
                Backstop { distance: distances[vertex] * full.distance, radius: radii[vertex] * full.radius };
            let known = cloth.particles.backstop(i).map_or(0.0, |(_, known)| known.radius);
            let normal = turned_normal(&matrix, normals[i]);
            let is_other = backstop.radius > known && normal != Vec3::ZERO;
            if is_other && !cloth.particles.is_pinned(i) {
                let place = cloth.particles.position(i);
                cloth.particles.set_backstop(i, place, normal, backstop).map_err(MeshFault::BadPaint)?;
            }
        }
        Ok(())
    }

    /// Drives free particles. Of several vertices in one place the highest frequency counts.
    fn drive(&self, cloth: &mut MeshCloth, mesh: &Mesh) -> Result<(), MeshFault> {
        let Some(paint) = &self.pose_drive else { return Ok(()) };
        let full = PoseDrive { angular_frequency: paint.full_frequency, damping_ratio: paint.full_damping };
        full.validate().map_err(MeshFault::BadPaint)?;
        let vertices = cloth.particle_of_vertex.len();
        let frequencies = parts(mesh, paint.frequency.as_ref(), vertices)?;
        let dampings = parts(mesh, paint.damping.as_ref(), vertices)?;
        for vertex in 0..vertices {
            let Some(i) = cloth.particle_of_vertex[vertex].map(|particle| particle as usize) else {
                continue;
            };
            let drive = PoseDrive {
                angular_frequency: frequencies[vertex] * full.angular_frequency,
                damping_ratio: dampings[vertex] * full.damping_ratio,
            };
            let known = cloth.particles.pose_drive(i).map_or(0.0, |(_, known)| known.angular_frequency);
            if drive.angular_frequency > known && !cloth.particles.is_pinned(i) {
                let place = cloth.particles.position(i);
                cloth.particles.set_pose_drive(i, place, drive).map_err(MeshFault::BadPaint)?;
            }
        }
        Ok(())
    }
}

/// Returns the painted part of each vertex, 0 to 1: all without a channel, nothing on a mesh without colours.
fn parts(mesh: &Mesh, channel: Option<&PaintChannel>, vertices: usize) -> Result<Vec<f32>, MeshFault> {
    let Some(channel) = channel else { return Ok(vec![1.0; vertices]) };
    let mut painted = paint(mesh, channel, vertices)?;
    painted.resize(vertices, 0.0);
    painted.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
    Ok(painted)
}

/// Returns the smooth normal of each particle in the mesh's coordinates; zero where there is none. Its faces count by Max's
/// weights (1999), which do not ask by which diagonal a square is cut.
pub(super) fn particle_normals(cloth: &MeshCloth, mesh: &Mesh) -> Result<Vec<Vec3>, MeshFault> {
    let places = positions(mesh)?;
    let mut normals = vec![Vec3::ZERO; cloth.particles.len()];
    for face in faces(mesh, places.len())? {
        let [a, b, c] = face.map(|vertex| places.get(vertex as usize).copied().map(Vec3::from));
        let (Some(a), Some(b), Some(c)) = (a, b, c) else { continue };
        for (vertex, [at, next, last]) in face.into_iter().zip([[a, b, c], [b, c, a], [c, a, b]]) {
            let (next, last) = (next - at, last - at);
            let lengths = next.length_squared() * last.length_squared();
            if let Some(Some(particle)) = cloth.particle_of_vertex.get(vertex as usize)
                && lengths > 0.0
            {
                normals[*particle as usize] += next.cross(last) / lengths;
            }
        }
    }
    normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
    Ok(normals)
}
