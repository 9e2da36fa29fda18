//! Points that particles carry against obstacles: the corners of a rigid body's collision mesh.
//!
//! ```text
//!          o x1            p = sum c_i x_i, where the sum of c_i is 1; outside the four, some c_i are negative
//!        / | \            C = n . (p - q) - t
//!    x2 o--+--o x3         if C < 0:  x_i -= c_i w_i C n / sum(c_j^2 w_j)
//!        \ | /
//!          o x4   p .      q, n: the nearest point of the surface, and its normal
//!     ================
//! ```
//!
//! Of all moves that take `p` out, this one costs the least kinetic energy, `sum |dx_i|^2 / w_i`: the push acts at `p`, so that
//! momentum and angular momentum are those that it gives. With equal masses it is Jakobsen's formula (2001, section 5).

use glam::{DVec3, Vec3};

use crate::contact::depenetration::{Overlap, Pace};
use crate::contact::dynamic_obstacle::{Mover, mover_mut};
use crate::contact::effective_mass::felt;
use crate::contact::face_obstacle::{Met, Poses, kept};
use crate::contact::reaction::Given;
use crate::geometry::shape::Plane;
use crate::state::body::Body;
use crate::state::friction::Friction;
use crate::state::obstacle::Obstacle;
use crate::state::particles::Particles;
use crate::state::substep::Substep;
use crate::state::topology::{EmbeddedPoint, Topology};

/// Points of one body that may touch obstacles in this step, obstacle by obstacle.
#[derive(Clone, Debug, Default)]
pub(crate) struct EmbeddedContacts {
    contacts: Vec<EmbeddedContact>,
}

#[derive(Clone, Copy, Debug)]
struct EmbeddedContact {
    carriers: [usize; 4],
    weights: [f32; 4],
    obstacle: usize,
    friction: Friction,
    /// What the point will run into, or the surface near it, in the obstacle's coordinates, where asking the shape each
    /// time would be wrong or slow.
    plane: Option<Plane>,
    /// Metres, summed over the projections of the substep.
    depth: f32,
    overlap: Overlap,
    /// In the world, of the last projection.
    normal: Vec3,
    /// How far the point was moved in this substep where that counts as velocity, times the mass it has: in kilogram
    /// metres.
    given: Vec3,
}

impl EmbeddedContacts {
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Obstacles that have contacts, by index.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.contacts.iter().map(|contact| contact.obstacle)
    }

    pub fn clear(&mut self) {
        self.contacts.clear();
    }

    /// What obstacles have given in the last substep.
    pub fn given<'a>(&'a self, particles: &'a Particles) -> impl Iterator<Item = Given> + 'a {
        let given = self.contacts.iter().filter(|contact| contact.given != Vec3::ZERO);
        given.map(|contact| contact.shared(particles, contact.given))
    }

    /// Lists the points that may touch an obstacle. `way` tells where a point that is here and moves so in a substep gets in
    /// the step, in the obstacle's coordinates.
    pub fn search(
        &mut self,
        particles: &Particles,
        topology: &Topology,
        thickness: f32,
        met: Met,
        way: impl Fn(Vec3, Vec3, Vec3) -> Vec3,
    ) {
        // As much as one obstacle can ask for, at once.
        self.contacts.reserve(topology.embedded.len());
        let (low, high) = met.shape.local_bounds();
        for &EmbeddedPoint { particles: carriers, weights } in &topology.embedded {
            let carriers = carriers.map(|i| particles.layout.slot(i as usize));
            let place = weighted(weights, carriers.map(|slot| particles.position.get(slot)));
            let moved = weighted(weights, carriers.map(|slot| particles.displacement.get(slot)));
            let local = met.pose.to_local(place);
            let way = way(place, moved, local);
            let path = way.length();
            let reach = path + thickness + met.reach;
            if !(local.cmpge(low - reach).all() && local.cmple(high + reach).all()) {
                continue;
            }
            let surface = met.shape.surface(local);
            if surface.distance >= reach {
                continue;
            }
            let has_formula = met.shape.has_formula();
            let may_pass = met.is_swift || !has_formula && path > thickness;
            let ahead = if may_pass && surface.distance > 0.0 { met.shape.cast(local, way) } else { None };
            let ahead =
                ahead.map(|(fraction, normal)| Plane { normal, offset: normal.dot(local + way * fraction) });
            let near = || (!has_formula).then(|| surface.plane_at(local));
            self.contacts.push(EmbeddedContact {
                carriers,
                weights,
                obstacle: met.obstacle,
                friction: met.friction,
                plane: ahead.or_else(near),
                depth: 0.0,
                overlap: Overlap::default(),
                normal: Vec3::ZERO,
                given: Vec3::ZERO,
            });
        }
    }
}

fn weighted(weights: [f32; 4], [a, b, c, d]: [Vec3; 4]) -> Vec3 {
    a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3]
}

/// Forgets the last substep's depths.
pub(crate) fn begin_substep(contacts: &mut EmbeddedContacts) {
    for contact in &mut contacts.contacts {
        contact.depth = 0.0;
        contact.given = Vec3::ZERO;
        contact.overlap = Overlap::default();
    }
}

/// Moves the points that are in an obstacle out to its surface.
pub(crate) fn project(
    contacts: &mut EmbeddedContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    let pace = Pace::of(substep);
    let mut poses = None;
    for contact in &mut contacts.contacts {
        let mover = mover_mut(movers, contact.obstacle);
        let poses = kept(&mut poses, contact.obstacle, mover.as_deref(), substep, body.particles.origin);
        contact.project(body, substep.obstacles, poses, mover, pace);
    }
}

impl EmbeddedContact {
    fn project(
        &mut self,
        body: &mut Body,
        obstacles: &[Obstacle],
        poses: &Poses,
        mover: Option<&mut Mover>,
        pace: Pace,
    ) {
        let (carriers, weights) = (self.carriers, self.weights);
        let point = weighted(weights, carriers.map(|slot| body.particles.position.get(slot)));
        let local = poses.now.to_local(point);
        let shape = obstacles[self.obstacle].shape();
        let surface_at = |local: Vec3| match self.plane {
            Some(plane) => plane.surface(local),
            None => shape.surface(local),
        };
        let surface = surface_at(local);
        let thickness = body.settings.thickness;
        let depth = thickness - surface.distance;
        let felt = self.felt(&body.particles);
        if depth <= 0.0 || felt == 0.0 {
            return;
        }
        let normal = poses.now.direction_to_world(surface.normal);
        let travel = weighted(weights, carriers.map(|slot| body.travel(slot)));
        let carried = point - poses.before.point_to_world(local);
        let start = poses.before.to_local(point - travel);
        let at_start = || thickness - surface_at(start).distance;
        let mut push = self.overlap.split(depth, (travel - carried).dot(normal), at_start, pace);
        if let Some(mover) = mover {
            let contact = body.particles.origin + point;
            push.fresh *= felt / (felt + mover.inverse_mass_at(contact, normal));
            let given = normal * (push.fresh / felt);
            mover.receive(self.shared(&body.particles, given), pace.substep());
        }
        self.depth += push.fresh;
        self.normal = normal;
        self.given += normal * (push.fresh / felt);
        for (slot, weight) in carriers.into_iter().zip(weights) {
            let share = weight * body.particles.inverse_mass[slot] / felt;
            let (fresh, all) = (normal * (push.fresh * share), normal * ((push.fresh + push.old) * share));
            body.particles.displacement.add(slot, fresh);
            body.particles.position.add(slot, all);
            body.context.integrated.add(slot, all);
        }
    }

    /// Inverse mass of the point in 1/kg, if its carriers were free of each other.
    fn felt(&self, particles: &Particles) -> f32 {
        felt(self.weights, self.carriers.map(|slot| particles.inverse_mass[slot]))
    }

    /// A push (kg m) on the point, as it comes to the carriers that are not held.
    fn shared(&self, particles: &Particles, push: Vec3) -> Given {
        let (mut free, mut moment) = (0.0, DVec3::ZERO);
        for (slot, weight) in self.carriers.into_iter().zip(self.weights) {
            if particles.inverse_mass[slot] > 0.0 {
                free += weight;
                let begun = particles.position.get(slot) - particles.displacement.get(slot);
                moment += begun.as_dvec3() * f64::from(weight);
            }
        }
        let point = particles.origin.as_dvec3() + moment / f64::from(free);
        Given { obstacle: self.obstacle, point, push: push * free, moment: Vec3::ZERO }
    }
}

/// Friction at the points, on what they have slipped in this substep.
pub(crate) fn apply_friction(
    contacts: &mut EmbeddedContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    let particles = &mut body.particles;
    let mut poses = None;
    for contact in contacts.contacts.iter_mut().filter(|contact| contact.depth > 0.0) {
        let mover = mover_mut(movers, contact.obstacle);
        let poses = kept(&mut poses, contact.obstacle, mover.as_deref(), substep, particles.origin);
        let (carriers, weights) = (contact.carriers, contact.weights);
        let point = weighted(weights, carriers.map(|slot| particles.position.get(slot)));
        let moved = weighted(weights, carriers.map(|slot| particles.displacement.get(slot)));
        let slip = moved - (point - poses.before.point_to_world(poses.now.to_local(point)));
        let felt = contact.felt(particles);
        let taken = match mover {
            Some(mover) => {
                let place = particles.origin + point;
                let (taken, push) =
                    mover.slip_taken(contact.friction, felt, slip, contact.normal, contact.depth, place);
                mover.receive(contact.shared(particles, push), substep.duration);
                taken
            }
            None => contact.friction.slip_taken(slip, contact.normal, contact.depth),
        };
        contact.given -= taken / felt;
        for (slot, weight) in carriers.into_iter().zip(weights) {
            let shift = taken * (-weight * particles.inverse_mass[slot] / felt);
            particles.position.add(slot, shift);
            particles.displacement.add(slot, shift);
        }
    }
}
