//! Tracks: bodies, balls and obstacles that are recorded as numbers.

use bevy_drape::drape_solver::Shape;
use serde::{Deserialize, Serialize};

/// Something that is recorded, from its first to its last frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Its `Name`, or its noun and the number of its creation.
    pub name: String,
    /// Its kind, with all that drawing it takes.
    pub kind: TrackKind,
}

/// The kind of a track, with all that drawing it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TrackKind {
    /// A cloth, rope or rig. Its values are the body's origin and the positions of its particles relative to that.
    Body {
        /// The number of particles.
        particles: u32,
        /// Triangles, as particle indices.
        faces: Vec<[u32; 3]>,
        /// The ends of structural sticks; empty if there are faces.
        sticks: Vec<[u32; 2]>,
    },
    /// A ball. Its values are the position of its centre and its rotation (x, y, z, w).
    Ball {
        /// Radius in metres.
        radius: f32,
    },
    /// An obstacle. Its values are the three columns of its matrix and its position.
    Obstacle {
        /// Its form.
        form: Form,
    },
}

/// The form of a recorded obstacle, in its own coordinates; lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Form {
    /// Everything behind a plane.
    HalfSpace {
        /// Unit normal, away from the solid side.
        normal: [f32; 3],
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f32,
    },
    /// A capsule along the Y axis.
    Capsule {
        /// Half the length of its axis.
        half_length: f32,
        /// Radius.
        radius: f32,
    },
    /// A box.
    Cuboid {
        /// Half its sides.
        half_extents: [f32; 3],
    },
    /// The inside of a box.
    Container {
        /// Half its sides.
        half_extents: [f32; 3],
    },
    /// Any other shape, as its bounding box.
    Other {
        /// Least corner.
        low: [f32; 3],
        /// Greatest corner.
        high: [f32; 3],
    },
    /// The convex hull of two balls on the Y axis.
    TaperedCapsule {
        /// Half the distance of their centres.
        half_length: f32,
        /// Radius of the lower ball.
        bottom_radius: f32,
        /// Radius of the upper ball.
        top_radius: f32,
    },
}

impl Form {
    /// The form of a shape.
    pub fn of(shape: &Shape) -> Self {
        match shape {
            Shape::HalfSpace { normal } => Self::HalfSpace { normal: normal.to_array() },
            Shape::Sphere { radius } => Self::Sphere { radius: *radius },
            Shape::Capsule { half_length, radius } => {
                Self::Capsule { half_length: *half_length, radius: *radius }
            }
            &Shape::TaperedCapsule { half_length, bottom_radius, top_radius } => {
                Self::TaperedCapsule { half_length, bottom_radius, top_radius }
            }
            Shape::Cuboid { half_extents } => Self::Cuboid { half_extents: half_extents.to_array() },
            Shape::Container { half_extents } => Self::Container { half_extents: half_extents.to_array() },
            other => {
                let (low, high) = other.local_bounds();
                Self::Other { low: low.to_array(), high: high.to_array() }
            }
        }
    }
}

impl TrackKind {
    /// The number of values of a state.
    pub(super) fn value_count(&self) -> usize {
        match self {
            // Saturates on 32-bit machines; such a count never equals that of a state.
            Self::Body { particles, .. } => (*particles as usize).saturating_add(1).saturating_mul(3),
            Self::Ball { .. } => 7,
            Self::Obstacle { .. } => 12,
        }
    }

    /// The number of a body's particles.
    pub fn particles(&self) -> Option<usize> {
        match self {
            Self::Body { particles, .. } => Some(*particles as usize),
            Self::Ball { .. } | Self::Obstacle { .. } => None,
        }
    }

    /// "body", "ball" or "obstacle".
    pub fn noun(&self) -> &'static str {
        match self {
            Self::Body { .. } => "body",
            Self::Ball { .. } => "ball",
            Self::Obstacle { .. } => "obstacle",
        }
    }

    /// True if every index is that of a particle.
    pub(super) fn is_sound(&self) -> bool {
        let Self::Body { particles, faces, sticks } = self else { return true };
        faces.iter().flatten().chain(sticks.iter().flatten()).all(|index| index < particles)
    }
}
