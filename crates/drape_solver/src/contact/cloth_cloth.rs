//! Cloth and ropes against themselves and against each other.
//!
//! Where both of two bodies are asked for [triangles](SelfContact::Triangles) they touch by faces and edges
//! (`contact_triangle_triangle`), else particle by particle (`contact_particle_particle`). Both keep lists of pairs that
//! are near each other, with a skin, so that a list holds until something has moved through it (Verlet 1967, "Computer
//! experiments on classical fluids"); and in a list each pair tells by how much motion it sleeps on
//! (`relative_motion`). Which pairs touch, and in which order they are projected, follows from where the particles are
//! and not from when the list was made: lists live on from step to step and leave no trace in the bits.

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

/// Whether a rope, or what else has no faces, is among those that touch themselves and others.
pub(crate) fn is_on_ropes(bodies: &[Body]) -> bool {
    bodies.iter().any(|body| body.has_self_contact() && body.topology.faces().is_empty())
}

/// Forgets the last substep's contacts, and finds those of this one, once all have flown.
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

/// Moves apart what overlaps.
pub(crate) fn project(contacts: &mut SelfContacts, bodies: &mut [Body], substep: Substep) {
    let rate = PushOutRate::of(substep);
    let SelfContacts { particles, triangles, .. } = contacts;
    particles.project(bodies, rate);
    triangles.project(bodies, rate);
}

/// Friction between all that touched, on what it has slipped past each other in this substep.
pub(crate) fn apply_friction(contacts: &SelfContacts, bodies: &mut [Body]) {
    contacts.particles.apply_friction(bodies);
    contacts.triangles.apply_friction(bodies);
}

impl SelfContacts {
    /// Forgets the contacts of a body that is no more; the next substep lists anew.
    pub fn forget(&mut self, body: usize) {
        self.particles.forget(body);
        self.triangles.forget(body);
    }

    /// Whether anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        self.particles.is_near() || self.triangles.is_near()
    }

    /// Particles of different bodies that were pushed apart in the last substep: each as its body and slot, the unit normal
    /// from the second to the first, and the depth in metres, summed over the projections of the substep. Of edges and
    /// faces, their nearest particles.
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        let particles = self.particles.near().iter().filter_map(ClothContact::pushed_bodies);
        particles.chain(self.triangles.near().iter().filter_map(ClothContact::pushed_bodies))
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.particles.pair_count() + self.triangles.pair_count()
    }
}
