//! The force of the air on a body: on the squares of a grid, on faces and on links, sixteen at once.
//!
//! ```text
//!   square  a---b     area vector 1/2 (d - a) x (b - c)       face  p---q        link  p---q
//!           |   |     = that of its two faces, whichever             \ /
//!           c---d       diagonal they share                           r
//! ```
//!
//! Design: `docs/design/wind.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::motion::air::Air;
use crate::motion::wind::Wind;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, load, shifted_by};
use crate::state::layout::{Grid, Layout};
use crate::state::particles::Particles;
use crate::state::topology::Topology;

/// The number of elements that meet at a particle and share the limit on their forces: by the number of an element's corners.
const MEETING: [f32; 5] = [0.0, 0.0, 2.0, 6.0, 4.0];

/// A smaller part of the wind across a link is rounding, and has no direction.
const LEAST_ACROSS: f32 = 1e-5;

/// Adds the force of the air on a body in newtons to `forces`, a vector for each slot.
pub(crate) struct Blow<'a> {
    pub particles: &'a Particles,
    pub topology: &'a Topology,
    /// Half the width of a link's profile, in metres.
    pub thickness: f32,
    pub air: &'a Air<'a>,
    /// Seconds of the step.
    pub dt: f32,
    pub forces: &'a mut [Cell],
}

/// One corner of sixteen elements.
#[derive(Clone, Copy)]
struct Corner<S: Simd> {
    position: Lanes3<S>,
    displacement: Lanes3<S>,
    inverse_mass: f32x16<S>,
}

impl<S: Simd> Corner<S> {
    #[inline(always)]
    fn load(simd: S, position: &Cell, displacement: &Cell, inverse_mass: &[f32; LANES]) -> Self {
        Self {
            position: Lanes3::load(simd, position),
            displacement: Lanes3::load(simd, displacement),
            inverse_mass: load(simd, inverse_mass),
        }
    }

    /// That of each lane from so many lanes higher.
    #[inline(always)]
    fn shifted_by(self, lanes: usize) -> Self {
        Self {
            position: self.position.shifted_by(lanes),
            displacement: self.displacement.shifted_by(lanes),
            inverse_mass: shifted_by(self.inverse_mass, lanes),
        }
    }
}

impl Kernel for Blow<'_> {
    type Output = ();

    #[expect(
        clippy::redundant_closure_for_method_calls,
        reason = "the method itself would not be compiled for the instruction set"
    )]
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let topology = self.topology;
        match topology.layout {
            Layout::Grid(grid) if topology.has_squares() => {
                self.blow_on_squares(simd, grid);
            }
            _ => self.blow_on_list(
                simd,
                topology.faces(),
                #[inline(always)]
                |own, simd, corners| own.on_face(simd, corners),
            ),
        }
        self.blow_on_list(
            simd,
            topology.segments(),
            #[inline(always)]
            |own, simd, corners| own.on_link(simd, corners),
        );
    }
}

impl Blow<'_> {
    /// Blows on all squares of a grid: in each lane on those of one patch.
    #[inline(always)]
    fn blow_on_squares<S: Simd>(&mut self, simd: S, grid: Grid) {
        let Grid { width, height, across, .. } = grid;
        for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
            let lanes = grid.lanes_of_column(column, |column| column + 1 < grid.columns)
                & grid.lanes_of_row(row, |row| row + 1 < grid.rows);
            // Those in which a square begins.
            if lanes == 0 {
                continue;
            }
            // The cell of a corner, and the number of lanes by which its patch lies further on.
            let corner = |right: usize, down: usize| {
                let (column, row) = (column + right, row + down);
                let (next, below) = (column == width, row == height);
                let cell = if below { 0 } else { row * width } + if next { 0 } else { column };
                (cell, usize::from(next) + if below { across } else { 0 })
            };
            let places = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
            let mut corners = [self.corner(simd, places[0]); 4];
            for (corner, place) in corners[1..].iter_mut().zip(&places[1..]) {
                *corner = self.corner(simd, *place);
            }
            let [a, b, c, d] = &corners;
            let double_area = d.position.minus(a.position).cross(b.position.minus(c.position));
            // Lanes without a square have no force.
            let lanes = mask32x16::from_bitmask(simd, u64::from(lanes));
            let nothing = Lanes3::splat(simd, Vec3::ZERO);
            let share = self.on_surface(simd, &corners, double_area).or(lanes, nothing);
            for (cell, shift) in places {
                let forces = &mut self.forces[cell];
                Lanes3::load(simd, forces).plus(share.shifted_by((LANES - shift) % LANES)).store(forces);
            }
        }
    }

    /// Blows on listed elements, given by their particles.
    #[inline(always)]
    fn blow_on_list<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        elements: &[[u32; N]],
        share: impl Fn(&Self, S, &[Corner<S>; N]) -> Lanes3<S>,
    ) {
        for elements in elements.chunks(LANES) {
            let mut slots = [[0; LANES]; N];
            let mut cells = [(Cell::default(), Cell::default(), [0.0; LANES]); N];
            for (lane, element) in elements.iter().enumerate() {
                for ((slots, cells), &particle) in slots.iter_mut().zip(&mut cells).zip(element) {
                    let slot = self.particles.layout.slot(particle as usize);
                    let (position, displacement, inverse_mass) = cells;
                    slots[lane] = slot;
                    position.set(lane, self.particles.position.get(slot));
                    displacement.set(lane, self.particles.displacement.get(slot));
                    inverse_mass[lane] = self.particles.inverse_mass[slot];
                }
            }
            let (position, displacement, inverse_mass) = &cells[0];
            let mut corners = [Corner::load(simd, position, displacement, inverse_mass); N];
            for (corner, (position, displacement, inverse_mass)) in corners[1..].iter_mut().zip(&cells[1..]) {
                *corner = Corner::load(simd, position, displacement, inverse_mass);
            }
            let mut shares = Cell::default();
            share(self, simd, &corners).store(&mut shares);
            for lane in 0..elements.len() {
                let share = shares.get(lane);
                for slot in slots.map(|slots| slots[lane]) {
                    let forces = &mut self.forces[slot / LANES];
                    forces.add(slot % LANES, share);
                }
            }
        }
    }

    /// The particles of a cell, each in the lane so many lower.
    #[inline(always)]
    fn corner<S: Simd>(&self, simd: S, (cell, shift): (usize, usize)) -> Corner<S> {
        let Particles { position, displacement, inverse_mass, .. } = self.particles;
        let (inverse_mass, _) = inverse_mass.as_chunks::<LANES>();
        Corner::load(simd, &position.cells[cell], &displacement.cells[cell], &inverse_mass[cell])
            .shifted_by(shift)
    }

    #[inline(always)]
    fn on_face<S: Simd>(&self, simd: S, corners: &[Corner<S>; 3]) -> Lanes3<S> {
        let [p, q, r] = corners;
        let double_area = q.position.minus(p.position).cross(r.position.minus(p.position));
        self.on_surface(simd, corners, double_area)
    }

    /// The force on each corner of a square or face with this area vector, twice as long.
    #[inline(always)]
    fn on_surface<S: Simd, const N: usize>(
        &self,
        simd: S,
        corners: &[Corner<S>; N],
        double_area: Lanes3<S>,
    ) -> Lanes3<S> {
        let length = double_area.dot(double_area).sqrt();
        let zero = f32x16::splat(simd, 0.0);
        let normal = double_area.times(f32x16::splat(simd, 1.0) / length);
        let velocity = self.air_at_middle(simd, corners);
        let share = self.share(simd, corners, velocity, normal, length * 0.5);
        share.or(length.simd_gt(zero), Lanes3::splat(simd, Vec3::ZERO))
    }

    /// The force on each end of a link. Its profile is twice the thickness wide, and the wind always meets it squarely.
    #[inline(always)]
    fn on_link<S: Simd>(&self, simd: S, ends: &[Corner<S>; 2]) -> Lanes3<S> {
        let zero = f32x16::splat(simd, 0.0);
        let along = ends[1].position.minus(ends[0].position);
        let squared = along.dot(along);
        let area = squared.sqrt() * (2.0 * self.thickness);
        let velocity = self.air_at_middle(simd, ends);
        let part = squared.simd_gt(zero).select(velocity.dot(along) / squared, zero);
        let across = velocity.minus(along.times(part));
        let speed = across.dot(across).sqrt();
        let normal = across.times(f32x16::splat(simd, 1.0) / speed);
        let share = self.share(simd, ends, velocity, normal, area);
        let least = velocity.dot(velocity).sqrt() * LEAST_ACROSS;
        share.or(speed.simd_gt(least), Lanes3::splat(simd, Vec3::ZERO))
    }

    /// The velocity of the air in the middle between corners.
    #[inline(always)]
    fn air_at_middle<S: Simd, const N: usize>(&self, simd: S, corners: &[Corner<S>; N]) -> Lanes3<S> {
        let mut sum = corners[0].position;
        for corner in &corners[1..] {
            sum = sum.plus(corner.position);
        }
        let middle = sum.times(f32x16::splat(simd, 1.0 / N as f32));
        self.air.velocities(simd, middle.plus(Lanes3::splat(simd, self.particles.origin)))
    }

    /// The force on each corner of elements with this unit `normal` and `area` (m^2), in air of this `velocity`.
    ///
    /// A gust may bring a particle to the speed of the air within the step, but never past it: the explicit force
    /// cannot make light cloth explode. The elements that meet at a particle share that limit.
    #[inline(always)]
    fn share<S: Simd, const N: usize>(
        &self,
        simd: S,
        corners: &[Corner<S>; N],
        velocity: Lanes3<S>,
        normal: Lanes3<S>,
        area: f32x16<S>,
    ) -> Lanes3<S> {
        let Wind { air_density, drag_coefficient, lift_coefficient, .. } = *self.air.wind;
        let (zero, least) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, f32::MIN_POSITIVE));
        let part = 1.0 / N as f32;
        let Corner { displacement: mut way, mut inverse_mass, .. } = corners[0];
        for corner in &corners[1..] {
            way = way.plus(corner.displacement);
            inverse_mass += corner.inverse_mass;
        }
        let own = way.times(f32x16::splat(simd, part / self.particles.substep));
        let relative = velocity.minus(own);
        let by_force = (inverse_mass * part).max(least) * (self.dt * part * MEETING[N]);

        let speed = relative.dot(normal);
        let force = area * (0.5 * air_density * drag_coefficient) * speed * speed.abs();
        let most = speed.abs() / by_force;
        let is_too_much = force.abs().simd_gt(most);
        let size = is_too_much.select(speed / by_force, force);
        let mut sum = normal.times(size);
        if lift_coefficient != 0.0 && N > 2 {
            let size = relative.dot(relative).sqrt();
            let strength = area * (0.5 * air_density * lift_coefficient);
            let lift = normal.times(size * size).minus(relative.times(speed)).times(strength * speed / size);
            let (squared, most) = (lift.dot(lift), size / by_force);
            let is_too_much = squared.simd_gt(most * most);
            let lift = lift.times(most / squared.sqrt()).or(is_too_much, lift);
            sum = sum.plus(lift.or(size.simd_gt(zero), Lanes3::splat(simd, Vec3::ZERO)));
        }
        sum.times(f32x16::splat(simd, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::sync::Arc;

    use crate::build::cloth::ClothBuilder;
    use crate::build::rope::RopeBuilder;
    use crate::build::topology_builder::TopologyBuilder;
    use crate::constraint::testing::dice;
    use crate::motion::air::tests::velocities;
    use crate::motion::environment::Environment;
    use crate::motion::wind::Turbulence;
    use crate::simd::isa::Isa;
    use crate::simd::miri::unless_miri;
    use crate::state::body::Body;
    use crate::state::settings::BodySettings;

    /// Seconds of a step: in the longer one, the limit on forces counts.
    const STEPS: [f32; 2] = [0.01, 1.0];

    fn gusty() -> Wind {
        let turbulence = Turbulence { speed: 3.0, length: 2.0, seed: 5 };
        Wind { turbulence, lift_coefficient: 0.8, ..Wind::new(Vec3::new(5.0, -1.0, 3.0)) }
    }

    fn air_around<'a>(particles: &Particles, wind: &'a Wind) -> Air<'a> {
        let (low, high) = particles.bounds();
        Air::new(wind, &[], &Environment::default().obstacles, 1.5, [low, high]).expect("it moves")
    }

    /// The force on each particle.
    fn blown(body: &Body, wind: &Wind, dt: f32, isa: Isa) -> Vec<Vec3> {
        let Body { particles, topology, .. } = body;
        let mut particles = particles.clone();
        particles.arrange(&topology.layout);
        let air = air_around(&particles, wind);
        let mut forces = vec![Cell::default(); particles.layout.cells()];
        let (particles, air, forces_of) = (&particles, &air, &mut forces);
        isa.run(Blow { particles, topology, thickness: 0.01, air, dt, forces: forces_of });
        particles.layout.slots().map(|slot| forces[slot / LANES].get(slot % LANES)).collect()
    }

    /// A crumpled sheet in motion, with pins.
    fn crumpled(columns: u32, rows: u32) -> Body {
        let cloth = ClothBuilder::new(2.0, 1.5, columns, rows);
        let mut body = cloth
            .pin_where(|column, row, _| column + row == 0)
            .build(BodySettings::default())
            .expect("valid");
        let mut dice = dice(11);
        for i in 0..body.particles.len() {
            let place = body.particles.position(i) + Vec3::new(dice(), dice(), dice()) * 0.02;
            body.particles.set_position(i, place);
            body.particles.set_velocity(i, Vec3::new(dice(), dice(), dice()) * 4.0);
        }
        body
    }

    /// The formula of `Wind`, for one element at a time and in double precision.
    fn expected(
        body: &Body,
        wind: &Wind,
        dt: f32,
        elements: &[Vec<usize>],
        area: impl Fn(&[DVec3], DVec3) -> DVec3,
    ) -> Vec<DVec3> {
        let particles = &body.particles;
        let air = air_around(particles, wind);
        let mut forces = vec![DVec3::ZERO; particles.len()];
        for corners in elements {
            let share = 1.0 / corners.len() as f64;
            let mean = |of: &dyn Fn(usize) -> DVec3| corners.iter().map(|&i| of(i)).sum::<DVec3>() * share;
            let places: Vec<DVec3> = corners.iter().map(|&i| particles.position(i).as_dvec3()).collect();
            let middle = mean(&|i| particles.position(i).as_dvec3());
            let mut places_of_air = Cell::default();
            places_of_air.set(7, middle.as_vec3());
            let velocity = velocities(&air, places_of_air).get(7).as_dvec3();
            let vector = area(&places, velocity);
            let (area, normal) = (vector.length(), vector.normalize());
            let relative = velocity - mean(&|i| particles.velocity(i).as_dvec3());
            let speed = relative.dot(normal);
            let strength = 0.5 * f64::from(wind.air_density) * area;
            let drag = strength * f64::from(wind.drag_coefficient) * speed * speed.abs();
            let size = relative.length();
            let lift = (normal * size * size - relative * speed)
                * (strength * f64::from(wind.lift_coefficient) * speed / size);
            let inverse_mass =
                corners.iter().map(|&i| f64::from(particles.inverse_mass(i))).sum::<f64>() * share;
            let by_force = f64::from(dt) * inverse_mass * share * [2.0, 6.0, 4.0][corners.len() - 2];
            let force = normal * drag.clamp(-speed.abs() / by_force, speed.abs() / by_force)
                + lift.clamp_length_max(size / by_force);
            corners.iter().for_each(|&i| forces[i] += force * share);
        }
        forces
    }

    fn assert_equal(forces: &[Vec3], expected: &[DVec3], name: &str) {
        let scale = expected.iter().map(|force| force.length()).fold(0.0, f64::max);
        assert!(scale > 0.0, "{name}: there is a wind");
        for (i, (force, expected)) in forces.iter().zip(expected).enumerate() {
            let error = (force.as_dvec3() - expected).length();
            assert!(error < 1e-4 * scale, "{name}, particle {i}: {force} instead of {expected}");
        }
    }

    /// Grids of each way to cut them into patches, full and with ghosts.
    #[test]
    fn a_particle_gets_its_part_of_the_force_on_its_squares() {
        for (columns, rows) in
            [(64, 5), (50, 33), (16, 16), (13, 17), (5, 49)].into_iter().take(unless_miri(5, 1))
        {
            let body = crumpled(columns, rows);
            assert!(matches!(body.topology.layout, Layout::Grid(_)) && body.topology.has_faces_by_square);
            let [columns, rows] = [columns, rows].map(|count| count as usize);
            let squares =
                (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| row * columns + column));
            let squares: Vec<Vec<usize>> =
                squares.map(|i| vec![i, i + 1, i + columns, i + columns + 1]).collect();
            let area = |p: &[DVec3], _| 0.5 * (p[3] - p[0]).cross(p[1] - p[2]);
            for dt in STEPS {
                let forces = expected(&body, &gusty(), dt, &squares, area);
                let blown_on = blown(&body, &gusty(), dt, Isa::detected());
                assert_equal(&blown_on, &forces, &format!("{columns} x {rows}"));
                assert!(Isa::available().into_iter().all(|isa| blown(&body, &gusty(), dt, isa) == blown_on));
            }
        }
    }

    /// A grid that is too small for patches, and a mesh.
    #[test]
    fn a_particle_gets_its_part_of_the_force_on_its_faces() {
        let small = crumpled(7, 6);
        let mut mesh = crumpled(20, 20);
        let rest: Vec<Vec3> = mesh.particles.positions().collect();
        let mut builder = TopologyBuilder::new(&rest);
        builder.faces(mesh.topology.faces().iter().copied()).expect("valid");
        mesh.topology = Arc::new(builder.build().expect("valid"));
        for body in [small, mesh] {
            assert!(!matches!(body.topology.layout, Layout::Grid(_)));
            let faces = body.topology.faces().iter().map(|face| face.map(|i| i as usize).to_vec());
            let area = |p: &[DVec3], _| 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
            let faces: Vec<Vec<usize>> = faces.collect();
            for dt in STEPS {
                let forces = expected(&body, &gusty(), dt, &faces, area);
                let blown_on = blown(&body, &gusty(), dt, Isa::detected());
                assert_equal(&blown_on, &forces, "faces");
                assert!(Isa::available().into_iter().all(|isa| blown(&body, &gusty(), dt, isa) == blown_on));
            }
        }
    }

    /// Lift acts on faces alone.
    #[test]
    fn a_particle_gets_its_part_of_the_force_on_its_links() {
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::new(2.0, -1.0, 0.5), 39);
        let mut body = rope.build(BodySettings::default()).expect("valid");
        let mut dice = dice(3);
        for i in 0..body.particles.len() {
            body.particles.set_velocity(i, Vec3::new(dice(), dice(), dice()) * 4.0);
        }
        let links = body.topology.segments().iter().map(|link| link.map(|i| i as usize).to_vec());
        let wind = Wind { lift_coefficient: 0.0, ..gusty() };
        let area = |p: &[DVec3], velocity: DVec3| {
            let along = p[1] - p[0];
            velocity.reject_from(along).normalize() * (2.0 * 0.01 * along.length())
        };
        let links: Vec<Vec<usize>> = links.collect();
        for dt in STEPS {
            let forces = expected(&body, &wind, dt, &links, area);
            assert_equal(&blown(&body, &gusty(), dt, Isa::detected()), &forces, "links");
        }
    }

    /// Elements without an area or a direction, and what moves with the air.
    #[test]
    fn where_nothing_is_blown_on_there_is_no_force() {
        let wind = Wind { lift_coefficient: 1.0, ..Wind::new(Vec3::new(3.0, 0.0, 4.0)) };
        let sheet = |columns, rows| ClothBuilder::new(1.0, 1.0, columns, rows).build(BodySettings::default());
        let rope = RopeBuilder::new(Vec3::ZERO, wind.velocity, 20).build(BodySettings::default());
        for (name, body) in [("grid", sheet(16, 16)), ("faces", sheet(6, 6)), ("links", rope)] {
            let body = body.expect("valid");
            let [mut carried, mut collapsed] = [body.clone(), body];
            for i in 0..carried.particles.len() {
                carried.particles.set_velocity(i, wind.velocity);
                if name != "links" {
                    collapsed.particles.set_position(i, Vec3::ONE);
                }
            }
            for body in [carried, collapsed] {
                for force in blown(&body, &wind, STEPS[0], Isa::detected()) {
                    assert!(force.length() < 1e-6, "{name}: {force}");
                }
            }
        }
    }
}
