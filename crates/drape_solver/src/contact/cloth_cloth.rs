//! Cloth and ropes against themselves and against each other.
//!
//! Two bodies that both ask for [triangles](crate::SelfContact::Triangles) touch by faces and edges
//! (`surface/`), all others by particles (`particle_particle.rs`). Both keep lists of pairs near each
//! other, made by the function `list` of each. A list has a skin, and holds until something has moved through the skin
//! (Verlet 1967, "Computer experiments on classical fluids"). Within a list each pair sleeps until enough motion has
//! added up (`relative_motion.rs`). The places of the particles alone decide which pairs touch and in which order they
//! are projected, so the age of a list never changes the bits.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::broad_phase::relative_motion::RelativeMotion;
use crate::constants::CONTACT_SLACK;
use crate::contact::cloth_contact::{ClothContact, has_triangles};
use crate::contact::depenetration::PushOutRate;
use crate::contact::particle_particle::ParticlePairs;
use crate::contact::surface::SurfaceContacts;
use crate::contact::surface::counts::SelfContactCounts;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// The contacts of an island's cloths and ropes with themselves and each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfContacts {
    motion: RelativeMotion,
    particles: ParticlePairs,
    pub surfaces: SurfaceContacts,
}

/// True if a body without faces, such as a rope, has self-contact.
pub(crate) fn is_on_ropes(bodies: &[Body]) -> bool {
    bodies.iter().any(|body| body.has_self_contact() && body.topology.faces().is_empty())
}

/// Notes where everything is when a substep begins.
pub(crate) fn note_starts(contacts: &mut SelfContacts, bodies: &[Body], substep: Substep) {
    contacts.surfaces.begin_substep(bodies, substep.index == 0);
}

/// Forgets the contacts of the last substep and finds those of this one. It comes after free flight.
pub(crate) fn begin_substep(contacts: &mut SelfContacts, bodies: &mut [Body], substep: Substep) {
    let SelfContacts { motion, particles, surfaces } = contacts;
    if !bodies.iter().any(Body::has_self_contact) {
        particles.clear();
        motion.forget();
        return;
    }
    if bodies.iter().filter(|body| body.has_self_contact()).all(has_triangles) {
        particles.clear();
        motion.forget();
    } else {
        if !motion.follow(bodies, substep.isa, substep.index == 0) {
            particles.clear();
        }
        particles.begin_substep(bodies, &motion.of_lists);
    }
    if is_on_ropes(bodies) {
        surfaces.detect(bodies, substep, CONTACT_SLACK);
    }
}

/// Moves overlapping parts apart; with friction between surfaces in the last projection of a substep.
pub(crate) fn project(contacts: &mut SelfContacts, bodies: &mut [Body], substep: Substep, is_last: bool) {
    let rate = PushOutRate::of(substep);
    let SelfContacts { particles, surfaces, .. } = contacts;
    particles.project(bodies, rate);
    surfaces.project(bodies, rate, is_last);
}

/// Friction between all particles that touched, against their slip in this substep.
pub(crate) fn apply_friction(contacts: &SelfContacts, bodies: &mut [Body]) {
    contacts.particles.apply_friction(bodies);
}

impl SelfContacts {
    /// Forgets the contacts of a body that was taken out; the next substep makes new lists.
    pub fn forget(&mut self, body: usize) {
        self.particles.forget(body);
        self.surfaces.clear();
    }

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        self.particles.is_near() || self.surfaces.is_near()
    }

    /// Particles of different bodies that were pushed apart in the last substep: each as its body and slot, the unit
    /// normal from the second to the first, and the depth in metres, summed over the projections of the substep. Edges
    /// and faces count as their nearest particles.
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        let particles = self.particles.near().iter().filter_map(ClothContact::pushed_bodies);
        particles.chain(self.surfaces.pushed_bodies())
    }

    /// The work of the last step.
    pub fn counts(&self) -> SelfContactCounts {
        let of_surfaces = self.surfaces.counts();
        SelfContactCounts { pairs: self.particles.pair_count() + of_surfaces.pairs, ..of_surfaces }
    }
}
