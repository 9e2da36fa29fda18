//! The builder of ragdolls: eleven limbs that are joined by shared particles.
//!
//! ```text
//!            o           head: turns about the line through the shoulders
//!     o-----o-o-----o    shoulders: pins; elbows: hinges of two particles
//!            |/          chest and pelvis: rigid bodies of four particles and six sticks
//!            o           that share the waist, a pin
//!           /|\
//!          o o o         hips: pins; knees: hinges of two particles
//!          o   o
//!          o   o         feet
//! ```
//!
//! Sticks with a bound limit the angles (Jakobsen 2001, section 6): an elbow that can become neither quite straight nor
//! quite folded cannot bend backwards.
//!
//! Design: `docs/design/rigs.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::topology_builder::TopologyBuilder;
use crate::error::{BuildError, positive};
use crate::geometry::pose::{Placement, Pose};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickBound, StickKind, StickMaterial};

/// A human figure that stands upright and faces +Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RagdollBuilder {
    height: f32,
    mass: f32,
    placement: Placement,
}

/// A stick of a ragdoll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RagdollStick {
    /// Indices of its two particles.
    pub ends: [u32; 2],
    /// Rest length in metres.
    pub length: f32,
    /// Exact sticks make limbs; the others limit joints.
    pub bound: StickBound,
}

/// Height in metres of the figure in the tables below.
const TABLE_HEIGHT: f32 = 1.75;

/// A particle of the figure: its place in metres from the ground between the feet, and its part of the mass.
struct Joint {
    at: Vec3,
    weight: f32,
}

const fn joint(x: f32, y: f32, z: f32, weight: f32) -> Joint {
    Joint { at: Vec3::new(x, y, z), weight }
}

const HEAD: u32 = 0;
const SHOULDERS: [u32; 2] = [1, 2];
const STERNUM: u32 = 3;
const WAIST: u32 = 4;
const HIPS: [u32; 2] = [5, 6];
const SACRUM: u32 = 7;
/// For each side the outer and the inner end of the axis.
const ELBOWS: [[u32; 2]; 2] = [[8, 9], [10, 11]];
const HANDS: [u32; 2] = [12, 13];
const KNEES: [[u32; 2]; 2] = [[14, 15], [16, 17]];
const FEET: [u32; 2] = [18, 19];

const JOINTS: [Joint; 20] = [
    joint(0.0, 1.62, 0.02, 0.07),
    joint(0.18, 1.42, -0.02, 0.08),
    joint(-0.18, 1.42, -0.02, 0.08),
    joint(0.0, 1.27, 0.11, 0.12),
    joint(0.0, 1.08, -0.02, 0.12),
    joint(0.11, 0.92, 0.02, 0.09),
    joint(-0.11, 0.92, 0.02, 0.09),
    joint(0.0, 0.96, -0.11, 0.07),
    joint(0.27, 1.15, -0.02, 0.015),
    joint(0.19, 1.15, -0.02, 0.015),
    joint(-0.27, 1.15, -0.02, 0.015),
    joint(-0.19, 1.15, -0.02, 0.015),
    joint(0.23, 0.92, 0.1, 0.02),
    joint(-0.23, 0.92, 0.1, 0.02),
    joint(0.16, 0.5, 0.1, 0.04),
    joint(0.08, 0.5, 0.1, 0.04),
    joint(-0.16, 0.5, 0.1, 0.04),
    joint(-0.08, 0.5, 0.1, 0.04),
    joint(0.12, 0.09, -0.02, 0.035),
    joint(-0.12, 0.09, -0.02, 0.035),
];

/// The greatest distance from end to end of a leg or an arm, as a part of its full length. Less than 1, so that it cannot
/// bend backwards.
const STRAIGHT: f32 = 0.985;

impl RagdollBuilder {
    /// A figure of `height` metres and `mass` kilograms.
    pub fn new(height: f32, mass: f32) -> Self {
        Self { height, mass, placement: Placement::default() }
    }

    /// Sets the place of the ground between the feet, and the rotation of the figure.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// Positions of the particles in the world (metres), and their masses (kilograms).
    ///
    /// # Errors
    /// [`BuildError`] if height, mass or placement are invalid.
    pub fn particles(&self) -> Result<Vec<(Vec3, f32)>, BuildError> {
        positive("height", self.height)?;
        positive("mass", self.mass)?;
        if !self.placement.is_valid() {
            return Err(BuildError::BadShape { reason: "its placement is not finite" });
        }
        let pose = Pose::at(&self.placement, Vec3::ZERO);
        let scale = self.height / TABLE_HEIGHT;
        let sum: f32 = JOINTS.iter().map(|joint| joint.weight).sum();
        let particle =
            |joint: &Joint| (pose.point_to_world(joint.at * scale), self.mass * joint.weight / sum);
        Ok(JOINTS.iter().map(particle).collect())
    }

    /// The sticks: first those that make limbs, then those that limit joints.
    pub fn sticks(&self) -> Vec<RagdollStick> {
        let scale = self.height / TABLE_HEIGHT;
        let apart = |a: u32, b: u32| JOINTS[a as usize].at.distance(JOINTS[b as usize].at);
        let mut sticks = Vec::new();
        let mut rigid = |limb: &[u32]| {
            for (i, &a) in limb.iter().enumerate() {
                for &b in &limb[i + 1..] {
                    let stick =
                        RagdollStick { ends: [a, b], length: apart(a, b) * scale, bound: StickBound::Exact };
                    // Two limbs at a hinge share its axis, and so one stick.
                    if !sticks.contains(&stick) {
                        sticks.push(stick);
                    }
                }
            }
        };
        rigid(&[SHOULDERS[0], SHOULDERS[1], STERNUM, WAIST]);
        rigid(&[HIPS[0], HIPS[1], WAIST, SACRUM]);
        rigid(&[HEAD, SHOULDERS[0], SHOULDERS[1]]);
        for side in [0, 1] {
            rigid(&[SHOULDERS[side], ELBOWS[side][0], ELBOWS[side][1]]);
            rigid(&[ELBOWS[side][0], ELBOWS[side][1], HANDS[side]]);
            rigid(&[HIPS[side], KNEES[side][0], KNEES[side][1]]);
            rigid(&[KNEES[side][0], KNEES[side][1], FEET[side]]);
        }
        let mut limit = |ends: [u32; 2], least: f32, most: f32| {
            for (length, bound) in [(least, StickBound::AtLeast), (most, StickBound::AtMost)] {
                if length > 0.0 && length < f32::MAX {
                    sticks.push(RagdollStick { ends, length: length * scale, bound });
                }
            }
        };
        limit([HEAD, STERNUM], 0.24, 0.42);
        for side in [0, 1] {
            let (shoulder, hip, other) = (SHOULDERS[side], HIPS[side], 1 - side);
            let middle = |axis: [u32; 2]| (JOINTS[axis[0] as usize].at + JOINTS[axis[1] as usize].at) * 0.5;
            let bend = |root: u32, axis: [u32; 2], end: u32| {
                let [root, end] = [root, end].map(|i| JOINTS[i as usize].at);
                (root.distance(middle(axis)) + middle(axis).distance(end)) * STRAIGHT
            };
            limit([shoulder, HANDS[side]], 0.2, bend(shoulder, ELBOWS[side], HANDS[side]));
            limit([hip, FEET[side]], 0.35, bend(hip, KNEES[side], FEET[side]));
            limit([shoulder, hip], 0.36, 0.56);
            limit([shoulder, HIPS[other]], 0.36, 0.6);
            limit([SHOULDERS[other], ELBOWS[side][1]], 0.25, f32::MAX);
            limit([STERNUM, ELBOWS[side][1]], 0.16, f32::MAX);
            limit([HIPS[other], KNEES[side][1]], 0.28, f32::MAX);
            limit([WAIST, KNEES[side][1]], 0.3, f32::MAX);
            limit([SACRUM, KNEES[side][0]], 0.36, f32::MAX);
        }
        limit([KNEES[0][1], KNEES[1][1]], 0.1, f32::MAX);
        limit(FEET, 0.1, f32::MAX);
        sticks
    }

    /// Builds the body, at rest. The thickness in `settings` is the radius of its limbs: 5 cm suit an adult.
    ///
    /// # Errors
    /// [`BuildError`] as [`particles`](Self::particles).
    pub fn build(self, settings: BodySettings) -> Result<Body, BuildError> {
        settings.validate()?;
        let (places, masses): (Vec<Vec3>, Vec<f32>) = self.particles()?.into_iter().unzip();
        let inverse_masses: Vec<f32> = masses.iter().map(|mass| 1.0 / mass).collect();
        let particles = Particles::new(self.placement.translation, &places, &inverse_masses)?;
        let sticks = self.sticks();
        let mut builder = TopologyBuilder::new(&places);
        for bound in [StickBound::Exact, StickBound::AtLeast, StickBound::AtMost] {
            // Limits carry no load, so they come last, with the bend sticks.
            let kind = if bound == StickBound::Exact { StickKind::Structural } else { StickKind::Bend };
            let of_bound = sticks.iter().filter(|stick| stick.bound == bound);
            let material = StickMaterial { bound, ..StickMaterial::rigid(kind) };
            builder.family_with_lengths(material, of_bound.map(|stick| (stick.ends, stick.length)))?;
        }
        let rods = sticks.iter().filter(|stick| stick.bound == StickBound::Exact);
        builder.segments(rods.map(|stick| stick.ends))?;
        Ok(Body::new(particles, Arc::new(builder.build()?), settings))
    }
}
