//! A scene that is ready to be stepped.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::crossings::CrossingCounter;
use drape_solver::state::measure;
use drape_solver::{Body, Environment, Island, Obstacle};

use crate::scenes::world::{GRAVITY, STEP};

/// The place in metres, some seconds after the start, of a pin that began at the first argument.
pub type PinPath = fn(Vec3, f32) -> Vec3;

/// An island, its obstacles, and the way of its pins.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The bodies.
    pub island: Island,
    /// Step, gravity and obstacles.
    pub environment: Environment,
    path: Option<PinPath>,
    /// Body, particle and first place of each pin that moves.
    pins: Vec<(usize, usize, Vec3)>,
}

impl Setup {
    /// These bodies among these obstacles.
    pub fn new(bodies: Vec<Body>, obstacles: Vec<Obstacle>) -> Self {
        let island = Island { bodies, ..Island::default() };
        let environment =
            Environment { dt: STEP, gravity: GRAVITY, obstacles: obstacles.into(), ..Environment::default() };
        Self { island, environment, path: None, pins: Vec::new() }
    }

    /// Returns the scene with all pins of its bodies on this way.
    #[must_use]
    pub fn with_moving_pins(mut self, path: PinPath) -> Self {
        self.path = Some(path);
        for (number, body) in self.island.bodies.iter().enumerate() {
            let pins = (0..body.particles.len()).filter(|&i| body.particles.is_pinned(i));
            self.pins.extend(pins.map(|i| (number, i, body.particles.position(i))));
        }
        self
    }

    /// Sends each moving pin to its place `seconds` after the start, where the next step takes it.
    pub fn move_pins(&mut self, seconds: f32) {
        let Some(path) = self.path else { return };
        for &(body, particle, start) in &self.pins {
            self.island.bodies[body].particles.set_pin_target(particle, path(start, seconds));
        }
    }

    /// Greatest thickness of a body in metres.
    pub fn thickness(&self) -> f32 {
        self.island.bodies.iter().map(|body| body.settings.thickness).fold(0.0, f32::max)
    }

    /// The number of particles.
    pub fn particle_count(&self) -> usize {
        self.island.bodies.iter().map(|body| body.particles.len()).sum()
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.island.bodies.iter().map(|body| body.topology.faces().len()).sum()
    }

    /// Positions of all particles in metres, body by body.
    pub fn positions(&self) -> Vec<DVec3> {
        self.island.bodies.iter().flat_map(|body| measure::positions(&body.particles)).collect()
    }

    /// A counter of crossings of all bodies, by the numbers of [`positions`](Self::positions).
    pub fn crossing_counter(&self) -> CrossingCounter {
        CrossingCounter::of(self.island.bodies.iter().map(|body| &*body.topology))
    }
}
