//! The builder of soft balls in the plane: concentric rings (S26).
//!
//! ```text
//!        . - o - .          ring k of n: radius R (k + 1) / n, 10 (k + 1) particles
//!      o  o-o-o   o         structural sticks along the rings and from ring to ring,
//!     o  o     o   o        shear sticks beside those from ring to ring,
//!      o  o-o-o   o         bend sticks that skip one along a ring, and across the inmost
//!        ' - o - '
//! ```
//!
//! Design: `docs/design/soft_bodies.md`.

use core::f32::consts::TAU;
use std::sync::Arc;

use glam::Vec3;

use crate::build::topology_builder::TopologyBuilder;
use crate::error::{BuildError, finite_vector, in_range, positive, right_angled};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::settings::BodySettings;
use crate::state::topology::{StickKind, StickMaterial, Topology};

/// The number of particles of the inmost ring. Each further ring has this many more than the one inside it.
const INMOST: u32 = 10;

/// A soft ball in a plane, as rings of particles around its centre.
#[derive(Clone, Debug)]
pub struct SoftBallBuilder {
    centre: Vec3,
    axes: [Vec3; 2],
    radius: f32,
    rings: u32,
    areal_density: f32,
    stiffness: f32,
    damping: f32,
    is_rim_pinned: bool,
}

impl SoftBallBuilder {
    /// A ball of `radius` (metres) around `centre`, of `rings` rings in the XY plane: 10 kg/m^2, quite stiff, free.
    pub fn new(centre: Vec3, radius: f32, rings: u32) -> Self {
        let (areal_density, stiffness, damping) = (10.0, 0.999, 1.0);
        let axes = [Vec3::X, Vec3::Y];
        Self { centre, axes, radius, rings, areal_density, stiffness, damping, is_rim_pinned: false }
    }

    /// Puts the ball into the plane of two directions of unit length at right angles. The first particle of each ring lies
    /// along `right`.
    pub fn axes(mut self, right: Vec3, up: Vec3) -> Self {
        self.axes = [right, up];
        self
    }

    /// Mass per area in kg/m^2, above zero.
    pub fn areal_density(mut self, areal_density: f32) -> Self {
        self.areal_density = areal_density;
        self
    }

    /// Stiffness (0..=1) of all sticks.
    pub fn stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Damping along all sticks in 1/s.
    pub fn damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    /// Pins the outermost ring.
    pub fn pin_rim(mut self) -> Self {
        self.is_rim_pinned = true;
        self
    }

    /// The number of particles of ring `ring`, and the index of its first.
    fn ring(ring: u32) -> (u32, u32) {
        (INMOST * (ring + 1), INMOST * ring * (ring + 1) / 2)
    }

    /// Index of particle `i` of ring `ring`; `i` wraps around.
    fn at(ring: u32, i: u32) -> u32 {
        let (count, first) = Self::ring(ring);
        first + i % count
    }

    /// Builds the particles and the topology.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build_parts(self) -> Result<(Particles, Topology), BuildError> {
        positive("radius", self.radius)?;
        let [right, up] = self.axes;
        finite_vector("right", right)?;
        finite_vector("up", up)?;
        right_angled(right, up)?;
        positive("areal_density", self.areal_density)?;
        in_range("rings", self.rings as f32, 1.0, 256.0)?;
        let (last_count, last_first) = Self::ring(self.rings - 1);
        let mut positions = Vec::with_capacity((last_first + last_count) as usize);
        let mut inverse_masses = Vec::with_capacity(positions.capacity());
        let width = self.radius / self.rings as f32;
        for ring in 0..self.rings {
            let (count, radius) = (Self::ring(ring).0, width * (ring + 1) as f32);
            // The area nearest to the ring: from half a width inside it (or the centre) to half a width outside it (or the
            // rim).
            let inner = if ring == 0 { 0.0 } else { radius - 0.5 * width };
            let outer = if ring + 1 == self.rings { radius } else { radius + 0.5 * width };
            let area = 0.5 * TAU * (outer * outer - inner * inner);
            let is_pinned = self.is_rim_pinned && ring + 1 == self.rings;
            let inverse_mass = if is_pinned { 0.0 } else { count as f32 / (area * self.areal_density) };
            for i in 0..count {
                let angle = TAU * i as f32 / count as f32;
                let [right, up] = self.axes;
                positions.push(self.centre + (right * libm::cosf(angle) + up * libm::sinf(angle)) * radius);
                inverse_masses.push(inverse_mass);
            }
        }
        let particles = Particles::new(self.centre, &positions, &inverse_masses)?;
        Ok((particles, self.topology(&positions)?))
    }

    /// Builds a body with these settings.
    ///
    /// # Errors
    /// [`BuildError`] that names the invalid value.
    pub fn build(self, settings: BodySettings) -> Result<Body, BuildError> {
        settings.validate()?;
        let (particles, topology) = self.build_parts()?;
        Ok(Body::new(particles, Arc::new(topology), settings))
    }

    fn topology(&self, positions: &[Vec3]) -> Result<Topology, BuildError> {
        let (mut structural, mut shear, mut bend, mut faces) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for ring in 0..self.rings {
            let (count, _) = Self::ring(ring);
            structural.extend((0..count).map(|i| [Self::at(ring, i), Self::at(ring, i + 1)]));
            bend.extend((0..count).map(|i| [Self::at(ring, i), Self::at(ring, i + 2)]));
        }
        for ring in 1..self.rings {
            self.join_rings(ring, &mut structural, &mut shear, &mut faces);
        }
        // The inmost ring has no particles inside it: sticks to the particle across and to its neighbour hold each.
        let half = INMOST / 2;
        bend.extend((0..half).map(|i| [Self::at(0, i), Self::at(0, i + half)]));
        bend.extend((0..INMOST).map(|i| [Self::at(0, i), Self::at(0, i + half - 1)]));
        faces.extend((1..INMOST - 1).map(|i| [Self::at(0, 0), Self::at(0, i), Self::at(0, i + 1)]));
        let material = |kind| StickMaterial {
            stiffness: self.stiffness,
            damping: self.damping,
            ..StickMaterial::rigid(kind)
        };
        let mut builder = TopologyBuilder::new(positions);
        builder
            .family(material(StickKind::Structural), structural)?
            .family(material(StickKind::Shear), shear)?
            .family(material(StickKind::Bend), bend)?
            .faces(faces)?;
        builder.build()
    }

    /// Joins `ring` to the one inside it, which has ten particles fewer. Walks around both rings together, and always
    /// advances on the ring whose next particle comes first.
    fn join_rings(
        &self,
        ring: u32,
        structural: &mut Vec<[u32; 2]>,
        shear: &mut Vec<[u32; 2]>,
        faces: &mut Vec<[u32; 3]>,
    ) {
        let ((outer, _), (inner, _)) = (Self::ring(ring), Self::ring(ring - 1));
        let (mut i, mut j) = (0, 0);
        structural.push([Self::at(ring - 1, 0), Self::at(ring, 0)]);
        while i < outer || j < inner {
            let [a, b] = [Self::at(ring, i), Self::at(ring - 1, j)];
            // Compares the angles of the next particles, `(i + 1) / outer` and `(j + 1) / inner` of a turn, in whole numbers.
            let is_outer_next = (i + 1) * inner <= (j + 1) * outer;
            if i < outer && (is_outer_next || j == inner) {
                faces.push([b, a, Self::at(ring, i + 1)]);
                i += 1;
                if (i, j) != (outer, inner) {
                    structural.push([b, Self::at(ring, i)]);
                }
            } else {
                faces.push([b, a, Self::at(ring - 1, j + 1)]);
                j += 1;
                if (i, j) != (outer, inner) {
                    shear.push([Self::at(ring - 1, j), a]);
                }
            }
        }
    }
}
