//! The demo's command line.

use std::path::PathBuf;

use bevy::math::UVec2;
use bevy_drape::prelude::SelfContact;
use clap::Parser;

use crate::cannon_demo::scene::CannonScene;

/// A cannon bombards a curtain.
#[derive(Clone, Debug, Parser)]
#[command(version, about)]
pub struct Arguments {
    /// Run without a window, as fast as the machine can, and write a report. Without the feature `window` the
    /// demo always does.
    #[arg(long)]
    pub headless: bool,

    /// Number of shots, three seconds apart.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=100))]
    pub shots: u32,

    /// Folder for report.json, plot.svg and frames; made if it does not exist.
    #[arg(long, value_name = "DIR", default_value = "target/cannon")]
    pub out: PathBuf,

    /// Particles of the curtain, columns x rows.
    #[arg(long, value_name = "COLUMNSxROWS", default_value = "64x48", value_parser = parse_particles)]
    pub particles: UVec2,

    /// Substeps of the curtain in each step of 1/60 s.
    #[arg(long, default_value_t = CannonScene::default().substeps, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub substeps: u32,

    /// Relaxation iterations in each substep.
    #[arg(long, default_value_t = CannonScene::default().iterations, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub iterations: u32,

    /// Threads that islands are solved on. The result does not depend on it.
    #[arg(long, default_value_t = default_threads(), value_parser = clap::value_parser!(u16).range(1..=256))]
    pub threads: u16,

    /// Instead measure collision detection of the shots by five methods, as in the founding paper's Table 1, and write
    /// table1.json (needs the feature `table1`).
    #[arg(long, conflicts_with = "soak")]
    pub table1: bool,

    /// Particles of the finer curtain that `--table1` measures too.
    #[arg(long, value_name = "COLUMNSxROWS", default_value = "200x150", value_parser = parse_particles)]
    pub table1_fine: UVec2,

    /// Instead fire every second for so long (simulated), take old balls away, and write soak.json: memory and time of
    /// a step, minute by minute.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub soak: Option<u32>,

    /// Let the curtain collide with itself.
    #[arg(long)]
    pub self_contact: bool,

    /// Instead draw the pictures of a film, 30 for each second, into the folder (needs the feature `render`).
    #[arg(long, conflicts_with_all = ["frames", "soak", "table1"])]
    pub film: bool,

    /// Also render PNG pictures of the scene, without a window (needs the feature `render`).
    #[arg(long)]
    pub frames: bool,
}

impl Arguments {
    /// The scene that these arguments ask for.
    pub fn scene(&self) -> CannonScene {
        CannonScene {
            particles: self.particles,
            substeps: self.substeps,
            iterations: self.iterations,
            shots: self.shots,
            self_contact: if self.self_contact { SelfContact::On } else { SelfContact::Off },
        }
    }
}

fn default_threads() -> u16 {
    std::thread::available_parallelism().map_or(1, |threads| threads.get().min(256) as u16)
}

fn parse_particles(text: &str) -> Result<UVec2, String> {
    let side = |text: &str| {
        let count: u32 = text.parse().map_err(|_| format!("`{text}` is not a number of particles"))?;
        if (2..=4096).contains(&count) {
            Ok(count)
        } else {
            Err(format!("a side has 2 to 4096 particles, not {count}"))
        }
    };
    let (columns, rows) = text.split_once('x').ok_or("expected COLUMNSxROWS, for example 128x96")?;
    Ok(UVec2::new(side(columns)?, side(rows)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_arguments_are_taken_and_bad_ones_named() {
        let parse = |line: &str| Arguments::try_parse_from(line.split_whitespace());
        let arguments = parse("cannon --headless --shots 3 --particles 128x96").expect("valid");
        assert_eq!((arguments.shots, arguments.particles), (3, UVec2::new(128, 96)));
        for (line, needle) in [
            ("cannon --colour red", "--colour"),
            ("cannon --particles 64", "COLUMNSxROWS"),
            ("cannon --particles 1x1", "2 to 4096"),
            ("cannon --substeps 0", "0 is not in 1..=256"),
            ("cannon --threads 0", "0 is not in 1..=256"),
        ] {
            let message = parse(line).expect_err(line).to_string();
            assert!(message.contains(needle), "{message}");
        }
    }
}
