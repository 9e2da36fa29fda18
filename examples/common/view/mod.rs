//! Shared parts of windows and pictures: meshes, materials, light, cameras, and drawing without a window.
//!
//! Imports no other folder.

/// True in the page of a browser, which has a help and a list of its own.
#[cfg(feature = "render")]
pub(crate) const IN_PAGE: bool = cfg!(all(feature = "web", target_family = "wasm"));

#[cfg(feature = "render")]
mod adapter;
#[cfg(feature = "meshes")]
pub mod asset_files;
#[cfg(feature = "render")]
mod cannon_model;
#[cfg(feature = "window")]
pub(crate) mod clock_keys;
#[cfg(feature = "gltf")]
pub mod gltf_files;
#[cfg(feature = "meshes")]
pub mod gltf_writer;
#[cfg(feature = "render")]
pub(crate) mod lighting;
#[cfg(feature = "render")]
pub(crate) mod offscreen;
#[cfg(feature = "window")]
pub(crate) mod orbit;
#[cfg(all(feature = "web", target_family = "wasm"))]
pub mod page;
pub mod paint;
#[cfg(feature = "window")]
pub(crate) mod pointer;
#[cfg(feature = "render")]
pub(crate) mod shape_meshes;
#[cfg(feature = "render")]
pub(crate) mod shared_materials;
#[cfg(feature = "window")]
pub mod slider;
#[cfg(feature = "window")]
pub(crate) mod text_panel;
#[cfg(feature = "render")]
pub(crate) mod textures;
#[cfg(feature = "window")]
pub(crate) mod touch;
#[cfg(feature = "render")]
pub(crate) mod tubes;
#[cfg(feature = "render")]
pub(crate) mod viewpoint;
#[cfg(feature = "window")]
pub(crate) mod window;
