//! The progress bar of the command line.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar for `count` of these things, such as `runs`.
pub fn bar(count: u64, things: &str) -> ProgressBar {
    let progress = ProgressBar::new(count);
    if let Ok(style) =
        ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {things}, {{elapsed}} {{msg}}"))
    {
        progress.set_style(style);
    }
    progress
}
