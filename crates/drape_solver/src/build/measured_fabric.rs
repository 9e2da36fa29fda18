//! Fabrics whose mass and resistance to bending a textile laboratory has measured.
//!
//! - Matsudaira, Masuda, Wada and Yokura 2015, "Shape Factor of Flared Skirts Compared with That of Circular Fabrics", Journal of
//!   Textile Engineering 61(6), 69-73: mass, rigidity, hysteresis (table 1, KES system) and drape (table 2).
//! - Petrak et al. 2025, Sustainability 17, 1388: mass, stretch, shear, rigidity and drape (tables 1, 2, 4 and 5). Hysteresis was not
//!   published.
//!
//! Both were read in transcriptions. `drape_bench fabrics` measures the drape of each beside the published one.
//!
//! Design: `docs/design/bending.md`.

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;

use crate::build::cloth::ClothMaterial;
use crate::state::bending_friction::BendingFriction;
use crate::state::bends::BendingRigidity;
use crate::state::membrane::MembraneStiffness;

/// A fabric that a laboratory has measured. `docs/presets.md` tells how each drapes, in the laboratory and in this solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
pub enum MeasuredFabric {
    /// Polyester faille, 104 g/m^2: limp (Matsudaira, fabric F).
    #[default]
    PolyesterFaille,
    /// Wool tropical, a plain weave of 163 g/m^2: for summer suits (Matsudaira, fabric B).
    WoolTropical,
    /// Polyester tropical, 117 g/m^2 (Matsudaira, fabric C).
    PolyesterTropical,
    /// Cotton broadcloth, a plain weave of 124 g/m^2: stiff, with much friction (Matsudaira, fabric A).
    CottonBroadcloth,
    /// Polyester twill 3/1, 135 g/m^2 (Petrak, fabric M1).
    PolyesterTwill,
    /// Polyester in plain weave, 84 g/m^2 (Petrak, fabric M2).
    PolyesterPlain,
    /// Twill 2/1 of 63 % polyester, 33 % viscose and 4 % elastane, 286 g/m^2: heavy and limp (Petrak, fabric M4).
    ViscoseTwill,
}

/// The figures that a laboratory has measured of a fabric.
struct Measured {
    name: &'static str,
    source: &'static str,
    /// In g/m^2.
    mass: f32,
    /// Along warp and weft, in 1e-6 N m.
    rigidity: [f32; 2],
    /// In 1e-6 N.
    friction: f32,
    /// Along warp and weft, and in shear, in N/m.
    membrane: [f32; 3],
    drape: f32,
}

/// A row of Matsudaira's tables, in units of the KES system: g/m^2, gf cm^2/cm and gf cm/cm.
const fn kes(
    name: &'static str,
    source: &'static str,
    mass: f32,
    b: f32,
    hysteresis: f32,
    drape: f32,
) -> Measured {
    let rigidity = b * 98.0665;
    let friction = 0.5 * hysteresis * 9806.65;
    Measured { name, source, mass, rigidity: [rigidity, rigidity], friction, membrane: [0.0; 3], drape }
}

macro_rules! matsudaira {
    ($fabric:literal) => {
        concat!("Matsudaira et al. 2015, J. Textile Eng. 61(6), tables 1 and 2, fabric ", $fabric)
    };
}

macro_rules! petrak {
    ($fabric:literal) => {
        concat!("Petrak et al. 2025, Sustainability 17, 1388, fabric ", $fabric)
    };
}

impl MeasuredFabric {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::PolyesterFaille,
        Self::WoolTropical,
        Self::PolyesterTropical,
        Self::CottonBroadcloth,
        Self::PolyesterTwill,
        Self::PolyesterPlain,
        Self::ViscoseTwill,
    ];

    const fn measured(self) -> Measured {
        match self {
            Self::PolyesterFaille => kes("polyester faille", matsudaira!("F"), 104.3, 0.019, 0.007, 0.283),
            Self::WoolTropical => kes("wool tropical", matsudaira!("B"), 162.9, 0.067, 0.033, 0.498),
            Self::PolyesterTropical => {
                kes("polyester tropical", matsudaira!("C"), 116.5, 0.077, 0.029, 0.507)
            }
            Self::CottonBroadcloth => kes("cotton broadcloth", matsudaira!("A"), 123.8, 0.118, 0.124, 0.829),
            Self::PolyesterTwill => Measured {
                name: "polyester twill",
                source: petrak!("M1"),
                mass: 135.17,
                rigidity: [1.95, 0.61],
                friction: 0.0,
                membrane: [477.226, 458.614, 41.0],
                drape: 0.223,
            },
            Self::PolyesterPlain => Measured {
                name: "polyester plain weave",
                source: petrak!("M2"),
                mass: 83.66,
                rigidity: [0.85, 0.33],
                friction: 0.0,
                membrane: [471.944, 373.515, 46.0],
                drape: 0.228,
            },
            Self::ViscoseTwill => Measured {
                name: "viscose twill",
                source: petrak!("M4"),
                mass: 286.13,
                rigidity: [2.97, 2.4],
                friction: 0.0,
                membrane: [403.447, 401.762, 61.0],
                drape: 0.286,
            },
        }
    }

    /// Its name, in lower case.
    pub const fn name(self) -> &'static str {
        self.measured().name
    }

    /// The publication, with the name that the fabric has there.
    pub const fn source(self) -> &'static str {
        self.measured().source
    }

    /// The drape coefficient that was published, 0 to 1.
    pub const fn published_drape(self) -> f32 {
        self.measured().drape
    }

    /// Areal density, stretch, shear, rigidity and friction in bending. There are no bend sticks. Where stretch and shear were not measured,
    /// threads are rigid and shear sticks soft (0.3).
    pub const fn material(self) -> ClothMaterial {
        let Measured { mass, rigidity, friction, membrane, .. } = self.measured();
        let [warp, weft, shear] = membrane;
        ClothMaterial {
            areal_density: 1e-3 * mass,
            stretch_stiffness: 1.0,
            shear_stiffness: 0.3,
            bend_stiffness: 0.0,
            bending_rigidity: BendingRigidity { warp: 1e-6 * rigidity[0], weft: 1e-6 * rigidity[1] },
            bending_friction: BendingFriction::isotropic(1e-6 * friction),
            membrane_stiffness: MembraneStiffness { warp, weft, shear },
            damping: 0.0,
        }
    }
}
