//! Rigs on their way into bodies.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::{BuildError, StickBound, StickKind, StickMaterial, Tethers, Topology, TopologyBuilder};

use crate::body::particles::BodyParts;
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::rig::components::{InRig, Rig};

/// A particle that can be simulated.
pub(crate) struct RigMember {
    pub entity: Entity,
    /// Order of insertion.
    pub order: u64,
    pub position: Vec3,
    pub velocity: Vec3,
    pub inverse_mass: f32,
    /// The body that simulated it until now.
    pub body: Option<Entity>,
    /// The [`InRig`] of its entity.
    pub in_rig: Option<InRig>,
    pub settings: Option<SolverSettings>,
    pub surface: Option<BodySurface>,
    pub is_changed: bool,
}

/// A stick between two members.
pub(crate) struct Link {
    pub entity: Entity,
    /// Indices of the members.
    pub ends: [usize; 2],
    pub rest_length: f32,
    pub material: StickMaterial,
    pub is_changed: bool,
}

/// Members that links join, and these links, both in the order of insertion.
#[derive(Default)]
pub(crate) struct Group {
    pub members: Vec<usize>,
    pub links: Vec<usize>,
}

/// Returns the groups of connected members, in the order of their oldest member.
pub(crate) fn connected(members: &[RigMember], links: &[Link]) -> Vec<Group> {
    let mut parents: Vec<usize> = (0..members.len()).collect();
    for link in links {
        let [p, q] = link.ends.map(|end| root(&mut parents, end));
        parents[p.max(q)] = p.min(q);
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut group_of = vec![0; members.len()];
    for i in 0..members.len() {
        // The root of a group is its oldest member, so it comes first.
        let root = root(&mut parents, i);
        if root == i {
            group_of[i] = groups.len();
            groups.push(Group::default());
        }
        group_of[i] = group_of[root];
        groups[group_of[i]].members.push(i);
    }
    for (i, link) in links.iter().enumerate() {
        groups[group_of[link.ends[0]]].links.push(i);
    }
    groups
}

/// Returns the oldest member that is connected with `i`.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

/// A group on its way into a body.
pub(crate) struct CompiledRig {
    pub rig: Rig,
    pub settings: Option<SolverSettings>,
    pub surface: Option<BodySurface>,
    pub inverse_masses: Vec<f32>,
    /// True if a particle, a stick or their settings were changed.
    pub is_changed: bool,
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// The body that each particle comes from.
    bodies: Vec<Option<Entity>>,
    sticks: Vec<([u32; 2], f32, StickMaterial)>,
}

impl CompiledRig {
    pub fn new(group: &Group, members: &[RigMember], links: &[Link]) -> Self {
        let mut index_in_body: BTreeMap<usize, u32> = BTreeMap::new();
        for (index, &i) in group.members.iter().enumerate() {
            index_in_body.insert(i, index as u32);
        }
        let sticks = group.links.iter().map(|&i| {
            let Link { ends, rest_length, material, .. } = links[i];
            (ends.map(|end| index_in_body[&end]), rest_length, material)
        });
        let in_group = || group.members.iter().map(|&i| &members[i]);
        let settings = in_group().find_map(|member| Some((member.entity, member.settings?)));
        let surface = in_group().find_map(|member| Some((member.entity, member.surface?)));
        Self {
            rig: Rig {
                particles: in_group().map(|member| member.entity).collect(),
                sticks: group.links.iter().map(|&i| links[i].entity).collect(),
                settings_from: settings.map(|(from, _)| from),
                surface_from: surface.map(|(from, _)| from),
            },
            settings: settings.map(|(_, settings)| settings),
            surface: surface.map(|(_, surface)| surface),
            inverse_masses: in_group().map(|member| member.inverse_mass).collect(),
            is_changed: in_group().any(|member| member.is_changed)
                || group.links.iter().any(|&i| links[i].is_changed),
            positions: in_group().map(|member| member.position).collect(),
            velocities: in_group().map(|member| member.velocity).collect(),
            bodies: in_group().map(|member| member.body).collect(),
            sticks: sticks.collect(),
        }
    }

    /// True if all its particles come from `body`.
    pub fn is_all_from(&self, body: Entity) -> bool {
        self.bodies.iter().all(|from| *from == Some(body))
    }

    /// True if `body` with `rig` has the same particles and sticks.
    pub fn is_of(&self, body: Entity, rig: &Rig) -> bool {
        self.is_all_from(body)
            && self.rig.particles == rig.particles
            && self.rig.sticks == rig.sticks
            && self.rig.settings_from == rig.settings_from
            && self.rig.surface_from == rig.surface_from
    }

    /// Builds the body's columns and topology.
    pub fn build(&self) -> Result<BodyParts, BuildError> {
        let (low, high) = self
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let origin = ((low + high) * 0.5).round();
        let mut particles = drape_solver::Particles::new(origin, &self.positions, &self.inverse_masses)?;
        for (i, &velocity) in self.velocities.iter().enumerate() {
            if !particles.is_pinned(i) {
                particles.set_velocity(i, velocity);
            }
        }
        Ok((particles, Arc::new(self.topology()?)))
    }

    fn topology(&self) -> Result<Topology, BuildError> {
        let mut families: Vec<(StickMaterial, Vec<([u32; 2], f32)>)> = Vec::new();
        let mut family_of: BTreeMap<(u32, u32, u32, u32), usize> = BTreeMap::new();
        for &(ends, length, material) in &self.sticks {
            let StickMaterial { kind, stiffness, damping, bound } = material;
            let key = (stage(kind), side(bound), stiffness.to_bits(), damping.to_bits());
            let family = *family_of.entry(key).or_insert_with(|| {
                families.push((material, Vec::new()));
                families.len() - 1
            });
            families[family].1.push((ends, length));
        }
        families.sort_by_key(|(material, _)| (stage(material.kind), side(material.bound)));

        let mut builder = TopologyBuilder::new(&self.positions);
        for (material, sticks) in families {
            builder.family_with_lengths(material, sticks)?;
        }
        // Braces and limits are not part of the surface: they span particles that other sticks join.
        let is_surface = |material: &StickMaterial| {
            material.kind != StickKind::Bend && material.bound == StickBound::Exact
        };
        let surface = self.sticks.iter().filter(|(.., material)| is_surface(material));
        let mut segments: Vec<[u32; 2]> = surface.map(|&(ends, ..)| ends).collect();
        let mut is_bare = vec![true; self.positions.len()];
        segments.iter().flatten().for_each(|&end| is_bare[end as usize] = false);
        let bare = (0..).zip(is_bare).filter(|&(_, is_bare)| is_bare);
        segments.extend(bare.map(|(i, _)| [i, i]));
        // Elastic sticks may stretch, so tethers cannot run along them.
        let rigid = self
            .sticks
            .iter()
            .filter(|(.., material)| material.kind == StickKind::Structural && material.stiffness == 1.0)
            .filter(|(.., material)| material.bound != StickBound::AtLeast);
        let pins: Vec<u32> =
            (0..).zip(&self.inverse_masses).filter(|&(_, &w)| w == 0.0).map(|(i, _)| i).collect();
        let ways = rigid.map(|&([a, b], length, _)| (a, b, length));
        let tethers = Tethers::geodesic(self.positions.len(), ways, &pins);
        builder.segments(segments)?.tethers(tethers)?;
        builder.build()
    }
}

/// Rank of a kind of stick in relaxation: load-bearing sticks come first.
fn stage(kind: StickKind) -> u32 {
    match kind {
        StickKind::Structural => 0,
        StickKind::Shear => 1,
        StickKind::Bend => 2,
    }
}

/// Rank of a bound among sticks of one kind: limits come after the sticks that they limit.
fn side(bound: StickBound) -> u32 {
    match bound {
        StickBound::Exact => 0,
        StickBound::AtLeast => 1,
        StickBound::AtMost => 2,
    }
}
