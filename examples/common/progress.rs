//! A bar in the terminal that shows how far a long run is.
//!
//! Imports no other module. `cannon_demo` and `scripted` call it.

#[cfg(not(target_family = "wasm"))]
use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar. There is none where the output is no terminal, and on WebAssembly.
pub struct Progress {
    #[cfg(not(target_family = "wasm"))]
    bar: ProgressBar,
}

#[cfg(not(target_family = "wasm"))]
impl Progress {
    /// A bar for `count` of these things, such as `steps`, with a message before it.
    pub fn new(message: &str, count: u64, things: &str) -> Self {
        let bar = ProgressBar::new(count);
        let template = format!("{{msg}} {{bar:40}} {{pos}}/{{len}} {things}, {{elapsed}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        Self { bar: bar.with_message(message.to_string()) }
    }

    /// Shows that so many are done.
    pub fn set(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(target_family = "wasm")]
impl Progress {
    /// No bar.
    pub fn new(_: &str, _: u64, _: &str) -> Self {
        Self {}
    }

    /// Shows nothing.
    pub fn set(&self, _: u64) {}

    /// Does nothing.
    pub fn finish(&self) {}
}
