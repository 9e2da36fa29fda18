//! rapier3d: soft-body cloth without contacts of its own, on one thread.

use std::time::Duration;

use drape_bench::Failure;
use drape_bench::options::SolverOptions;
use drape_bench::scene::{Scene, SceneKind};
use drape_bench::simulation::{Simulation, timed};
use drape_bench::world::{GRAVITY, MASS, SIDE, SPHERE_CENTRE, SPHERE_RADIUS, STEP};
use drape_solver::glam;
use rapier3d::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, SoftBodyBuilder, SoftBodyHandle, SpringCoefficients,
    Vector,
};

/// Distance at which the cloth touches the sphere, in metres.
const THICKNESS: f32 = 0.001;

/// A world with the sheet and the sphere in it.
pub struct Rapier {
    world: PhysicsWorld,
    sheet: SoftBodyHandle,
}

impl Rapier {
    /// Loads `scene`, which must be a sheet: rapier's own cloth has the same sticks. Springs have the natural
    /// frequency `softness` in hertz and are critically damped.
    ///
    /// # Errors
    /// [`Failure`] for another scene.
    pub fn new(scene: &Scene, options: &SolverOptions, softness: f32) -> Result<Self, Failure> {
        if !matches!(scene.kind, SceneKind::Sheet | SceneKind::Million) {
            return Err(Failure::Scene { solver: "rapier", scene: scene.kind.name() });
        }
        let mut world = PhysicsWorld { gravity: vector(GRAVITY), ..PhysicsWorld::default() };
        world.integration_parameters.dt = STEP;
        world.integration_parameters.num_solver_iterations = options.substeps as usize;
        world.integration_parameters.num_internal_pgs_iterations = options.sweeps as usize;
        // No more substeps than were asked for.
        world.integration_parameters.soft_bodies.max_extra_substeps = 0;
        let collider = ColliderBuilder::ball(SPHERE_RADIUS).friction(0.0);
        world.insert(RigidBodyBuilder::fixed().translation(vector(SPHERE_CENTRE)), collider);
        let (n, half) = (scene.n as usize, 0.5 * SIDE);
        let spacing = SIDE / (n - 1) as f32;
        let corner = Vector::new(-half, 0.0, -half);
        let (down, right) = (Vector::new(0.0, 0.0, spacing), Vector::new(spacing, 0.0, 0.0));
        let sheet = SoftBodyBuilder::cloth(corner, down, right, n, n)
            .mass(MASS)
            .pinned_particles(scene.model.pinned.iter().copied())
            .softness(SpringCoefficients::new(softness, 1.0))
            .self_contacts(false)
            .particle_radius(THICKNESS)
            .can_sleep(false);
        let sheet = world.insert_soft_body(sheet);
        let rapier = Self { world, sheet };
        let is_same = |(a, b): (glam::Vec3, &glam::Vec3)| a.distance(*b) < 1e-4;
        if !rapier.positions().into_iter().zip(&scene.model.positions).all(is_same) {
            return Err(Failure::Peer("rapier's cloth has its particles in another order".to_owned()));
        }
        Ok(rapier)
    }
}

fn vector(v: glam::Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Simulation for Rapier {
    fn step(&mut self) -> Result<Duration, Failure> {
        Ok(timed(|| self.world.step()))
    }

    fn positions(&self) -> Vec<glam::Vec3> {
        let sheet = self.world.soft_bodies.get(self.sheet);
        let points = sheet.into_iter().flat_map(|sheet| sheet.particle_positions());
        points.map(|point| glam::Vec3::new(point.x, point.y, point.z)).collect()
    }

    fn energy(&self) -> Option<f64> {
        None
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        None
    }
}
