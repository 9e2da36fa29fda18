//! Spring constants of the sticks of a grid that resists in its plane as a fabric does.
//!
//! ```text
//!   o---x---o    energy of a square of dx x dy with strains e, f and shear g, two diagonals of length l and constant d:
//!   | \   / |      1/2 x (e dx)^2 + 1/2 y (f dy)^2 + d ((dx^2 e + dy^2 f)^2 + (dx dy g)^2) / l^2
//!   y   d   y
//!   | /   \ |    so d gives the shear, and adds to the tension along both directions
//!   o---x---o
//! ```
//!
//! Design: `docs/design/membrane.md`.

use crate::constants::REFERENCE_STEP;
use crate::error::BuildError;
use crate::state::membrane::{ElasticStick, Membrane, MembraneStiffness};
use crate::state::topology::Topology;

/// Least part of the tension that sticks along it take. In long squares, diagonals that resist shear as they should may resist tension
/// more than the whole fabric does.
const LEAST_SHARE: f64 = 0.01;

/// Constants of the sticks of a grid in N/m: along rows, along columns, and diagonals. None where the stiffness is not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SpringConstants {
    pub along: [Option<f64>; 2],
    pub diagonal: Option<f64>,
}

impl SpringConstants {
    /// Those of sticks in a grid of this spacing (metres, along rows and along columns).
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] if a stiffness is.
    pub fn new(stiffness: MembraneStiffness, spacing: [f32; 2]) -> Result<Self, BuildError> {
        stiffness.validate()?;
        let [dx, dy] = spacing.map(f64::from);
        let given = |stiffness: f32| Some(f64::from(stiffness)).filter(|&stiffness| stiffness > 0.0);
        let [weft, warp, shear] = [stiffness.weft, stiffness.warp, stiffness.shear].map(given);
        let diagonal = shear.map(|shear| shear * (dx * dx + dy * dy) / (2.0 * dx * dy));
        // A strip that is pulled becomes narrower, as its diagonals turn: `tension = whole - coupling^2 / whole across`.
        let coupling = shear.unwrap_or(0.0);
        let [whole_weft, whole_warp] = match (weft, warp) {
            (Some(weft), Some(warp)) => {
                let both = weft * warp;
                let product = 0.5 * (both + (both * (both + 4.0 * coupling * coupling)).sqrt());
                [product / warp, product / weft].map(Some)
            }
            // A direction that does not yield keeps its width.
            lone => [lone.0, lone.1],
        };
        let of_sticks = |whole: Option<f64>, along: f64, across: f64| {
            let whole = whole?;
            let of_diagonals = coupling * (along / across) * (along / across);
            Some((whole - of_diagonals).max(whole * LEAST_SHARE) * across / along)
        };
        Ok(Self { along: [of_sticks(whole_weft, dx, dy), of_sticks(whole_warp, dy, dx)], diagonal })
    }
}

impl Membrane {
    /// The membrane of a whole grid of `size` columns and rows whose sticks have these constants; none if none has.
    pub fn new(topology: &Topology, size: [u32; 2], constants: SpringConstants) -> Option<Self> {
        let size = size.map(|side| side as usize);
        let stick = |to: usize, constant: Option<f64>| {
            let rest = topology.rest[0].distance(topology.rest[to]);
            Some(ElasticStick { rest, compliance: constant?.recip() as f32 })
        };
        let SpringConstants { along: [along_rows, along_columns], diagonal } = constants;
        // From the far ends, as single precision rounds places far from the origin by much of a spacing.
        let frame = || {
            let [columns, rows] = size;
            let [first, right, down] =
                [0, columns - 1, columns * (rows - 1)].map(|i| topology.rest[i].as_dvec3());
            [first, (right - first) / (columns - 1) as f64, (down - first) / (rows - 1) as f64]
        };
        (constants != SpringConstants::default()).then(|| Self {
            size: Some(size),
            frame: frame(),
            rows: stick(1, along_rows),
            columns: stick(size[0], along_columns),
            diagonals: stick(size[0] + 1, diagonal),
        })
    }
}

/// The stiffness from 0 to 1 of a stick of this constant (N/m) between particles of `mass` (kg). As sticks are relaxed one by one they
/// reach it only roughly.
pub(crate) fn stiffness_of(constant: f64, mass: f64) -> f32 {
    let inverse = constant * 2.0 / mass * f64::from(REFERENCE_STEP) * f64::from(REFERENCE_STEP);
    (inverse / (1.0 + inverse)) as f32
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::build::topology_builder::TopologyBuilder;
    use crate::{BodySettings, ClothBuilder, ClothMaterial};

    /// The ways to the first neighbours, which are rounded there, led to the wrong columns.
    #[test]
    fn particles_far_from_the_origin_have_their_places() {
        let material = ClothMaterial {
            membrane_stiffness: MembraneStiffness::balanced(100.0, 5.0),
            ..ClothMaterial::default()
        };
        let cloth = ClothBuilder::new(2.0, 0.01, 512, 3).placed(Vec3::splat(1000.0), Vec3::X, Vec3::NEG_Y);
        let body = cloth.material(material).build(BodySettings::default()).expect("valid");
        let membrane = body.topology.membrane.expect("springs");
        for (i, &rest) in body.topology.rest.iter().enumerate() {
            assert_eq!(membrane.place(rest), [i as isize % 512, i as isize / 512]);
        }
    }

    /// Its first particle was asked for.
    #[test]
    fn a_grid_without_particles_is_built() {
        let builder = TopologyBuilder::grid(&[], 0, 2).expect("no particles");
        assert_eq!(builder.build().expect("valid").particle_count(), 0);
    }
}
