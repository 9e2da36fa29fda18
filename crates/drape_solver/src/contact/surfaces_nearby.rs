//! The surface of an obstacle next to each particle of a body.
//!
//! Design: `docs/design/obstacles.md`.

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::geometry::pose::Pose;
use crate::geometry::shape::{Shape, Surface};
use crate::geometry::surface_lanes::{LanePose, Solid};
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, set_lanes};
use crate::state::particles::Particles;

/// The surfaces next to all particles, in the coordinates of a shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfacesNearby {
    cells: Vec<CellSurfaces>,
}

/// The surfaces next to the particles of a cell.
#[derive(Clone, Copy, Debug)]
struct CellSurfaces {
    distance: [f32; LANES],
    normal: Cell,
}

/// Nothing is near.
const AWAY: CellSurfaces = CellSurfaces {
    distance: [f32::INFINITY; LANES],
    normal: Cell { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] },
};

impl SurfacesNearby {
    /// Finds the surfaces of a shape at `pose` next to all particles that are within `reach` of it. Returns the least distance found. Both
    /// in metres.
    pub fn find(&mut self, particles: &Particles, shape: &Shape, pose: &Pose, reach: f32, isa: Isa) -> f32 {
        self.cells.resize(particles.position.cells.len(), AWAY);
        if shape.has_formula() {
            isa.run(Find { particles, shape, pose, reach, cells: &mut self.cells })
        } else {
            self.find_one_by_one(particles, shape, pose, reach)
        }
    }

    /// The surface next to the particle in this slot. If the shape has no formula and is not within reach, it is at an infinite distance and
    /// has no normal.
    pub fn at(&self, slot: usize) -> Surface {
        let (cell, lane) = (&self.cells[slot / LANES], slot % LANES);
        Surface { distance: cell.distance[lane], normal: cell.normal.get(lane) }
    }

    fn find_one_by_one(&mut self, particles: &Particles, shape: &Shape, pose: &Pose, reach: f32) -> f32 {
        self.cells.fill(AWAY);
        let (low, high) = shape.local_bounds();
        let (low, high) = (low - reach, high + reach);
        let mut nearest = f32::INFINITY;
        for slot in particles.layout.slots() {
            let local = pose.to_local(particles.position.get(slot));
            if local.cmpge(low).all() && local.cmple(high).all() {
                let Surface { distance, normal } = shape.surface(local);
                nearest = nearest.min(distance);
                let (cell, lane) = (&mut self.cells[slot / LANES], slot % LANES);
                cell.distance[lane] = distance;
                cell.normal.set(lane, normal);
            }
        }
        nearest
    }
}

/// The search next to a shape with a formula, cell by cell.
struct Find<'a> {
    particles: &'a Particles,
    shape: &'a Shape,
    pose: &'a Pose,
    reach: f32,
    cells: &'a mut [CellSurfaces],
}

impl Kernel for Find<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f32 {
        let Self { particles, shape, pose, reach, cells } = self;
        let pose = LanePose::new(simd, pose);
        let within = f32x16::splat(simd, reach);
        let mut nearest = f32::INFINITY;
        for (place, (cell, position)) in cells.iter_mut().zip(&particles.position.cells).enumerate() {
            let point = pose.to_local(Lanes3::load(simd, position));
            let (distance, normal) = Solid::Formula(shape).surface(simd, point);
            cell.distance = distance.to_array();
            normal.store(&mut cell.normal);
            let near = distance.simd_lt(within);
            if near.any_true() {
                // Ghosts may be anywhere.
                let near = near.to_bitmask() as u16 & particles.layout.real_lanes(place);
                nearest = set_lanes(near).fold(nearest, |nearest, lane| nearest.min(cell.distance[lane]));
            }
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use crate::build::cloth::ClothBuilder;
    use crate::geometry::pose::Placement;
    use crate::simd::miri::unless_miri;
    use crate::state::settings::BodySettings;

    use super::*;

    /// As for one particle after another; ghosts of the grid, which are inside the obstacle here, do not count.
    #[test]
    fn surfaces_of_cells_are_those_of_their_particles() {
        let (columns, rows) = unless_miri((17, 17), (5, 3));
        let sheet = ClothBuilder::new(1.0, 1.0, columns, rows).build(BodySettings::default()).expect("valid");
        let mut particles = sheet.particles;
        let rotation = Quat::from_rotation_x(0.4);
        let pose = Pose::at(&Placement { translation: Vec3::new(0.0, -0.5, 0.3), rotation }, Vec3::ZERO);
        let slots = particles.position.cells.len() * LANES;
        let real: Vec<usize> = particles.layout.slots().collect();
        let ghosts: Vec<usize> = (0..slots).filter(|slot| !real.contains(slot)).collect();
        assert!(!ghosts.is_empty());
        ghosts.iter().for_each(|&slot| particles.position.set(slot, Vec3::new(0.0, -0.5, 0.3)));
        let shapes = [
            Shape::Sphere { radius: 0.2 },
            Shape::Cuboid { half_extents: Vec3::new(0.1, 0.2, 0.1) },
            Shape::Capsule { half_length: 0.2, radius: 0.1 },
        ];
        let reach = 0.3;
        let [mut lanes, mut single] = [SurfacesNearby::default(), SurfacesNearby::default()];
        for shape in &shapes {
            for isa in Isa::available() {
                let nearest = lanes.find(&particles, shape, &pose, reach, isa);
                single.cells.resize(particles.position.cells.len(), AWAY);
                let expected = single.find_one_by_one(&particles, shape, &pose, reach);
                assert!(expected > 0.0 && expected < reach, "{shape:?}: {expected}");
                assert!((nearest - expected).abs() < 1e-6, "{shape:?}: {nearest}, not {expected}");
                for &slot in &real {
                    let [of_lanes, of_one] = [&lanes, &single].map(|surfaces| surfaces.at(slot));
                    if of_one.distance < reach {
                        assert!((of_lanes.distance - of_one.distance).abs() < 1e-6, "{shape:?}");
                        assert!((of_lanes.normal - of_one.normal).length() < 1e-5, "{shape:?}");
                    } else {
                        assert!(of_lanes.distance > reach - 1e-6, "{shape:?}");
                    }
                }
            }
        }
    }
}
