//! Compares the solver, bit for bit, with a naive loop over one particle and one stick at a time: no vectors, no cells, no
//! sweeps.

use drape_solver::constants::{LEAST_OVERLAP, PUSH_OUT_SPEED, TETHER_SPEED};
use drape_solver::glam::Vec3;
use drape_solver::{
    Body, BodySettings, Environment, Isa, Island, Obstacle, Particles, Shape, StickKind, StickMaterial,
    StickProjection, StructuralSolve, Topology, TopologyBuilder, step,
};

use crate::common::*;

const FRICTION: f32 = 0.5;
const RADIUS: f32 = 0.5;
const CENTRE: Vec3 = Vec3::new(0.1, -0.7, 0.05);
const GROUND: f32 = -1.25;

/// The state of a particle, and its contacts in a substep.
#[derive(Clone, Copy)]
struct Particle {
    position: Vec3,
    displacement: Vec3,
    inverse_mass: f32,
    integrated: Vec3,
    /// Contacts with the ground and with the sphere.
    pushes: [Push; 2],
}

#[derive(Clone, Copy)]
struct Push {
    depth: f32,
    left: Option<f32>,
    normal: Vec3,
}

const NO_PUSH: Push = Push { depth: 0.0, left: None, normal: Vec3::ZERO };

/// Distances from the ground and from the sphere in metres, and the normals.
fn surfaces(position: Vec3) -> [(f32, Vec3); 2] {
    let from_centre = position - CENTRE;
    let length = squared(from_centre).sqrt();
    [(position.y - GROUND, Vec3::Y), (length - RADIUS, from_centre * (1.0 / length))]
}

fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

fn squared(v: Vec3) -> f32 {
    dot(v, v)
}

struct Reference<'a> {
    particles: Vec<Particle>,
    topology: &'a Topology,
    settings: BodySettings,
}

impl Reference<'_> {
    fn step(&mut self) {
        let h = FRAME / self.settings.substeps as f32;
        for substep in 0..self.settings.substeps {
            let fall = Vec3::NEG_Y * G * (h * h);
            for particle in self.particles.iter_mut().filter(|p| p.inverse_mass > 0.0) {
                particle.displacement += fall;
                particle.position += particle.displacement;
            }
            for particle in &mut self.particles {
                particle.integrated = particle.position;
                particle.pushes = [NO_PUSH; 2];
            }
            let spread = (self.settings.substeps - substep) as f32;
            let sticks: Vec<usize> = (0..self.topology.batches().len()).collect();
            for iteration in 0..self.settings.iterations {
                self.contacts(spread, PUSH_OUT_SPEED * h);
                if iteration % 2 == 0 {
                    sticks.iter().for_each(|&batch| self.sticks(batch));
                } else {
                    sticks.iter().rev().for_each(|&batch| self.sticks(batch));
                }
                self.tethers(TETHER_SPEED * h);
            }
            self.contacts(spread, PUSH_OUT_SPEED * h);
            for particle in &mut self.particles {
                particle.displacement += particle.position - particle.integrated;
            }
            self.friction();
        }
    }

    fn error(&self, length_squared: f32, rest: f32) -> f32 {
        match self.settings.projection {
            StickProjection::Exact => (length_squared.sqrt() - rest) / length_squared.sqrt(),
            StickProjection::SquareRootFree => {
                (length_squared - rest * rest) / (length_squared + rest * rest)
            }
        }
    }

    fn sticks(&mut self, batch: usize) {
        for i in self.topology.batches()[batch].range() {
            let [a, b] = self.topology.stick(i).map(|end| end as usize);
            let [wa, wb] = [a, b].map(|end| self.particles[end].inverse_mass);
            if wa + wb == 0.0 {
                continue;
            }
            let delta = self.particles[b].position - self.particles[a].position;
            let error = self.error(squared(delta), self.topology.rest_length(i));
            self.particles[a].position += delta * (error * (wa / (wa + wb)));
            self.particles[b].position -= delta * (error * (wb / (wa + wb)));
        }
    }

    fn tethers(&mut self, most: f32) {
        for (particle, pin, length) in self.topology.tethers() {
            let delta = self.particles[particle as usize].position - self.particles[pin as usize].position;
            let distance_squared = squared(delta);
            if distance_squared > length * length {
                let mut part = self.error(distance_squared, length);
                if part * part * distance_squared > most * most {
                    part = most / distance_squared.sqrt();
                }
                self.particles[particle as usize].position -= delta * part;
            }
        }
    }

    fn contacts(&mut self, spread: f32, at_once: f32) {
        let thickness = self.settings.thickness;
        for particle in self.particles.iter_mut().filter(|p| p.inverse_mass > 0.0) {
            for surface in 0..2 {
                let (distance, normal) = surfaces(particle.position)[surface];
                let depth = thickness - distance;
                if depth <= 0.0 {
                    continue;
                }
                let push = &mut particle.pushes[surface];
                let travel = particle.displacement + (particle.position - particle.integrated);
                let (mut fresh, mut out) = (depth, depth);
                if depth + dot(travel, normal) > LEAST_OVERLAP {
                    let overlap = (thickness - surfaces(particle.position - travel)[surface].0).max(0.0);
                    let old = overlap.min(depth);
                    let left = push.left.unwrap_or((old - old * (1.0 / spread)).min(old - at_once).max(0.0));
                    fresh = depth - old;
                    out = fresh + (old - left).max(0.0);
                    push.left = Some(left);
                }
                push.depth += fresh;
                push.normal = normal;
                particle.displacement += normal * fresh;
                particle.position += normal * out;
                particle.integrated += normal * out;
            }
        }
    }

    fn friction(&mut self) {
        for particle in &mut self.particles {
            for push in particle.pushes.into_iter().filter(|push| push.depth > 0.0) {
                let slip = particle.displacement;
                let tangential = slip - push.normal * dot(slip, push.normal);
                let length = squared(tangential).sqrt();
                let most = push.depth * FRICTION;
                let taken = tangential * if length > most { most / length } else { 1.0 };
                particle.position -= taken;
                particle.displacement -= taken;
            }
        }
    }
}

/// A sheet with two pinned corners over a sphere above the ground, with grid sticks or listed ones.
fn sheet(columns: u32, rows: u32, is_grid: bool, settings: BodySettings) -> Body {
    let spacing = 2.0 / (columns - 1) as f32;
    let place =
        |i: u32| Vec3::new((i % columns) as f32 * spacing - 1.0, 0.0, (i / columns) as f32 * spacing - 1.0);
    let rest: Vec<Vec3> = (0..columns * rows).map(place).collect();
    let mut builder = if is_grid {
        TopologyBuilder::grid(&rest, columns, rows).expect("a grid")
    } else {
        TopologyBuilder::new(&rest)
    };
    for (kind, [right, down]) in [
        (StickKind::Structural, [1_i32, 0_i32]),
        (StickKind::Structural, [0, 1]),
        (StickKind::Shear, [1, 1]),
        (StickKind::Shear, [-1, 1]),
        (StickKind::Bend, [2, 0]),
        (StickKind::Bend, [0, 2]),
    ] {
        builder.grid_family(StickMaterial::rigid(kind), [right, down]).expect("valid");
    }
    let pins = [0, columns - 1];
    builder.straight_tethers(&pins).expect("valid");
    let mut inverse_mass = vec![(columns * rows) as f32; rest.len()];
    pins.iter().for_each(|&pin| inverse_mass[pin as usize] = 0.0);
    let particles = Particles::new(Vec3::ZERO, &rest, &inverse_mass).expect("valid");
    Body::new(particles, builder.build().expect("valid").into(), settings)
}

fn compare(columns: u32, rows: u32, is_grid: bool, settings: BodySettings, isa: Isa, steps: usize) {
    let body = sheet(columns, rows, is_grid, settings);
    let topology = body.topology.clone();
    let state = |i: usize| Particle {
        position: body.particles.position(i),
        displacement: Vec3::ZERO,
        inverse_mass: body.particles.inverse_mass(i),
        integrated: Vec3::ZERO,
        pushes: [NO_PUSH; 2],
    };
    let particles = (0..body.particles.len()).map(state).collect();
    let mut reference = Reference { particles, topology: &topology, settings };
    let ground = Obstacle::new(
        Shape::HalfSpace { normal: Vec3::Y },
        drape_solver::Placement::at(Vec3::Y * GROUND),
        FRICTION,
    );
    let obstacles =
        vec![ground.expect("valid"), obstacle(Shape::Sphere { radius: RADIUS }, CENTRE, FRICTION)];
    let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
    let mut island = Island { isa, ..Island::of_body(body) };
    let mut touched = [false; 2];
    for index in 0..steps {
        step(&mut island, &environment).expect("finite");
        reference.step();
        for (i, particle) in reference.particles.iter().enumerate() {
            let position = island.bodies[0].particles.position(i);
            assert_eq!(position, particle.position, "particle {i} in step {index} on {}", isa.name());
            (0..2).for_each(|surface| touched[surface] |= particle.pushes[surface].depth > 0.0);
        }
    }
    assert_eq!(touched, [true; 2], "the sheet met the ground and the sphere");
}

fn settings(iterations: u32, projection: StickProjection) -> BodySettings {
    let defaults = BodySettings::default();
    let structural = StructuralSolve::Sweeps;
    BodySettings {
        substeps: 4,
        iterations,
        projection,
        structural,
        drag: 0.0,
        friction: FRICTION,
        ..defaults
    }
}

/// Every instruction set, both formulas, symmetric pairs of sweeps, patches side by side and four by four.
#[test]
fn a_grid_moves_as_the_loop_says_to_the_last_bit() {
    for isa in Isa::available() {
        compare(22, 24, true, settings(1, StickProjection::SquareRootFree), isa, 600);
        compare(50, 52, true, settings(2, StickProjection::Exact), isa, 150);
    }
}

#[test]
fn listed_sticks_move_as_the_loop_says_to_the_last_bit() {
    for isa in Isa::available() {
        compare(22, 24, false, settings(2, StickProjection::SquareRootFree), isa, 300);
    }
}
