//! The report of a run.

use core::fmt;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::play::Verdict;
use crate::text::SceneError;

/// The results of a scene: measured values, and the verdicts on its expectations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// Its file, if it was loaded from one.
    pub file: Option<PathBuf>,
    /// The file of the run's recording, if there is one.
    pub recording: Option<PathBuf>,
    /// Number of steps taken.
    pub steps: u64,
    /// Simulated time in seconds.
    pub simulated_s: f64,
    /// Time on the wall clock in seconds.
    pub wall_s: f64,
    /// Hash of all positions and velocities at the end.
    pub state_hash: String,
    /// The results of the expectations, in their order.
    pub verdicts: Vec<Verdict>,
    /// Everything that the plugin refused or that could not be done, in words. A scene with problems has failed.
    pub problems: Vec<String>,
    /// Actions without effect, in words: actions on things that do not exist, cuts that severed nothing, triggers that
    /// never fired, a scene without expectations. Notes do not fail a scene.
    #[serde(default)]
    pub notes: Vec<String>,
}

impl Report {
    /// The report of a scene that could not be run.
    pub fn failed(scene: String, file: Option<PathBuf>, problem: &str) -> Self {
        Self {
            scene,
            file,
            recording: None,
            steps: 0,
            simulated_s: 0.0,
            wall_s: 0.0,
            state_hash: String::new(),
            verdicts: Vec::new(),
            problems: vec![problem.to_string()],
            notes: Vec::new(),
        }
    }

    /// Returns true if every expectation holds and there was no problem.
    pub fn passed(&self) -> bool {
        self.problems.is_empty() && self.verdicts.iter().all(|verdict| verdict.passed)
    }

    /// The expectations that do not hold.
    pub fn failures(&self) -> impl Iterator<Item = &Verdict> {
        self.verdicts.iter().filter(|verdict| !verdict.passed)
    }

    /// All failures, one per line: scene, expectation, time, expected and measured value; and the file of the
    /// recording. Empty if the scene passed.
    pub fn complaint(&self) -> String {
        let mut lines: Vec<String> =
            self.problems.iter().map(|problem| format!("{}: {problem}", self.scene)).collect();
        lines.extend(self.failures().map(|verdict| format!("{}: {verdict}", self.scene)));
        if !lines.is_empty() {
            match &self.recording {
                Some(path) => lines.push(format!("recording: {}", path.display())),
                None => lines.push("recording: none was made".to_string()),
            }
        }
        lines.join("\n")
    }

    /// Asserts that the scene passed.
    ///
    /// # Panics
    /// If it failed, with the [`complaint`](Self::complaint).
    #[track_caller]
    pub fn assert_passed(&self) {
        assert!(self.passed(), "{}", self.complaint());
    }

    /// The report as JSON.
    ///
    /// # Errors
    /// [`SceneError`] if it cannot be written as JSON.
    pub fn to_json(&self) -> Result<String, SceneError> {
        serde_json::to_string_pretty(self).map_err(SceneError::new)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, steps, simulated_s, wall_s, state_hash, .. } = self;
        let result = if self.passed() { "passed" } else { "FAILED" };
        writeln!(
            f,
            "{scene}: {result}, {steps} steps, {simulated_s:.3} s in {wall_s:.3} s, state {state_hash}"
        )?;
        for verdict in &self.verdicts {
            writeln!(f, "  {verdict}")?;
        }
        for problem in &self.problems {
            writeln!(f, "  FAIL {problem}")?;
        }
        for note in &self.notes {
            writeln!(f, "  note {note}")?;
        }
        match &self.recording {
            Some(path) => writeln!(f, "  recording: {}", path.display()),
            None => Ok(()),
        }
    }
}
