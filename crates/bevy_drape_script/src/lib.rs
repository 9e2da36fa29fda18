#![doc = include_str!("../README.md")]

pub mod checkpoint;
mod container;
pub mod recording;
