//! The solvers by name.

use thiserror::Error;

use crate::failure::Failure;
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::coloured::coloured;
use crate::solvers::drape::Drape;
#[cfg(feature = "gpu")]
use crate::solvers::gpu::DrapeGpu;
use crate::solvers::naive::naive;
use crate::solvers::options::SolverOptions;
#[cfg(feature = "plugin")]
use crate::solvers::plugin::Plugin;
use crate::solvers::simulation::Simulation;

/// Loads a scene into a solver.
pub type Loader = fn(&Scene, &SolverOptions) -> Result<Box<dyn Simulation>, Failure>;

/// A solver by name.
#[derive(Clone, Copy, Debug)]
pub struct Solver {
    /// The name on the command line and in tables.
    pub name: &'static str,
    /// True if it can use more than one thread.
    pub has_threads: bool,
    /// Loads a scene.
    pub load: Loader,
}

/// The solvers that are compiled here.
///
/// - `drape`: this project's.
/// - `naive`: a sequential Jakobsen loop in natural order, as a reader of the paper would write it.
/// - `coloured`: the same scalar code in independent order, with real substeps.
/// - `plugin`: this project's, in Bevy.
/// - `gpu`: this project's on the GPU, from the start of a step until it is done.
pub const OWN: &[Solver] = &[
    Solver {
        name: "drape",
        has_threads: true,
        load: |scene, options| {
            refuse_sleepers("drape", scene)?;
            Ok(Box::new(Drape::new(scene, options)?))
        },
    },
    Solver {
        name: "naive",
        has_threads: false,
        load: |scene, options| {
            refuse_sleepers("naive", scene)?;
            Ok(Box::new(naive(scene, options)))
        },
    },
    Solver {
        name: "coloured",
        has_threads: false,
        load: |scene, options| {
            refuse_sleepers("coloured", scene)?;
            Ok(Box::new(coloured(scene, options)))
        },
    },
    #[cfg(feature = "plugin")]
    Solver {
        name: "plugin",
        has_threads: true,
        load: |scene, options| Ok(Box::new(Plugin::new(scene, options)?)),
    },
    #[cfg(feature = "gpu")]
    Solver {
        name: "gpu",
        has_threads: false,
        load: |scene, options| {
            refuse_sleepers("gpu", scene)?;
            Ok(Box::new(DrapeGpu::new(scene, options)?))
        },
    },
];

/// Rejects the scene of sleeping bodies, for solvers without sleep.
///
/// # Errors
/// [`Failure::Scene`].
pub fn refuse_sleepers(solver: &'static str, scene: &Scene) -> Result<(), Failure> {
    if scene.kind == SceneKind::Asleep {
        return Err(Failure::Scene { solver, scene: scene.kind.name() });
    }
    Ok(())
}

impl Solver {
    /// Loads `scene` into this solver.
    ///
    /// # Errors
    /// [`Failure`] if the solver cannot run it so.
    pub fn load(&self, scene: &Scene, options: &SolverOptions) -> Result<Box<dyn Simulation>, Failure> {
        if options.threads > 1 && !self.has_threads {
            return Err(Failure::Threads { solver: self.name, scene: "any scene", threads: options.threads });
        }
        (self.load)(scene, options)
    }

    /// Finds the solver called `name` among `solvers`.
    ///
    /// # Errors
    /// [`UnknownSolver`] with the known names.
    pub fn find(name: &str, solvers: &[Self]) -> Result<Self, UnknownSolver> {
        let found = solvers.iter().find(|solver| solver.name == name).copied();
        found.ok_or_else(|| UnknownSolver {
            name: name.to_owned(),
            known: solvers.iter().map(|solver| solver.name).collect(),
        })
    }
}

/// A name that no solver has.
#[derive(Debug, Error)]
#[error("no solver is called {name}; there are {}", known.join(", "))]
pub struct UnknownSolver {
    name: String,
    known: Vec<&'static str>,
}

#[cfg(test)]
mod tests {
    use drape_solver::glam::Vec3;

    use super::*;
    use crate::scenes::model::Pins;
    use crate::scenes::world::{SPHERE_CENTRE, SPHERE_RADIUS};

    fn options() -> SolverOptions {
        SolverOptions { substeps: 16, ..SolverOptions::default() }
    }

    #[test]
    fn every_solver_drapes_the_same_particles_over_the_same_sphere() {
        for kind in [SceneKind::Sheet, SceneKind::Many, SceneKind::Mesh, SceneKind::Ropes] {
            let scene = Scene::new(kind, if kind == SceneKind::Mesh { 200 } else { 9 }, Pins::Corners);
            let scene = scene.expect("a scene");
            let size = scene.model.positions.len();
            let mut centres = Vec::new();
            for solver in OWN {
                let end = end(solver, &scene, &options());
                assert_eq!(end.len(), scene.particle_count(), "{}", solver.name);
                for (i, &position) in end.iter().enumerate() {
                    let start = scene.model.positions[i % size];
                    let is_pinned = scene.model.pinned.contains(&((i % size) as u32));
                    assert_eq!(position == start, is_pinned, "{} {kind:?} particle {i}", solver.name);
                    let height = position.distance(SPHERE_CENTRE) - SPHERE_RADIUS;
                    assert!(height > -1e-3, "{} {kind:?} particle {i} at {height}", solver.name);
                }
                centres.push(end.iter().sum::<Vec3>() / end.len() as f32);
            }
            // All but the naive loop take real substeps: they differ in stretch, not in motion.
            let fallen = -centres[0].y;
            assert!(fallen > 0.05, "{kind:?} fell {fallen} m");
            for (solver, centre) in OWN.iter().zip(&centres).filter(|(solver, _)| solver.name != "naive") {
                let difference = centre.distance(centres[0]);
                assert!(difference < 0.2 * fallen, "{} {kind:?}: {difference} of {fallen} m", solver.name);
            }
        }
    }

    /// Positions after a quarter of a second: later, small differences grow.
    fn end(solver: &Solver, scene: &Scene, options: &SolverOptions) -> Vec<Vec3> {
        let mut simulation = solver.load(scene, options).expect("it can run this");
        for _ in 0..15 {
            simulation.step().expect("it steps");
        }
        simulation.positions()
    }

    #[test]
    fn two_threads_give_the_same_bits() {
        let drape = Solver::find("drape", OWN).expect("it is there");
        for (kind, n) in [(SceneKind::Many, 7), (SceneKind::Sheet, 96)] {
            let scene = Scene::new(kind, n, Pins::Corners).expect("a scene");
            let two = SolverOptions { threads: 2, ..options() };
            assert_eq!(end(&drape, &scene, &options()), end(&drape, &scene, &two));
        }
    }

    #[test]
    fn what_cannot_be_run_is_refused() {
        let sheet = Scene::new(SceneKind::Sheet, 5, Pins::Corners).expect("a scene");
        let asleep = Scene::new(SceneKind::Asleep, 2, Pins::Corners).expect("a scene");
        let two = SolverOptions { threads: 2, ..options() };
        let naive = Solver::find("naive", OWN).expect("it is there");
        assert!(naive.load(&sheet, &two).is_err());
        assert!(naive.load(&asleep, &options()).is_err());
        let error = Solver::find("no such", OWN).expect_err("there is none").to_string();
        assert!(error.contains("drape, naive, coloured"), "{error}");
    }
}
