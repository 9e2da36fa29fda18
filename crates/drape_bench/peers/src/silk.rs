//! bevy_silk: its own solver, called as its system calls it.

use std::time::Duration;

use bevy::math::Vec3;
use bevy::platform::collections::HashMap;
use bevy_silk::components::cloth::Cloth;
use bevy_silk::stick::StickMode;
use bevy_silk::vertex_anchor::VertexAnchor;
use drape_bench::Failure;
use drape_bench::options::SolverOptions;
use drape_bench::scene::Scene;
use drape_bench::simulation::{Simulation, timed};
use drape_bench::solver::refuse_sleepers;
use drape_bench::world::{GRAVITY, SPHERE_CENTRE, SPHERE_RADIUS, STEP};
use drape_solver::glam;

/// The scene's bodies as cloths. They take substeps x sweeps as iterations of one step, and meet the sphere once.
pub struct Silk {
    cloths: Vec<Cloth>,
    iterations: u8,
}

impl Silk {
    /// Loads `scene`.
    ///
    /// # Errors
    /// [`Failure`] if bodies should rest, or there are more iterations than the crate can count.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Result<Self, Failure> {
        refuse_sleepers("silk", scene)?;
        let model = &scene.model;
        let iterations = u8::try_from(options.substeps * options.sweeps)
            .map_err(|_| Failure::Peer("silk takes at most 255 iterations".to_owned()))?;
        let points: Vec<Vec3> = model.positions.iter().map(|p| Vec3::from_array(p.to_array())).collect();
        let anchor = |&pin: &u32| (pin as usize, (VertexAnchor::default(), points[pin as usize]));
        let ids = || model.natural_order.iter().map(|stick| (stick.map(|end| end as usize), *stick));
        let cloth = Cloth {
            anchored_points: model.pinned.iter().map(anchor).collect(),
            current_point_positions: points.clone(),
            previous_point_positions: points.clone(),
            stick_lengths: ids().map(|(id, stick)| (id, model.rest_length(stick))).collect(),
            stick_modes: ids().map(|(id, _)| (id, StickMode::Fixed)).collect::<HashMap<_, _>>(),
        };
        Ok(Self { cloths: vec![cloth; scene.bodies as usize], iterations })
    }
}

/// Where the sphere moves a point to.
pub fn out_of_sphere(point: Vec3) -> Option<Vec3> {
    let centre = Vec3::from_array(SPHERE_CENTRE.to_array());
    let out = point - centre;
    let distance = out.length();
    (distance < SPHERE_RADIUS).then(|| centre + out * (SPHERE_RADIUS / distance))
}

impl Simulation for Silk {
    fn step(&mut self) -> Result<Duration, Failure> {
        let acceleration = Vec3::from_array(GRAVITY.to_array()) * (STEP * STEP);
        Ok(timed(|| {
            for cloth in &mut self.cloths {
                cloth.update_points(1.0, acceleration);
                cloth.update_sticks(self.iterations);
                cloth.solve_collisions(|&point| out_of_sphere(point));
            }
        }))
    }

    fn positions(&self) -> Vec<glam::Vec3> {
        let points = self.cloths.iter().flat_map(|cloth| &cloth.current_point_positions);
        points.map(|point| glam::Vec3::from_array(point.to_array())).collect()
    }

    fn energy(&self) -> Option<f64> {
        None
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        None
    }
}
