//! Rectangular cloths.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, ClothBuilder, Edge};

use crate::body::fabric::Fabric;
use crate::body::particles::BodyParts;
use crate::build::description::Description;

/// A rectangular cloth: curtain, flag, sail, table cloth. Its [`Fabric`] says what it is made of.
///
/// It lies centred in the XY plane of its [`Transform`] and faces +Z. The first step after insertion or a change builds
/// its [`Particles`](crate::body::particles::Particles) and [`Sticks`](crate::body::particles::Sticks). Pinned
/// particles stay fixed to the entity: move the `Transform` to pull the cloth along.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands) {
/// commands.spawn((Cloth::new(2.0, 1.5), Transform::from_xyz(0.0, 2.0, 0.0)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, Fabric)]
pub struct Cloth {
    /// Width and height in metres.
    pub size: Vec2,
    /// Particles in a row and in a column, at least 2 each.
    pub particles: UVec2,
    /// Particles that are fixed to the entity.
    pub pins: ClothPins,
}

/// The greatest number of particles that [`Cloth::new`] gives a side.
const MOST_BY_DEFAULT: u32 = 128;

/// The pinned particles of a cloth. Particle `row * columns + column` counts from the top left.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum ClothPins {
    /// None: the cloth is free.
    None,
    /// The whole top edge: a curtain.
    #[default]
    Top,
    /// The two top corners: a washing line.
    TopCorners,
    /// The whole left edge: a flag.
    Left,
    /// All four corners: a trampoline.
    Corners,
    /// These particles.
    Indices(Vec<u32>),
}

impl Default for Cloth {
    fn default() -> Self {
        Self { size: Vec2::ONE, particles: UVec2::splat(32), pins: ClothPins::Top }
    }
}

impl Cloth {
    /// A curtain of `width` x `height` metres with a particle about every 5 cm, pinned along its top edge.
    ///
    /// A side of more than 6.4 m gets 128 particles and logs a warning: describe large cloths by their fields, with as many
    /// particles as your frame can pay for.
    pub fn new(width: f32, height: f32) -> Self {
        let count = |side: f32| {
            if side * 20.0 > MOST_BY_DEFAULT as f32 {
                warn!(
                    "a cloth of {width} m x {height} m has only {MOST_BY_DEFAULT} particles on a side, not one every 5 cm"
                );
            }
            (side * 20.0).clamp(1.0, (MOST_BY_DEFAULT - 1) as f32) as u32 + 1
        };
        Self {
            size: Vec2::new(width, height),
            particles: UVec2::new(count(width), count(height)),
            ..Self::default()
        }
    }

    /// Sets the number of particles so that they are about `spacing` metres apart, in the [`size`](Self::size) that the cloth
    /// has now.
    pub fn with_spacing(mut self, spacing: f32) -> Self {
        let gaps = |side: f32| (side / spacing).round().max(1.0) as u32;
        self.particles = if spacing > 0.0 {
            UVec2::new(gaps(self.size.x), gaps(self.size.y)).saturating_add(UVec2::ONE)
        } else {
            // Refused when the cloth is built.
            UVec2::MAX
        };
        self
    }

    /// Sets the number of particles in a row and in a column.
    pub fn with_particles(mut self, columns: u32, rows: u32) -> Self {
        self.particles = UVec2::new(columns, rows);
        self
    }

    /// Sets the pinned particles.
    pub fn with_pins(mut self, pins: ClothPins) -> Self {
        self.pins = pins;
        self
    }

    /// Returns the particles in a row and in a column, with about one in `coarseness` along each side.
    pub(crate) fn particles_at(&self, coarseness: u32) -> UVec2 {
        let fewer = |side: u32| match (coarseness, side) {
            (0 | 1, _) | (_, 0..=2) => side,
            _ => ((side - 1 + coarseness / 2) / coarseness).max(1) + 1,
        };
        UVec2::new(fewer(self.particles.x), fewer(self.particles.y))
    }

    /// Returns the same cloth with fewer particles: about one in `coarseness` along each side.
    pub(crate) fn coarsened(&self, coarseness: u32) -> Self {
        if coarseness <= 1 {
            return self.clone();
        }
        let particles = self.particles_at(coarseness);
        let pins = match &self.pins {
            ClothPins::Indices(indices) => {
                let place = |i: u32, from: u32, to: u32| (i * (to - 1) + (from - 1) / 2) / (from - 1).max(1);
                let columns = self.particles.x.max(1);
                let moved = |&index: &u32| {
                    let (column, row) = (index % columns, index / columns);
                    place(row, self.particles.y, particles.y) * particles.x
                        + place(column, columns, particles.x)
                };
                ClothPins::Indices(indices.iter().map(moved).collect())
            }
            pins => pins.clone(),
        };
        Self { particles, pins, ..self.clone() }
    }

    /// Returns the fabric with which this cloth with the particles of `other` weighs, hangs, stretches and swings like this
    /// one of `fabric`: fewer and heavier particles need softer sticks for the same material.
    fn fabric_of_coarsened(&self, fabric: &Fabric, other: &Self) -> Fabric {
        let gaps = |cloth: &Self| (cloth.particles.max(UVec2::splat(2)) - 1).as_vec2();
        // Compliance grows with the square of the spacing, damping shrinks with it.
        let ratio = gaps(self) / gaps(other);
        let square = ratio.x * ratio.y;
        let softer = |stiffness: f32| stiffness / (stiffness + (1.0 - stiffness) * square);
        Fabric {
            stretch_stiffness: softer(fabric.stretch_stiffness),
            shear_stiffness: softer(fabric.shear_stiffness),
            bend_stiffness: softer(fabric.bend_stiffness),
            damping: fabric.damping / square,
            ..*fabric
        }
    }

    /// Builds the particles and topology of this cloth with about one particle in `coarseness` along each side.
    pub(crate) fn build_coarsened(
        &self,
        coarseness: u32,
        fabric: &Fabric,
        transform: &GlobalTransform,
    ) -> Result<BodyParts, BuildError> {
        let coarsened = self.coarsened(coarseness);
        coarsened.build(&self.fabric_of_coarsened(fabric, &coarsened), transform)
    }

    /// Builds the particles and topology of this cloth of `fabric` at `transform`.
    ///
    /// # Errors
    /// [`BuildError`] naming the field that cannot be used.
    pub fn build(&self, fabric: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        let (scale, rotation, _) = transform.to_scale_rotation_translation();
        let size = self.size * scale.truncate();
        let corner = Vec3::new(-self.size.x, self.size.y, 0.0) * 0.5;
        let (columns, rows) = (self.particles.x, self.particles.y);
        let builder = ClothBuilder::new(size.x, size.y, columns, rows)
            .placed(transform.transform_point(corner), rotation * Vec3::X, rotation * Vec3::NEG_Y)
            .material(fabric.material());
        let corner =
            |column: u32, row: u32| (column == 0 || column + 1 == columns, row == 0, row + 1 == rows);
        let builder = match &self.pins {
            ClothPins::None => builder,
            ClothPins::Top => builder.pin_edge(Edge::Top),
            ClothPins::Left => builder.pin_edge(Edge::Left),
            ClothPins::TopCorners => builder.pin_where(|column, row, _| {
                let (side, top, _) = corner(column, row);
                side && top
            }),
            ClothPins::Corners => builder.pin_where(|column, row, _| {
                let (side, top, bottom) = corner(column, row);
                side && (top || bottom)
            }),
            ClothPins::Indices(indices) => indices.iter().fold(builder, |builder, &index| builder.pin(index)),
        };
        let (particles, topology) = builder.build_parts()?;
        Ok((particles, Arc::new(topology)))
    }
}

impl Description for Cloth {
    const NAME: &'static str = "Cloth";

    fn build(&self, fabric: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        self.build(fabric, transform)
    }
}
