//! Settings of a body: accuracy, damping and surface.
//!
//! Design: `docs/design/relaxation.md`.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use crate::constants::{MAX_ITERATIONS, MAX_SUBSTEPS};
use crate::error::{BuildError, in_range};
use crate::state::friction::Friction;

/// The formula that moves the ends of a stick to its rest length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StickProjection {
    /// The exact projection: one square root a stick (Liu 2019, section 3).
    #[default]
    Exact,
    /// One Newton step about the rest length and no square root (Jakobsen 2001; Liu 2019 item 4): with
    /// `s = (d^2 - r^2) / (d^2 + r^2)` the ends move by `s` times their separation. From a length of `e` rest
    /// lengths it lands at `1 - (e - 1)^2 / (1 + e^2)`: right to second order in the strain.
    SquareRootFree,
}

/// The solver of structural sticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StructuralSolve {
    /// Sweeps: one stick after another, like all other sticks. A pull travels only a few sticks in a substep. A rope
    /// without self-contact that is [joined](crate::Particles::join) to an obstacle is solved as a line all the same.
    Sweeps,
    /// Lines: each row and each column of a cloth, and a rope, is solved directly as a chain, which carries a pull from
    /// one end to the other at once (Goldenthal et al. 2007). A falling sheet of 128 x 128 with stiff shear and bend
    /// sticks stretches by 0.16 % (root mean square) at the default settings, against 1.9 % with sweeps, in much the same
    /// time.
    ///
    /// Takes effect if structural sticks are rigid (stiffness 1) and the grid fills a vector's lanes: from 9 x 9
    /// particles, or 33 in a rope without self-contact. Other sticks are still swept. Sticks and lines are relaxed once a
    /// substep, in the last iteration; those before only project contacts, unless joints hold the body. With more than one
    /// iteration, cloth is swept while an obstacle with a [`RigidBody`](crate::RigidBody) is near, and stretches
    /// accordingly. Torn cloth keeps its lines, with gaps. A line of cloth that is stretched by more than 5 % on average
    /// gives way, and so does a rope with a stick that is stretched by more than 10 %.
    #[default]
    Lines,
}

/// Contact of a body with itself, and with others that have it on: surfaces keep apart by the sum of the two
/// thicknesses, with friction. Parts that are as near to each other at rest do not touch. Without thickness there is no
/// contact.
///
/// Contacts between cloths are solved once a substep. If a rope takes part, all contacts are solved in each iteration:
/// four iterations in 12 or more substeps hold a knot under twice the rope's weight. Such a rope is always
/// [swept](StructuralSolve::Sweeps), as lines pull harder than contacts push.
///
/// Such a body is neither swept in strips nor shared between threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SelfContact {
    /// No self-contact.
    #[default]
    Off,
    /// Contact between corners, faces, edges and links. Nothing passes through a face, at any speed (the planar truncation
    /// of Chen et al. 2025, "Offset geometric contact"), and layers that cross are led apart.
    On,
}

/// Levels of accuracy: each chooses substeps, iterations, sticks and lines.
///
/// The figures are those of a falling sheet of 128 x 128 particles with all sticks rigid, held by two corners, against
/// [`Medium`](Self::Medium): `docs/performance.md` has the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
pub enum Quality {
    /// For distant or small bodies: three tenths of the time, seventy times the stretch (12 %).
    Low,
    /// The values of [`BodySettings::default`].
    #[default]
    Medium,
    /// For bodies that must not stretch: a third longer, and a third of the stretch.
    High,
}

/// Settings of a body: accuracy, damping and surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodySettings {
    /// Substeps per step, 1 to 256. Small steps buy more stiffness than iterations for the same work.
    pub substeps: u32,
    /// Relaxation iterations per substep, 1 to 1024: Jakobsen's N. Odd ones run through the sticks in
    /// reverse, so that an even number makes symmetric pairs. With [lines](StructuralSolve::Lines) only the last one relaxes
    /// sticks.
    pub iterations: u32,
    /// Strain `|length / rest length - 1|` below which relaxation stops early: once no structural stick of the island
    /// exceeds it. From 0, which never stops early, to 1. It pays from some 8 iterations on: the strain is measured
    /// after the first, second, fourth, eighth ... iteration, each time at the cost of about one. A body with lines, with a
    /// bending rigidity or with a membrane takes all iterations.
    pub tolerance: f32,
    /// Drag of still air, in 1/s (0 or more): velocity decays as `exp(-drag t)`, whatever the step. The
    /// textbook factor of 0.99 per step at 60 Hz is 0.6/s.
    pub drag: f32,
    /// Coulomb friction coefficient of the surface, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, 0 or more, for surfaces that do not slide yet. A value below `friction` counts
    /// as `friction`. Two surfaces in contact use the mean of theirs.
    pub static_friction: f32,
    /// Distance in metres that the middle of the cloth keeps from the surfaces that it touches: half its thickness.
    pub thickness: f32,
    /// The formula for sticks.
    pub projection: StickProjection,
    /// The solver of structural sticks.
    pub structural: StructuralSolve,
    /// True if tethers hold particles within their rest distance from the pins.
    pub tethers: bool,
    /// Contact of the body with itself, and with others of its island that have it on.
    pub self_contact: SelfContact,
}

impl Default for BodySettings {
    fn default() -> Self {
        Self {
            substeps: 8,
            iterations: 2,
            tolerance: 0.0,
            drag: 0.6,
            friction: 0.5,
            static_friction: 0.0,
            thickness: 0.005,
            projection: StickProjection::Exact,
            structural: StructuralSolve::Lines,
            tethers: true,
            self_contact: SelfContact::Off,
        }
    }
}

impl From<Quality> for BodySettings {
    fn from(quality: Quality) -> Self {
        Self::default().with_quality(quality)
    }
}

impl BodySettings {
    /// Returns these settings at the accuracy of `quality`; drag, friction and thickness stay.
    pub fn with_quality(self, quality: Quality) -> Self {
        let (substeps, iterations, projection, structural) = match quality {
            Quality::Low => (4, 1, StickProjection::SquareRootFree, StructuralSolve::Sweeps),
            Quality::Medium => (8, 2, StickProjection::Exact, StructuralSolve::Lines),
            Quality::High => (16, 1, StickProjection::SquareRootFree, StructuralSolve::Lines),
        };
        Self { substeps, iterations, tolerance: 0.0, projection, structural, tethers: true, ..self }
    }

    /// True if the two are the same to the bit: unlike `==`, also where they are not a number.
    pub fn has_same_bits(&self, other: &Self) -> bool {
        let bits =
            |s: &Self| [s.tolerance, s.drag, s.friction, s.static_friction, s.thickness].map(f32::to_bits);
        let choices =
            |s: &Self| (s.substeps, s.iterations, s.projection, s.structural, s.tethers, s.self_contact);
        choices(self) == choices(other) && bits(self) == bits(other)
    }

    /// Friction of the surface.
    pub(crate) fn surface_friction(&self) -> Friction {
        Friction::new(self.friction, self.static_friction)
    }

    /// True if the body collides with itself, and with others that have self-contact.
    pub fn has_self_contact(&self) -> bool {
        self.self_contact != SelfContact::Off && self.thickness > 0.0
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// [`BuildError`] naming the first field that is out of range.
    pub fn validate(&self) -> Result<(), BuildError> {
        in_range("substeps", self.substeps as f32, 1.0, MAX_SUBSTEPS as f32)?;
        in_range("iterations", self.iterations as f32, 1.0, MAX_ITERATIONS as f32)?;
        in_range("tolerance", self.tolerance, 0.0, 1.0)?;
        in_range("drag", self.drag, 0.0, 1e4)?;
        in_range("friction", self.friction, 0.0, 1e3)?;
        in_range("static_friction", self.static_friction, 0.0, 1e3)?;
        in_range("thickness", self.thickness, 0.0, 10.0)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medium_is_the_default_and_quality_leaves_the_surface_alone() {
        assert_eq!(BodySettings::from(Quality::Medium), BodySettings::default());
        let rough = BodySettings { friction: 0.9, drag: 3.0, thickness: 0.02, ..BodySettings::default() };
        for quality in [Quality::Low, Quality::Medium, Quality::High] {
            let chosen = rough.with_quality(quality);
            assert_eq!(chosen.validate(), Ok(()));
            assert_eq!((chosen.friction, chosen.drag, chosen.thickness), (0.9, 3.0, 0.02));
        }
    }

    #[test]
    fn defaults_are_valid_and_bad_fields_are_named() {
        let good = BodySettings::default();
        assert_eq!(good.validate(), Ok(()));
        let bad = [
            (BodySettings { substeps: 0, ..good }, "substeps"),
            (BodySettings { iterations: 0, ..good }, "iterations"),
            (BodySettings { tolerance: -1e-3, ..good }, "tolerance"),
            (BodySettings { drag: f32::NAN, ..good }, "drag"),
            (BodySettings { drag: -1.0, ..good }, "drag"),
            (BodySettings { friction: f32::INFINITY, ..good }, "friction"),
            (BodySettings { static_friction: -0.1, ..good }, "static_friction"),
            (BodySettings { thickness: -0.1, ..good }, "thickness"),
        ];
        for (settings, field) in bad {
            let message = settings.validate().expect_err("invalid").to_string();
            assert!(message.contains(field), "{message}");
        }
    }
}
