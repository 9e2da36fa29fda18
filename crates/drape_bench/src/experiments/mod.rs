//! One experiment per file: measurements with a question of their own, and Table 1 of the founding paper.
//!
//! Imports `solvers`, `scenes`, `collision`, `measure` and `report`. The program runs one per
//! subcommand; the cannon demo runs `table1`.

pub mod bombardment;
#[cfg(feature = "plugin")]
pub mod broad;
pub mod contact;
pub mod contact_cost;
pub mod fabrics;
#[cfg(feature = "frame")]
pub mod frame;
pub mod golden;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod oracle;
pub mod presets;
pub mod quality;
#[cfg(feature = "plugin")]
pub mod rollback;
pub mod shots;
pub mod stability;
#[cfg(feature = "plugin")]
pub mod street;
pub mod table1;
pub mod torn;
