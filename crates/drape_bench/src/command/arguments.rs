//! The command line, and the jobs that it stands for.

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, Parser, Subcommand};

#[cfg(feature = "plugin")]
use crate::experiments::broad::BroadArguments;
use crate::experiments::contact::report::ContactRuns;
use crate::experiments::contact_cost::ContactArguments;
use crate::experiments::fabrics::FabricArguments;
#[cfg(feature = "frame")]
use crate::experiments::frame::FrameArguments;
#[cfg(feature = "gpu")]
use crate::experiments::gpu::GpuArguments;
use crate::experiments::quality::QualityArguments;
#[cfg(feature = "plugin")]
use crate::experiments::rollback::RollbackArguments;
use crate::experiments::shots::ShotArguments;
#[cfg(feature = "plugin")]
use crate::experiments::street::StreetArguments;
use crate::experiments::torn::TornArguments;
use crate::measure::job::Job;
use crate::scenes::model::Pins;
use crate::scenes::scene::{Scene, SceneKind};
use crate::solvers::options::{Projection, SolverOptions};
use crate::solvers::solver::Solver;

/// Named scenes, this solver and its peers: what a step costs and how far the cloth stretches.
#[derive(Parser)]
#[command(version, about)]
pub struct Arguments {
    /// The subcommand.
    #[command(subcommand)]
    pub task: Task,
}

/// The subcommands.
#[derive(Subcommand)]
pub enum Task {
    /// Measures.
    #[command(flatten)]
    Measure(Command),
    /// Checks that no choice of settings makes a sheet gain energy, with and without a violent start.
    Stability {
        /// Sizes of the sheet.
        #[arg(long, value_delimiter = ',', default_values_t = [32, 64, 128, 256])]
        sizes: Vec<u32>,
        /// Steps of a trial.
        #[arg(long, default_value_t = 240, value_parser = clap::value_parser!(u32).range(31..=100_000))]
        steps: u32,
    },
    /// Shoots balls at curtains, and counts those that pass through.
    Shots(ShotArguments),
    /// Measures many cloths among many obstacles.
    #[cfg(feature = "plugin")]
    Broad(BroadArguments),
    /// Measures flags along a street, with and without levels of detail.
    #[cfg(feature = "plugin")]
    Street(StreetArguments),
    /// Measures what a frame with cloth costs: steps, meshes, and what Bevy's renderer does with them.
    #[cfg(feature = "frame")]
    Frame(FrameArguments),
    /// Measures saving and restoring, and cloths that are rolled back in each frame.
    #[cfg(feature = "plugin")]
    Rollback(RollbackArguments),
    /// Measures the cost per particle of each kind of contact.
    Contacts(ContactArguments),
    /// Measures cloth and ropes against themselves: times, and edges that pass through triangles.
    Contact(ContactRuns),
    /// Measures the cost of torn cloth, and of tearing.
    Torn(TornArguments),
    /// Measures the time to quality: the cost of a step at which a sheet stretches by no more than 1 %, 0.1 % and 0.01 %.
    Quality(QualityArguments),
    /// Measures drape and stretch of the named materials.
    Presets,
    /// Measures bending and drape of fabrics that a laboratory has measured.
    Fabrics(FabricArguments),
    /// Measures the solver on the GPU beside the one on the processor.
    #[cfg(feature = "gpu")]
    Gpu(GpuArguments),
    /// Prints hashes of the final states of scenes, which are equal on every machine.
    Hashes {
        /// Also compare them with those in this file.
        #[arg(long, value_name = "FILE")]
        golden: Option<PathBuf>,
        /// Threads.
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
        threads: u32,
    },
}

/// The measurements of named scenes.
#[derive(Subcommand)]
pub enum Command {
    /// Measures one solver.
    Run {
        /// Size of the scene: particles in a row of a sheet, vertices of a mesh, or number of bodies.
        #[arg(long, visible_alias = "count")]
        n: Option<u32>,
        /// The solver: drape, naive, coloured or plugin.
        #[arg(long)]
        solver: Option<String>,
        /// Threads.
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
        threads: u32,
        /// Everything else.
        #[command(flatten)]
        common: Common,
    },
    /// Measures several solvers and sizes in turns.
    Compare {
        /// Sizes of the scene.
        #[arg(long, visible_alias = "counts", value_delimiter = ',')]
        sizes: Vec<u32>,
        /// The solvers: drape, naive, coloured, plugin.
        #[arg(long, value_delimiter = ',')]
        solvers: Vec<String>,
        /// Numbers of threads; solvers that know only one thread run once.
        #[arg(long, value_delimiter = ',', default_values_t = [1], value_parser = clap::value_parser!(u32).range(1..=256))]
        threads: Vec<u32>,
        /// Everything else.
        #[command(flatten)]
        common: Common,
    },
}

/// Options of both commands.
#[derive(Args)]
pub struct Common {
    /// The scene.
    #[arg(long, value_enum, default_value_t = SceneKind::Sheet)]
    pub scene: SceneKind,
    /// Substeps in a step of 1/60 s.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub substeps: u32,
    /// Relaxation sweeps in a substep.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub sweeps: u32,
    /// The pinned particles.
    #[arg(long, value_enum, default_value_t = Pins::Corners)]
    pub pins: Pins,
    /// The formula by which this project's solver moves the ends of a stick.
    #[arg(long, value_enum, default_value_t = Projection::SquareRootFree)]
    pub projection: Projection,
    /// This project's solver solves rows and columns of structural sticks directly.
    #[arg(long)]
    pub lines: bool,
    /// Number of timed runs of each; the median and the least are reported.
    #[arg(long, default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Steps of a run; the first tenth is neither timed nor counted as motion.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    pub steps: u32,
    /// Also write the table as comma-separated values.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Also write the table as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Also draw cost and stretch by size, as SVG.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

impl Command {
    /// Options of both commands.
    pub fn common(&self) -> &Common {
        match self {
            Self::Run { common, .. } | Self::Compare { common, .. } => common,
        }
    }

    /// The jobs, in the order of the table. `known` are the solvers to choose from.
    ///
    /// # Errors
    /// If a scene cannot be made, or a solver is not known.
    pub fn jobs(&self, known: &[Solver]) -> Result<Vec<Job>, Box<dyn Error>> {
        let common = self.common();
        let kind = common.scene;
        let solvers = self.solver_names().into_iter().map(|name| Solver::find(name, known));
        let solvers: Vec<Solver> = solvers.collect::<Result<_, _>>()?;
        let mut jobs = Vec::new();
        for (kind, n) in self.scenes(kind) {
            let scene = Arc::new(Scene::new(kind, n, common.pins)?);
            for &solver in &solvers {
                for &threads in self.threads(&solver) {
                    jobs.push(common.job(&scene, solver, threads));
                }
            }
        }
        Ok(jobs)
    }

    /// The requested scenes and sizes, or else the usual ones.
    fn scenes(&self, kind: SceneKind) -> Vec<(SceneKind, u32)> {
        let parts = kind.parts();
        let main = parts[0].0;
        match self {
            Self::Run { n, .. } => vec![(main, n.unwrap_or(kind.usual_size()))],
            Self::Compare { sizes, .. } if sizes.is_empty() => {
                parts.iter().flat_map(|&(kind, sizes)| sizes.iter().map(move |&n| (kind, n))).collect()
            }
            Self::Compare { sizes, .. } => sizes.iter().map(|&n| (main, n)).collect(),
        }
    }

    fn solver_names(&self) -> Vec<&str> {
        let kind = self.common().scene;
        match self {
            Self::Run { solver, .. } => vec![solver.as_deref().unwrap_or(kind.usual_solver())],
            Self::Compare { solvers, .. } if solvers.is_empty() => kind.usual_solvers().to_vec(),
            Self::Compare { solvers, .. } => solvers.iter().map(String::as_str).collect(),
        }
    }

    fn threads(&self, solver: &Solver) -> &[u32] {
        match self {
            Self::Run { threads, .. } => std::slice::from_ref(threads),
            Self::Compare { .. } if !solver.has_threads => &[1],
            Self::Compare { threads, .. } => threads,
        }
    }
}

impl Common {
    fn job(&self, scene: &Arc<Scene>, solver: Solver, threads: u32) -> Job {
        let &Self { substeps, sweeps, projection, lines, steps, .. } = self;
        let options =
            SolverOptions { substeps, sweeps, threads, projection, lines, ..SolverOptions::default() };
        Job { scene: Arc::clone(scene), solver, options, steps: steps as usize }
    }

    /// The settings of the solvers that the table does not show.
    pub fn summary(&self) -> String {
        let sticks = match self.projection {
            Projection::Exact => "exact",
            Projection::SquareRootFree => "square-root-free",
        };
        let lines = if self.lines { ", lines" } else { "" };
        let Self { substeps, sweeps, steps, repeat, .. } = self;
        format!(
            "{steps} steps of {substeps} substeps x {sweeps} sweeps, timed {repeat} times; \
             drape: {sticks} sticks{lines}, tethers; naive: {} sweeps of one step",
            substeps * sweeps
        )
    }
}
