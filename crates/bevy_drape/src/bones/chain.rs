//! Chains of joints, and the bodies that they make.

use core::f32::consts::PI;
use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, StickBound, StickKind, StickMaterial, Tethers, TopologyBuilder};

use crate::body::particles::BodyParts;
use crate::bones::bone_cloth::{BoneCloth, BoneWeave};

/// Stiffness of the sticks across the squares of a sheet, as in cloth by default.
const SHEAR_STIFFNESS: f32 = 0.7;

/// A chain of joints. Each has a particle at its place, and there is one more at the tip.
#[derive(Clone, Debug)]
pub(crate) struct BoneChain {
    /// From the root on.
    pub joints: Vec<Entity>,
    /// The end of the last bone in the coordinates of the last joint.
    pub tip: Vec3,
    /// The particle of the root; the others follow it.
    pub first: usize,
}

/// The chains of a cloth of bones, in a pose.
#[derive(Clone, Debug, Default)]
pub(crate) struct PosedChains {
    pub chains: Vec<BoneChain>,
    /// The places of all particles in the world, in metres.
    pub positions: Vec<Vec3>,
}

impl PosedChains {
    /// Adds the chain of these joints, which stand at `places`.
    ///
    /// # Errors
    /// A sentence about the root if the length of the last bone is not known.
    pub fn push(
        &mut self,
        joints: Vec<Entity>,
        places: &[GlobalTransform],
        tip: Option<f32>,
    ) -> Result<(), String> {
        let first = self.positions.len();
        self.positions.extend(places.iter().map(GlobalTransform::translation));
        let ([.., last], Some(&end)) = (places, self.positions.last()) else { return Ok(()) };
        let before = places.len().checked_sub(2).map(|before| places[before].translation());
        // A joint by itself points along its Y axis, as bones do in Blender and in its glTF files.
        let bone = before.map_or_else(|| last.up().as_vec3(), |before| end - before);
        let length = tip.or(before.map(|before| end.distance(before)));
        let length = length.ok_or_else(|| {
            format!("the joint {} in `roots` has no child: its length must be said in `tip`", joints[0])
        })?;
        let tip = end + bone.normalize_or_zero() * length;
        self.positions.push(tip);
        let tip = last.affine().inverse().transform_point3(tip);
        self.chains.push(BoneChain { joints, tip, first });
        Ok(())
    }

    /// Builds particles, sticks, faces and tethers.
    ///
    /// # Errors
    /// [`BuildError`] naming the field of `cloth` that cannot be used, or two joints in one place.
    pub fn build(&self, cloth: &BoneCloth) -> Result<BodyParts, BuildError> {
        cloth.validate()?;
        let count = self.positions.len();
        let bones: Vec<[u32; 2]> = self.chains.iter().flat_map(|chain| pairs(chain, 1)).collect();
        let mut masses = vec![0.0_f32; count];
        for &bone in &bones {
            let half = 0.5 * cloth.linear_density * self.distance(bone);
            bone.iter().for_each(|&end| masses[end as usize] += half);
        }
        let mut inverse_masses: Vec<f32> = masses.iter().map(|mass| 1.0 / mass).collect();
        let roots: Vec<u32> = self.chains.iter().map(|chain| chain.first as u32).collect();
        roots.iter().for_each(|&root| inverse_masses[root as usize] = 0.0);

        let squares = self.squares(cloth.weave);
        let rigid = StickMaterial::rigid;
        let mut builder = TopologyBuilder::new(&self.positions);
        builder.family(rigid(StickKind::Structural), bones.iter().copied())?;
        // The upper side of a square joins roots, which are held anyway, or is the lower side of the one above.
        builder.family(rigid(StickKind::Structural), squares.iter().map(|&[.., c, d]| [c, d]))?;
        let shear = StickMaterial { stiffness: SHEAR_STIFFNESS, ..rigid(StickKind::Shear) };
        builder.family(shear, squares.iter().flat_map(|&[a, b, c, d]| [[a, d], [b, c]]))?;
        if cloth.max_bend < PI {
            let least = StickMaterial { bound: StickBound::AtLeast, ..rigid(StickKind::Bend) };
            builder.family_with_lengths(least, self.bend_limits(cloth.max_bend))?;
        }
        builder.faces(squares.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [b, c, d]]))?;
        // Of strands, and of chains that are longer than those beside them.
        let is_side =
            |bone: &[u32; 2]| squares.iter().any(|&[a, b, c, d]| *bone == [a, c] || *bone == [b, d]);
        builder.segments(bones.iter().copied().filter(|bone| !is_side(bone)))?;
        let ways = bones.iter().map(|&bone| (bone[0], bone[1], self.distance(bone)));
        builder.tethers(Tethers::geodesic(count, ways, &roots))?;
        let origin = self.positions.first().copied().unwrap_or_default().round();
        let mut particles = drape_solver::Particles::new(origin, &self.positions, &inverse_masses)?;
        self.follow_pose(cloth, &mut particles)?;
        Ok((particles, Arc::new(builder.build()?)))
    }

    /// Gives free particles their drives and limits, at their places.
    fn follow_pose(
        &self,
        cloth: &BoneCloth,
        particles: &mut drape_solver::Particles,
    ) -> Result<(), BuildError> {
        for chain in &self.chains {
            let root = self.positions[chain.first];
            for i in chain.first + 1..=chain.first + chain.joints.len() {
                let place = self.positions[i];
                particles.set_pose_drive(i, place, cloth.drive())?;
                if cloth.max_swing < PI {
                    let chord = 2.0 * place.distance(root) * libm::sinf(0.5 * cloth.max_swing);
                    particles.set_motion_limit(i, place, chord);
                }
            }
        }
        Ok(())
    }

    /// The least distances between every second particle of a chain: those of two bones that are bent by `angle`.
    fn bend_limits(&self, angle: f32) -> impl Iterator<Item = ([u32; 2], f32)> {
        let limit = move |[from, to]: [u32; 2]| {
            let [a, b] = [[from, from + 1], [from + 1, to]].map(|bone| self.distance(bone));
            let length = (a * a + b * b + 2.0 * a * b * libm::cosf(angle)).max(0.0).sqrt();
            ([from, to], length.min(self.distance([from, to])))
        };
        self.chains.iter().flat_map(|chain| pairs(chain, 2)).map(limit).filter(|&(_, length)| length > 0.0)
    }

    /// The corners of the squares between neighbouring chains: two above, two below.
    fn squares(&self, weave: BoneWeave) -> Vec<[u32; 4]> {
        let count = self.chains.len();
        let neighbours = match weave {
            BoneWeave::Strands => 0,
            BoneWeave::Tube if count > 2 => count,
            BoneWeave::Sheet | BoneWeave::Tube => count.saturating_sub(1),
        };
        let between = |place: usize| {
            let sides = [&self.chains[place], &self.chains[(place + 1) % count]];
            let [left, right] = sides.map(|chain| pairs(chain, 1));
            left.zip(right).map(|([a, c], [b, d])| [a, b, c, d])
        };
        (0..neighbours).flat_map(between).collect()
    }

    fn distance(&self, [a, b]: [u32; 2]) -> f32 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }
}

/// The pairs of particles of a chain that are `apart` bones from each other.
fn pairs(chain: &BoneChain, apart: usize) -> impl Iterator<Item = [u32; 2]> + use<> {
    let (first, last) = (chain.first, chain.first + chain.joints.len());
    (first..=last)
        .take_while(move |from| from + apart <= last)
        .map(move |from| [from as u32, (from + apart) as u32])
}
