//! Cloth against itself and against other cloth, particle by particle.
//!
//! Each particle is a ball of the cloth's thickness. Two that overlap move apart along their line, by inverse masses:
//!
//! ```text
//!      a o--->|  |<---o b       C = |x_a - x_b| - (t_a + t_b)
//!             overlap           if C < 0:  x_a -= w_a C n / (w_a + w_b),  x_b += w_b C n / (w_a + w_b)
//! ```
//!
//! Particles that are this near to each other at rest are left out: sticks hold them.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::broad_phase::cell_list::CellList;
use crate::broad_phase::relative_motion::Motion;
use crate::constants::{CONTACT_SLACK, NEIGHBOURS_AT_REST, SKIN};
use crate::contact::cloth_contact::{ClothContact, Corner, Penetration, has_triangles};
use crate::contact::depenetration::PushOutRate;
use crate::state::body::Body;

/// The particles of an island that may touch each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParticlePairs {
    cells: CellList,
    /// Particles of bodies with self-contact, body by body, with their places when the pairs were listed.
    holders: Vec<Holder>,
    /// Pairs of indices into `holders`, sorted; the lower index is in the upper 32 bits.
    pairs: Vec<u64>,
    /// For each pair the relative motion in metres at which it must be tested again.
    wake_at: Vec<f32>,
    /// Relative motion in metres up to which the list holds; none if there is no list.
    holds_until: Option<f32>,
    /// Contacts that may touch in this substep.
    near: Vec<ClothContact<2>>,
}

/// A particle with its place when the pairs were listed.
#[derive(Clone, Copy, Debug)]
struct Holder {
    corner: Corner,
    index: u32,
    radius: f32,
    centre: Vec3,
}

impl ParticlePairs {
    /// Forgets all pairs.
    pub fn clear(&mut self) {
        self.holds_until = None;
        self.pairs.clear();
        self.wake_at.clear();
        self.near.clear();
    }

    /// Forgets the contacts of a body.
    pub fn forget(&mut self, body: usize) {
        self.near.retain(|contact| contact.corners.iter().all(|corner| corner.body as usize != body));
    }

    /// True if anything may touch in this substep.
    pub fn is_near(&self) -> bool {
        !self.near.is_empty()
    }

    /// Contacts that may touch in this substep.
    pub fn near(&self) -> &[ClothContact<2>] {
        &self.near
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    /// Finds the pairs that may touch in this substep.
    pub fn begin_substep(&mut self, bodies: &[Body], motion: &Motion) {
        self.near.clear();
        if bodies.iter().filter(|body| body.has_self_contact()).all(has_triangles) {
            self.clear();
            return;
        }
        if self.holds_until.is_none_or(|end| motion.now > end) {
            self.list(bodies, motion.now);
        }
        let origin = bodies[0].particles.origin;
        let Self { holders, pairs, wake_at, near, .. } = self;
        for (pair, wake_at) in pairs.iter().zip(wake_at) {
            if motion.now < *wake_at {
                continue;
            }
            let [a, b] = [pair >> 32, pair & 0xffff_ffff].map(|place| &holders[place as usize]);
            let apart = a.radius + b.radius;
            let reach = apart * (1.0 + CONTACT_SLACK);
            let way = a.corner.position(bodies, origin) - b.corner.position(bodies, origin);
            let distance_squared = way.length_squared();
            if distance_squared < reach * reach {
                near.push(ClothContact::new([a.corner, b.corner], apart));
            } else {
                *wake_at = motion.now + (distance_squared.sqrt() * 0.9999 - reach);
            }
        }
    }

    /// Lists the pairs that may touch before particles have moved through the skin.
    fn list(&mut self, bodies: &[Body], motion: f32) {
        let Self { cells, holders, pairs, wake_at, holds_until, .. } = self;
        holders.clear();
        pairs.clear();
        wake_at.clear();
        let origin = bodies[0].particles.origin;
        for (place, body) in bodies.iter().enumerate().filter(|(_, body)| body.has_self_contact()) {
            let slots = body.particles.layout.slots().enumerate();
            holders.extend(slots.map(|(index, slot)| {
                let corner = Corner { body: place as u32, slot: slot as u32 };
                let centre = corner.position(bodies, origin);
                Holder { corner, index: index as u32, radius: body.settings.thickness, centre }
            }));
        }
        let widest = 2.0 * holders.iter().map(|holder| holder.radius).fold(0.0, f32::max);
        let skin = SKIN * widest;
        *holds_until = Some(motion + skin);
        let reach = widest * CONTACT_SLACK + skin;
        cells.build(holders.iter().map(|holder| holder.centre), widest + reach);
        cells.for_each_pair(|a, b| {
            let (a, b) = (cells.order()[a], cells.order()[b]);
            let (a, b) = (a.min(b), a.max(b));
            let (p, q) = (&holders[a as usize], &holders[b as usize]);
            let reach = p.radius + q.radius + reach;
            if p.centre.distance_squared(q.centre) < reach * reach && may_touch(p, q, bodies) {
                pairs.push((u64::from(a) << 32) | u64::from(b));
            }
        });
        // Sorted, so that the order of projections does not depend on when the pairs were listed.
        pairs.sort_unstable();
        wake_at.resize(pairs.len(), f32::NEG_INFINITY);
        // Reserves for all pairs, so that no later step allocates when pairs first touch.
        self.near.reserve(pairs.len());
    }

    /// Moves overlapping particles apart.
    pub fn project(&mut self, bodies: &mut [Body], rate: PushOutRate) {
        let origin = bodies.first().map_or(Vec3::ZERO, |body| body.particles.origin);
        for contact in &mut self.near {
            let [a, b] = contact.corners;
            let way = a.position(bodies, origin) - b.position(bodies, origin);
            let distance_squared = way.length_squared();
            if distance_squared >= contact.apart * contact.apart {
                continue;
            }
            let distance = distance_squared.sqrt();
            // Coincident centres have no direction of their own: one goes up.
            let normal = if distance > 0.0 { way / distance } else { Vec3::Y };
            let before = a.start(bodies, origin) - b.start(bodies, origin);
            let outward = (way - before).dot(normal);
            let (at_start, depth) = (contact.apart - before.length(), contact.apart - distance);
            contact.push(
                bodies,
                rate,
                Penetration { weights: [1.0, -1.0], normal, depth, outward, at_start },
            );
        }
    }

    /// Friction between particles that touched.
    pub fn apply_friction(&self, bodies: &mut [Body]) {
        self.near.iter().for_each(|contact| contact.apply_friction(bodies));
    }
}

/// True if two particles may touch at all: not if both bodies touch by triangles, and not if they are neighbours at
/// rest in one body.
fn may_touch(a: &Holder, b: &Holder, bodies: &[Body]) -> bool {
    let [p, q] = [a, b].map(|holder| &bodies[holder.corner.body as usize]);
    let is_one = a.corner.body == b.corner.body;
    if has_triangles(p) && has_triangles(q) || !is_one && !p.layers.interact(q.layers) {
        return false;
    }
    let near = (a.radius + b.radius) * NEIGHBOURS_AT_REST;
    let at_rest = [a, b].map(|holder| p.topology.rest.get(holder.index as usize));
    match at_rest {
        [Some(p), Some(q)] if is_one => p.distance_squared(*q) >= near * near,
        _ => true,
    }
}
