//! The `main` of an example: runs it in a window, without one, or draws its picture.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use crate::feature::example::Feature;
#[cfg(feature = "render")]
use crate::feature::picture;

#[derive(Parser, Debug)]
struct FeatureArguments {
    /// Run without a window, and print the result.
    #[arg(long)]
    headless: bool,
    /// Simulated time of a run without a window, or until the picture.
    #[arg(long, visible_alias = "at", value_name = "SECONDS")]
    seconds: Option<f32>,
    /// Draw a picture into this PNG file instead (needs `--features render`).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Draw the pictures of a film of three seconds into this folder instead (needs `--features render`).
    #[arg(long, value_name = "FOLDER", conflicts_with = "picture")]
    film: Option<PathBuf>,
}

impl Feature {
    /// The example's `main`: does what the command line asks for.
    pub fn run(&self) -> ExitCode {
        let arguments = FeatureArguments::parse();
        match self.obey(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::FAILURE
            }
        }
    }

    fn obey(&self, arguments: &FeatureArguments) -> Result<(), Box<dyn core::error::Error>> {
        let seconds = arguments.seconds.unwrap_or(self.picture_time);
        if let Some(path) = arguments.picture.as_ref().or(arguments.film.as_ref()) {
            #[cfg(feature = "render")]
            return match arguments.picture {
                Some(_) => picture::draw(self, seconds, path),
                None => picture::film(self, seconds, path),
            }
            .map_err(Into::into);
            #[cfg(not(feature = "render"))]
            return Err(format!("{} needs `--features render`", path.display()).into());
        }
        #[cfg(feature = "window")]
        if !arguments.headless {
            return crate::feature::window::open(self).map_err(Into::into);
        }
        if !arguments.headless {
            println!("No window without `--features window`: running without one.");
        }
        let report = self.run_headless(seconds)?;
        println!(
            "{}\n{} steps, {} bodies of {} particles, {} balls; greatest speed {:.1} m/s",
            self.title, report.steps, report.bodies, report.particles, report.balls, report.greatest_speed
        );
        if let Some(finding) = report.finding {
            println!("{finding}");
        }
        Ok(())
    }
}
