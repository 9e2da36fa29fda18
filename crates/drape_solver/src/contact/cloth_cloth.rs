//! Cloth and ropes against themselves and against each other.
//!
//! Two bodies that both ask for [triangles](crate::SelfContact::Triangles) touch by faces and edges
//! (`triangle_triangle.rs`), all others by particles (`particle_particle.rs`). Both keep lists of pairs near each
//! other, made by the function `list` of each. A list has a skin, and holds until something has moved through the skin
//! (Verlet 1967, "Computer experiments on classical fluids"). Within a list each pair sleeps until enough motion has
//! added up (`relative_motion.rs`). The places of the particles alone decide which pairs touch and in which order they
//! are projected, so the age of a list never changes the bits.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::broad_phase::relative_motion::RelativeMotion;
use crate::contact::cloth_contact::ClothContact;
use crate::contact::depenetration::PushOutRate;
use crate::contact::particle_particle::ParticlePairs;
use crate::contact::triangle_triangle::TrianglePairs;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// The contacts of an island's cloths and ropes with themselves and each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfContacts {
    motion: RelativeMotion,
    particles: ParticlePairs,
    triangles: TrianglePairs,
}

/// True if a body without faces, such as a rope, has self-contact.
pub(crate) fn is_on_ropes(bodies: &[Body]) -> bool {
    bodies.iter().any(|body| body.has_self_contact() && body.topology.faces().is_empty())
}

/// Forgets the contacts of the last substep and finds those of this one. It comes after free flight.
pub(crate) fn begin_substep(contacts: &mut SelfContacts, bodies: &mut [Body], substep: Substep) {
    let rate = PushOutRate::of(substep);
    let SelfContacts { motion, particles, triangles } = contacts;
    if !bodies.iter().any(Body::has_self_contact) {
        particles.clear();
        triangles.clear();
        motion.forget();
        return;
    }
    if !motion.follow(bodies, substep.isa, rate.is_first()) {
        particles.clear();
        triangles.clear();
    }
    particles.begin_substep(bodies, &motion.of_lists);
    triangles.begin_substep(bodies, motion, rate);
}

/// Moves overlapping parts apart.
pub(crate) fn project(contacts: &mut SelfContacts, bodies: &mut [Body], substep: Substep) {
    let rate = PushOutRate::of(substep);
    let SelfContacts { particles, triangles, .. } = contacts;
    particles.project(bodies, rate);
    triangles.project(bodies, rate);
}

/// Friction between all parts that touched, against their slip in this substep.
pub(crate) fn apply_friction(contacts: &SelfContacts, bodies: &mut [Body]) {
    contacts.particles.apply_friction(bodies);
    contacts.triangles.apply_friction(bodies);
}

impl SelfContacts {
    /// Forgets the contacts of a body that was taken out; the next substep makes new lists.
    pub fn forget(&mut self, body: usize) {
        self.particles.forget(body);
        self.triangles.forget(body);
    }

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        self.particles.is_near() || self.triangles.is_near()
    }

    /// Particles of different bodies that were pushed apart in the last substep: each as its body and slot, the unit
    /// normal from the second to the first, and the depth in metres, summed over the projections of the substep. Edges
    /// and faces count as their nearest particles.
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        let particles = self.particles.near().iter().filter_map(ClothContact::pushed_bodies);
        particles.chain(self.triangles.near().iter().filter_map(ClothContact::pushed_bodies))
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.particles.pair_count() + self.triangles.pair_count()
    }
}
