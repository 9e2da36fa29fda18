//! What the cannon demo is made of: scene, recorder, report, and the ways to watch it.
//!
//! The demo is the founding experiment of the method (Liu Yuan 2019): a cannon bombards a curtain; the ball flies,
//! hits, and the curtain finds its rest again.

pub mod arguments;
pub mod headless;
pub mod output;
pub mod plot;
pub mod recorder;
pub mod report;
pub mod scene;
