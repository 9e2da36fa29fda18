//! Points that particles carry, against obstacles: the corners of a rigid body's collision mesh.
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
//!
//! Design: `docs/design/obstacles.md`.

use glam::{DVec3, Vec3};

use crate::contact::carried_point::{CarriedPoint, PoseCache, Poses, SurfaceBelow};
use crate::contact::depenetration::PushOutRate;
use crate::contact::face_search::SearchedObstacle;
use crate::contact::mover::Mover;
use crate::contact::obstacle_push::ObstaclePush;
use crate::geometry::nearest_triangle::weighted;
use crate::geometry::shape::Plane;
use crate::state::body::Body;
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
    point: CarriedPoint<4>,
    /// The plane that the point will run into, or the surface near it, in the obstacle's coordinates. None if each
    /// substep queries the shape itself.
    plane: Option<Plane>,
}

impl EmbeddedContacts {
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Obstacles that have contacts, by index.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.contacts.iter().map(|contact| contact.point.obstacle)
    }

    pub fn clear(&mut self) {
        self.contacts.clear();
    }

    /// The pushes of obstacles in the last substep.
    pub fn given<'a>(&'a self, particles: &'a Particles) -> impl Iterator<Item = ObstaclePush> + 'a {
        let given = self.contacts.iter().filter(|contact| contact.point.given != Vec3::ZERO);
        given.map(|contact| shared(&contact.point, particles, contact.point.given))
    }

    /// Lists the points that may touch an obstacle. `way` takes a point's position, its displacement in a substep and
    /// its place in the obstacle's coordinates, and returns its way through the step in these coordinates.
    pub fn search(
        &mut self,
        particles: &Particles,
        topology: &Topology,
        thickness: f32,
        searched: SearchedObstacle,
        way: impl Fn(Vec3, Vec3, Vec3) -> Vec3,
    ) {
        // Reserves for all points at once, so that points that come near one by one do not allocate one by one.
        self.contacts.reserve(topology.embedded.len());
        let (low, high) = searched.shape.local_bounds();
        for &EmbeddedPoint { particles: carriers, weights } in &topology.embedded {
            let carriers = carriers.map(|i| particles.layout.slot(i as usize));
            let place = weighted(weights, carriers.map(|slot| particles.position.get(slot)));
            let moved = weighted(weights, carriers.map(|slot| particles.displacement.get(slot)));
            let local = searched.pose.to_local(place);
            let way = way(place, moved, local);
            let path = way.length();
            let reach = path + thickness + searched.reach;
            if !(local.cmpge(low - reach).all() && local.cmple(high + reach).all()) {
                continue;
            }
            let surface = searched.shape.surface(local);
            if surface.distance >= reach {
                continue;
            }
            let has_formula = searched.shape.has_formula();
            let may_pass = searched.is_fast || !has_formula && path > thickness;
            let ahead =
                if may_pass && surface.distance > 0.0 { searched.shape.cast(local, way) } else { None };
            let ahead =
                ahead.map(|(fraction, normal)| Plane { normal, offset: normal.dot(local + way * fraction) });
            let near = || (!has_formula).then(|| surface.plane_at(local));
            self.contacts.push(EmbeddedContact {
                point: CarriedPoint::new(carriers, weights, searched.obstacle, searched.friction),
                plane: ahead.or_else(near),
            });
        }
    }
}

/// Forgets the last substep's depths.
pub(crate) fn begin_substep(contacts: &mut EmbeddedContacts) {
    for contact in &mut contacts.contacts {
        contact.point.begin_substep();
    }
}

/// Moves the points that are in an obstacle out to its surface.
pub(crate) fn project(
    contacts: &mut EmbeddedContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    let rate = PushOutRate::of(substep);
    let mut poses = PoseCache::default();
    for contact in &mut contacts.contacts {
        let (mover, poses) = poses.with_mover(contact.point.obstacle, movers, substep, body.particles.origin);
        contact.project(body, substep.obstacles, poses, mover, rate);
    }
}

impl EmbeddedContact {
    fn project(
        &mut self,
        body: &mut Body,
        obstacles: &[Obstacle],
        poses: &Poses,
        mover: Option<&mut Mover>,
        rate: PushOutRate,
    ) {
        let shape = obstacles[self.point.obstacle].shape();
        let plane = self.plane;
        let surface_at = |local: Vec3| shape.surface_or(plane, local);
        let thickness = body.settings.thickness;
        let point = self.point.mean(|slot| body.particles.position.get(slot));
        let surface = surface_at(poses.now.to_local(point));
        if thickness - surface.distance > 0.0 {
            self.point.project(
                body,
                SurfaceBelow { surface, thickness, surface_at },
                poses,
                mover,
                rate,
                reaction,
            );
        }
    }
}

fn reaction(point: &CarriedPoint<4>, particles: &Particles, _: Vec3, push: Vec3) -> ObstaclePush {
    shared(point, particles, push)
}

/// The share of a push (kg m) on the point that moves its unpinned carriers.
fn shared(point: &CarriedPoint<4>, particles: &Particles, push: Vec3) -> ObstaclePush {
    let (mut free, mut moment) = (0.0, DVec3::ZERO);
    for (slot, weight) in point.carriers.into_iter().zip(point.weights) {
        if particles.inverse_mass[slot] > 0.0 {
            free += weight;
            let begun = particles.position.get(slot) - particles.displacement.get(slot);
            moment += begun.as_dvec3() * f64::from(weight);
        }
    }
    let place = particles.origin.as_dvec3() + moment / f64::from(free);
    ObstaclePush { obstacle: point.obstacle, point: place, push: push * free, moment: Vec3::ZERO }
}

/// Friction at the points, against their slip in this substep.
pub(crate) fn apply_friction(
    contacts: &mut EmbeddedContacts,
    body: &mut Body,
    substep: Substep,
    movers: &mut [Mover],
) {
    let particles = &mut body.particles;
    let mut poses = PoseCache::default();
    for EmbeddedContact { point, .. } in
        contacts.contacts.iter_mut().filter(|contact| contact.point.depth > 0.0)
    {
        let (mover, poses) = poses.with_mover(point.obstacle, movers, substep, particles.origin);
        point.apply_friction(particles, point.depth, poses, mover, substep, reaction);
    }
}
