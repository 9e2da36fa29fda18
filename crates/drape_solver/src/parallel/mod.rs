//! Threads of the host, and the workers that share large bodies and those of an island.
//!
//! ```
//! use drape_solver::{BodySettings, ClothBuilder, Environment, Island, Threads, step_on};
//!
//! /// A second thread for each piece of work. A pool is quicker.
//! struct Two;
//!
//! impl Threads for Two {
//!     fn count(&self) -> usize {
//!         2
//!     }
//!
//!     fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
//!         std::thread::scope(|scope| {
//!             scope.spawn(other);
//!             one();
//!         });
//!     }
//! }
//!
//! let mut island = Island::of_body(ClothBuilder::new(1.0, 1.0, 128, 128).build(BodySettings::default())?);
//! step_on(&mut island, &Environment::default(), &Two)?;
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! Imports: nothing. Callers: every floor that shares a body between threads.

pub(crate) mod for_each;
pub(crate) mod gather;
#[cfg(test)]
pub(crate) mod testing;
pub mod threads;
pub(crate) mod workers;
