//! Cloth against itself and against other cloth, particle by particle.
//!
//! Each particle is a ball of the cloth's thickness. Two that overlap move apart along their line, by inverse masses:
//!
//! ```text
//!      a o--->|  |<---o b       C = |x_a - x_b| - (t_a + t_b)
//!             overlap           if C < 0:  x_a -= w_a C n / (w_a + w_b),  x_b += w_b C n / (w_a + w_b)
//! ```
//!
//! Particles that are as near to each other at rest are let be: sticks hold them.
//!
//! Pairs that are near each other are listed with a skin around the particles, so that the list holds until one has
//! moved through a part of it (Verlet 1967, "Computer experiments on classical fluids"). What all do together does not
//! count, so that falling cloth keeps its list.

use glam::Vec3;

use crate::body::Body;
use crate::cell_list::CellList;
use crate::constants::{NEIGHBOURS_AT_REST, SKIN, SKIN_FOR_FLIGHT};
use crate::friction::{combined, slip_taken};
use crate::island::{Island, IslandContext};
use crate::overlap::{Overlap, Pace};

/// The particles of an island that may touch each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct SelfContacts {
    cells: CellList,
    /// Particles of bodies with self-contact, body by body; then in order of the grid's cubes.
    given: Vec<Holder>,
    holders: Vec<Holder>,
    /// Where they are now: kept beside `holders`, as most pairs need no more.
    spheres: Vec<Sphere>,
    /// Where they were when the pairs were listed.
    listed_at: Vec<Vec3>,
    /// Greatest distance at which two touch, in metres.
    greatest_distance: f32,
    /// Pairs of places in `holders`.
    pairs: Vec<[u32; 2]>,
    /// One for each pair.
    contacts: Vec<Contact>,
    /// Pairs that have been pushed in this substep, in the order of the first push.
    touching: Vec<u32>,
}

/// Whose particle it is.
#[derive(Clone, Copy, Debug)]
struct Holder {
    body: u32,
    slot: u32,
    index: u32,
}

/// A particle's centre, relative to the origin of the island's first body, and thickness: metres.
#[derive(Clone, Copy, Debug)]
struct Sphere {
    centre: Vec3,
    radius: f32,
}

/// What has happened to a pair in this substep.
#[derive(Clone, Copy, Debug, Default)]
struct Contact {
    is_touching: bool,
    /// Depth that motion made, summed over the projections, in metres.
    depth: f32,
    overlap: Overlap,
    /// From the second to the first.
    normal: Vec3,
}

/// Whether particles of the body touch each other.
pub(crate) fn is_on(body: &Body) -> bool {
    body.settings.self_contact && body.settings.thickness > 0.0 && !body.particles.is_empty()
}

/// Lists the pairs that may touch.
pub(crate) fn detect(island: &mut Island) {
    let Island { bodies, context, .. } = island;
    context.self_contacts.list(bodies);
}

/// Forgets the last substep's depths, and lists anew where particles have left their skins.
pub(crate) fn begin_substep(island: &mut Island) {
    let Island { bodies, context, .. } = island;
    let contacts = &mut context.self_contacts;
    for &pair in &contacts.touching {
        contacts.contacts[pair as usize] = Contact::default();
    }
    contacts.touching.clear();
    if contacts.holders.is_empty() {
        return;
    }
    contacts.place_spheres(bodies);
    if contacts.is_out_of_date() {
        contacts.list(bodies);
    }
}

impl SelfContacts {
    /// Forgets the particles of a body that is no more; pairs are listed anew when the next substep begins.
    pub fn forget(&mut self, body: usize) {
        if self.given.iter().any(|holder| holder.body as usize == body) {
            self.pairs.clear();
            self.contacts.clear();
            self.touching.clear();
            self.holders.retain(|holder| holder.body as usize != body);
            // Out of date, as nothing is ever infinitely far away.
            self.listed_at.clear();
        }
    }

    /// Particles of different bodies that were pushed apart in the last substep: each as its body and slot, the unit normal
    /// from the second to the first, and the depth in metres, summed over the projections of the substep.
    pub fn pushed_bodies(&self) -> impl Iterator<Item = ([(usize, usize); 2], Vec3, f32)> + '_ {
        let touching =
            self.touching.iter().map(|&pair| (self.pairs[pair as usize], &self.contacts[pair as usize]));
        let pushed = touching.filter(|(_, contact)| contact.depth > 0.0).map(|(pair, contact)| {
            let ends = pair.map(|place| self.holders[place as usize]);
            (ends.map(|end| (end.body as usize, end.slot as usize)), contact.normal, contact.depth)
        });
        pushed.filter(|([(a, _), (b, _)], ..)| a != b)
    }

    /// The number of pairs that are watched.
    pub fn pair_count(&self) -> usize {
        self.pairs.len()
    }

    fn list(&mut self, bodies: &[Body]) {
        self.given.clear();
        self.holders.clear();
        self.listed_at.clear();
        self.pairs.clear();
        self.contacts.clear();
        self.touching.clear();
        let mut radius = 0.0_f32;
        for (place, body) in bodies.iter().enumerate().filter(|(_, body)| is_on(body)) {
            radius = radius.max(body.settings.thickness);
            let slots = body.particles.layout.slots().enumerate();
            self.given.extend(slots.map(|(index, slot)| Holder {
                body: place as u32,
                slot: slot as u32,
                index: index as u32,
            }));
        }
        if self.given.is_empty() {
            return;
        }
        self.greatest_distance = 2.0 * radius;
        let skin = SKIN * self.greatest_distance;
        let origin = bodies[0].particles.origin;
        let points = self.given.iter().map(|holder| sphere(holder, bodies, origin).centre);
        self.cells.build(points, self.greatest_distance + skin);
        self.holders.extend(self.cells.order().iter().map(|&given| self.given[given as usize]));
        self.place_spheres(bodies);
        self.listed_at.extend(self.spheres.iter().map(|sphere| sphere.centre));
        let Self { cells, holders, spheres, pairs, .. } = self;
        cells.for_each_pair(|a, b| {
            let apart = spheres[a].radius + spheres[b].radius;
            let reach = apart + skin;
            if spheres[a].centre.distance_squared(spheres[b].centre) < reach * reach
                && may_touch(&holders[a], &holders[b], apart, bodies)
            {
                pairs.push([a as u32, b as u32]);
            }
        });
        self.contacts.resize(self.pairs.len(), Contact::default());
        // As long as the list of pairs may get: then no step allocates for what first touches in it.
        self.touching.reserve(self.pairs.len());
    }

    fn place_spheres(&mut self, bodies: &[Body]) {
        let origin = bodies.first().map_or(Vec3::ZERO, |body| body.particles.origin);
        self.spheres.clear();
        self.spheres.extend(self.holders.iter().map(|holder| sphere(holder, bodies, origin)));
    }

    /// Whether a particle has moved so far from where it was listed, against the mean of all, that the skins may not do
    /// for this substep.
    fn is_out_of_date(&self) -> bool {
        if self.listed_at.len() != self.spheres.len() {
            return true;
        }
        let ways = self.spheres.iter().zip(&self.listed_at).map(|(sphere, &from)| sphere.centre - from);
        let mean = ways.clone().fold(Vec3::ZERO, |sum, way| sum + way) / self.spheres.len() as f32;
        let most = 0.5 * SKIN_FOR_FLIGHT * SKIN * self.greatest_distance;
        let farthest = ways.map(|way| (way - mean).length_squared()).fold(0.0, f32::max);
        farthest > most * most
    }
}

fn sphere(holder: &Holder, bodies: &[Body], origin: Vec3) -> Sphere {
    let body = &bodies[holder.body as usize];
    let centre = body.particles.position.get(holder.slot as usize) + (body.particles.origin - origin);
    Sphere { centre, radius: body.settings.thickness }
}

/// Whether two may touch at all: one must be free, their layers must meet, and of one body they must not be neighbours at rest.
fn may_touch(a: &Holder, b: &Holder, apart: f32, bodies: &[Body]) -> bool {
    let inverse_mass =
        |holder: &Holder| bodies[holder.body as usize].particles.inverse_mass[holder.slot as usize];
    if inverse_mass(a) + inverse_mass(b) == 0.0 {
        return false;
    }
    if a.body != b.body && !bodies[a.body as usize].layers.interact(bodies[b.body as usize].layers) {
        return false;
    }
    let rest = &bodies[a.body as usize].topology.rest;
    let near = apart * NEIGHBOURS_AT_REST;
    let at_rest = [a, b].map(|holder| rest.get(holder.index as usize).copied());
    match at_rest {
        [Some(p), Some(q)] if a.body == b.body => p.distance_squared(q) >= near * near,
        _ => true,
    }
}

/// Moves particles apart that overlap.
pub(crate) fn project(island: &mut Island) {
    let Island { bodies, context, .. } = island;
    let pace = Pace::of(context);
    let contacts = &mut context.self_contacts;
    if contacts.pairs.is_empty() {
        return;
    }
    contacts.place_spheres(bodies);
    let SelfContacts { holders, spheres, pairs, contacts, touching, .. } = contacts;
    for (pair, &[a, b]) in pairs.iter().enumerate() {
        let [sphere_a, sphere_b] = [a, b].map(|place| spheres[place as usize]);
        let apart = sphere_a.centre - sphere_b.centre;
        let reach = sphere_a.radius + sphere_b.radius;
        let distance_squared = apart.length_squared();
        if distance_squared >= reach * reach {
            continue;
        }
        let distance = distance_squared.sqrt();
        let contact = &mut contacts[pair];
        // Coincident centres have no direction of their own: one goes up.
        contact.normal = if distance > 0.0 { apart / distance } else { Vec3::Y };
        let ends = [a, b].map(|place| holders[place as usize]);
        let [(mass_a, travel_a), (mass_b, travel_b)] = ends.map(|end| {
            let (body, slot) = (&bodies[end.body as usize], end.slot as usize);
            (body.particles.inverse_mass[slot], body.travel(slot))
        });
        let travel = travel_a - travel_b;
        let at_start = || reach - (apart - travel).length();
        let push = contact.overlap.split(reach - distance, travel.dot(contact.normal), at_start, pace);
        if !contact.is_touching {
            contact.is_touching = true;
            touching.push(pair as u32);
        }
        contact.depth += push.fresh;
        let total = mass_a + mass_b;
        let [fresh, old] = [push.fresh, push.old].map(|way| contact.normal * (way / total));
        for (place, end, share) in [(a, ends[0], mass_a), (b, ends[1], -mass_b)] {
            let (body, slot) = (&mut bodies[end.body as usize], end.slot as usize);
            // Straight into the displacement, which is finer than the position: momentum is kept.
            body.particles.displacement.add(slot, fresh * share);
            body.particles.position.add(slot, (fresh + old) * share);
            body.context.integrated.add(slot, (fresh + old) * share);
            spheres[place as usize].centre += (fresh + old) * share;
        }
    }
}

/// Friction between the two, on what they have slipped past each other in this substep.
pub(crate) fn apply_friction(island: &mut Island) {
    let Island { bodies, context: IslandContext { self_contacts, .. }, .. } = island;
    let SelfContacts { holders, pairs, contacts, touching, .. } = self_contacts;
    for &pair in touching.iter() {
        let Contact { depth, normal, .. } = contacts[pair as usize];
        let ends = pairs[pair as usize].map(|place| holders[place as usize]);
        let [(mass_a, moved_a, rough_a), (mass_b, moved_b, rough_b)] = ends.map(|end| {
            let (body, slot) = (&bodies[end.body as usize], end.slot as usize);
            let moved = body.particles.displacement.get(slot);
            (body.particles.inverse_mass[slot], moved, body.settings.friction)
        });
        let taken = slip_taken(moved_a - moved_b, normal, combined(rough_a, rough_b), depth);
        let push = taken / (mass_a + mass_b);
        for (end, share) in [(ends[0], -mass_a), (ends[1], mass_b)] {
            let particles = &mut bodies[end.body as usize].particles;
            particles.displacement.add(end.slot as usize, push * share);
            particles.position.add(end.slot as usize, push * share);
        }
    }
}
