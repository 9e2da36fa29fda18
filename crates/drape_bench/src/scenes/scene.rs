//! The named scenes.

use std::ops::RangeInclusive;
use std::sync::Arc;

use clap::ValueEnum;
use drape_solver::glam::Vec3;
use thiserror::Error;

use crate::scenes::mesh::mesh;
use crate::scenes::model::{Model, Pins};
use crate::scenes::rope::rope;
use crate::scenes::sheet::{curtain, sheet};

/// Particles along a side of each of many sheets.
const SMALL_SHEET: u32 = 16;
/// Particles along a side of a sheet at rest.
const RESTING_SHEET: u32 = 8;
/// Particles of a rope.
const ROPE: u32 = 64;
/// Distance between sheets at rest, in metres: none touches another.
const RESTING_DISTANCE: f32 = 3.0;

/// The scenes by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SceneKind {
    /// One sheet of n x n particles.
    Sheet,
    /// n sheets of 16 x 16 particles that do not meet.
    Many,
    /// A sheet of 1024 x 1024 particles, beside one pass over its memory.
    Million,
    /// An irregular triangle mesh of n vertices in random order.
    Mesh,
    /// n ropes of 64 particles.
    Ropes,
    /// n sheets of 8 x 8 particles at rest, in the Bevy plugin.
    Asleep,
    /// `sheet` and `many` in the Bevy plugin, beside the bare solver.
    Plugin,
}

/// A scene that cannot be made.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The size is out of range.
    #[error("scene {scene} takes a size of {least} to {most}, not {found}", least = .range.start(), most = .range.end())]
    Size {
        /// The scene.
        scene: &'static str,
        /// The sizes that it takes.
        range: RangeInclusive<u32>,
        /// The size that was given.
        found: u32,
    },
    /// The mesh cannot be triangulated.
    #[error("no mesh: {0}")]
    Mesh(#[from] spade::InsertionError),
}

impl SceneKind {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sheet => "sheet",
            Self::Many => "many",
            Self::Million => "million",
            Self::Mesh => "mesh",
            Self::Ropes => "ropes",
            Self::Asleep => "asleep",
            Self::Plugin => "plugin",
        }
    }

    /// The scenes that this one is made of, with their usual sizes in a comparison.
    pub fn parts(self) -> &'static [(Self, &'static [u32])] {
        match self {
            Self::Sheet => &[(Self::Sheet, &[32, 64, 128, 256])],
            Self::Many => &[(Self::Many, &[100, 1000])],
            Self::Million => &[(Self::Million, &[1024])],
            Self::Mesh => &[(Self::Mesh, &[5000, 50_000])],
            Self::Ropes => &[(Self::Ropes, &[1000])],
            Self::Asleep => &[(Self::Asleep, &[10_000])],
            Self::Plugin => &[(Self::Sheet, &[64, 128, 256]), (Self::Many, &[100, 1000])],
        }
    }

    /// The default size of a single run.
    pub fn usual_size(self) -> u32 {
        match self {
            Self::Sheet => 128,
            Self::Plugin => 64,
            _ => self.parts()[0].1[0],
        }
    }

    /// The default solvers of a comparison.
    pub fn usual_solvers(self) -> &'static [&'static str] {
        match self {
            Self::Asleep => &["plugin"],
            Self::Plugin => &["drape", "plugin"],
            _ => &["drape", "naive", "coloured"],
        }
    }

    /// The default solver of a single run.
    pub fn usual_solver(self) -> &'static str {
        match self {
            Self::Asleep | Self::Plugin => "plugin",
            _ => "drape",
        }
    }

    fn sizes(self) -> RangeInclusive<u32> {
        match self {
            Self::Sheet | Self::Million | Self::Plugin => 3..=4096,
            Self::Many | Self::Ropes | Self::Asleep => 1..=100_000,
            Self::Mesh => 16..=1_000_000,
        }
    }
}

/// A scene ready to be loaded: equal bodies that do not meet.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The kind of scene.
    pub kind: SceneKind,
    /// Its size, as the kind counts it.
    pub n: u32,
    /// The pinned particles of each body.
    pub pins: Pins,
    /// The model of each body.
    pub model: Arc<Model>,
    /// Number of bodies.
    pub bodies: u32,
}

impl Scene {
    /// The scene `kind` of size `n`. Ropes and sheets at rest have their own pins.
    ///
    /// # Errors
    /// [`SceneError`] if the size is out of range.
    pub fn new(kind: SceneKind, n: u32, pins: Pins) -> Result<Self, SceneError> {
        let range = kind.sizes();
        if !range.contains(&n) {
            return Err(SceneError::Size { scene: kind.name(), range, found: n });
        }
        let (model, pins, bodies) = match kind {
            SceneKind::Sheet | SceneKind::Million | SceneKind::Plugin => (sheet(n, pins), pins, 1),
            SceneKind::Many => (sheet(SMALL_SHEET, pins), pins, n),
            SceneKind::Mesh => (mesh(n, pins)?, pins, 1),
            SceneKind::Ropes => (rope(ROPE), Pins::Start, n),
            SceneKind::Asleep => (curtain(RESTING_SHEET), Pins::Edge, n),
        };
        Ok(Self { kind, n, pins, model: Arc::new(model), bodies })
    }

    /// Number of particles of all bodies.
    pub fn particle_count(&self) -> usize {
        self.model.positions.len() * self.bodies as usize
    }

    /// Number of sticks of all bodies.
    pub fn stick_count(&self) -> usize {
        self.model.stick_count() * self.bodies as usize
    }

    /// Position of body `i` in metres, relative to the model's own. Bodies that never meet may all share one.
    pub fn offset(&self, i: u32) -> Vec3 {
        if self.kind == SceneKind::Asleep {
            let side = f64::from(self.bodies).sqrt().ceil() as u32;
            let place = |i: u32| (i as f32 - 0.5 * side as f32) * RESTING_DISTANCE;
            Vec3::new(place(i % side), 0.0, place(i / side))
        } else {
            Vec3::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_can_be_made_at_its_usual_sizes() {
        for &kind in SceneKind::value_variants() {
            for &(part, sizes) in kind.parts() {
                for &n in sizes {
                    let scene = Scene::new(part, n, Pins::Corners).expect("a scene");
                    assert_eq!(
                        scene.model.inverse_masses().len() * scene.bodies as usize,
                        scene.particle_count()
                    );
                }
            }
        }
    }

    #[test]
    fn scenes_have_the_particles_and_sticks_that_their_names_say() {
        let counts = |kind, n| {
            let scene = Scene::new(kind, n, Pins::Corners).expect("a scene");
            (scene.particle_count(), scene.stick_count())
        };
        assert_eq!(counts(SceneKind::Many, 100), (25_600, 100 * (480 + 450 + 448)));
        assert_eq!(counts(SceneKind::Ropes, 1000), (64_000, 63_000));
        assert_eq!(counts(SceneKind::Asleep, 10_000), (640_000, 10_000 * (112 + 98 + 96)));
        assert_eq!(counts(SceneKind::Million, 1024).0, 1_048_576);
        assert_eq!(counts(SceneKind::Mesh, 5000).0, 5000);
    }

    #[test]
    fn a_size_out_of_range_is_refused() {
        for (kind, n) in [(SceneKind::Sheet, 2), (SceneKind::Many, 0), (SceneKind::Mesh, 3)] {
            let error = Scene::new(kind, n, Pins::Edge).expect_err("too small").to_string();
            assert!(error.contains(kind.name()), "{error}");
        }
    }

    #[test]
    fn sheets_at_rest_do_not_touch() {
        let scene = Scene::new(SceneKind::Asleep, 50, Pins::Edge).expect("a scene");
        for i in 0..50 {
            for j in 0..i {
                assert!(scene.offset(i).distance(scene.offset(j)) > 2.0);
            }
        }
    }
}
