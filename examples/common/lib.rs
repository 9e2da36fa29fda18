//! The parts that the examples are made of.
//!
//! The cannon demo is the founding experiment of the method (Liu Yuan 2019): a cannon bombards a curtain; the ball flies,
//! hits, and the curtain comes to rest again.
//!
//! # Floors
//!
//! Each folder imports from folders below it only.
//!
//! ```text
//! showcase/       all examples of features in one window
//! feature/        an example of one feature: command line, run without a window, window, picture
//! scripted/       the runner of scripted scenes: suites, recordings, plots, pictures, windows
//! cannon_demo/    the cannon demo: scene, report, Table 1, soak, window
//! character/      a walking character in a cape, and its glTF file
//! furniture       furniture, as a glTF file
//! view/           meshes, materials, light, cameras, windows, drawing without a window
//! progress        a progress bar in the terminal
//! ```

pub mod cannon_demo;
#[cfg(feature = "meshes")]
pub mod character;
pub mod feature;
#[cfg(feature = "meshes")]
pub mod furniture;
pub mod progress;
#[cfg(feature = "scenes")]
pub mod scripted;
#[cfg(feature = "window")]
pub mod showcase;
pub mod view;
