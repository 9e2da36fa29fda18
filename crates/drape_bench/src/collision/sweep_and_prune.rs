//! Like SOLID 2.0 (van den Bergen 1999, "A fast and robust GJK implementation for collision detection of convex
//! objects"): sweep and prune, then GJK with a cached separating axis for each pair.
//!
//! Sweep and prune: bunches of consecutive faces in the cloth's own order are kept sorted by the low ends of their
//! boxes along the cloth's longest axis. The boxes are wider than needed, so that those that move little keep their
//! place; few of the others change places from step to step, so insertion sort is nearly linear (Cohen et al. 1995,
//! "I-COLLIDE"). If many do, as in the first step of a shot, all are sorted anew. A ball looks up the part of that
//! order that it can reach, and compares the boxes of the faces there. In a substep each pair first tries the axis that
//! separated it last; if it still does, the pair is done. Otherwise parry's GJK starts with that axis, on the triangle
//! and the ball's centre: SOLID treats a sphere as a point with a margin, which needs no penetration depth. A new step
//! keeps the axes of the pairs that stay. Rejected: sorting single faces, which takes twice as long.

use drape_solver::glam::{Vec3, Vec3A};
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::query::gjk::{ConstantPoint, CsoPoint, GJKResult, VoronoiSimplex, closest_points};
use drape_solver::parry3d::shape::Triangle;

use super::method::{Contact, Method, Pair};
use super::state::State;

/// Faces per bunch.
const BUNCH: usize = 16;
/// Factor on lengths for GJK, whose tolerances are absolute and meant for shapes of some metres. A power of two, so
/// that nothing is rounded.
const SCALE: f32 = 64.0;
/// Additional width of boxes at either end, in metres.
const SLACK: f32 = 0.02;
/// All bunches are sorted anew if more than one in so many has left its box.
const MOVED_TO_SORT_ALL: usize = 32;

/// A pair that may touch in this step.
struct Candidate {
    pair: Pair,
    /// The last separating axis, a unit vector from the face to the ball; none if they touched.
    axis: Option<Vec3>,
}

/// See the [module](self).
pub struct SweepAndPrune {
    /// Low ends of boxes and their bunches, sorted.
    order: Vec<(f32, u32)>,
    /// The widened box of each bunch along the axis: low and high end.
    wide: Vec<(f32, f32)>,
    axis: usize,
    /// The length of the longest box along the axis, in metres.
    longest: f32,
    candidates: Vec<Candidate>,
    before: Vec<Candidate>,
    simplex: VoronoiSimplex,
    contacts: Vec<Contact>,
}

impl Default for SweepAndPrune {
    fn default() -> Self {
        Self {
            order: Vec::new(),
            wide: Vec::new(),
            axis: 0,
            longest: 0.0,
            candidates: Vec::new(),
            before: Vec::new(),
            simplex: VoronoiSimplex::new(),
            contacts: Vec::new(),
        }
    }
}

impl SweepAndPrune {
    /// Updates the order.
    fn sort(&mut self, state: &State) {
        let Self { order, wide, axis, longest, .. } = self;
        if wide.is_empty() {
            *axis = (state.bounds[1] - state.bounds[0]).max_position();
            order.extend((0..state.faces.len().div_ceil(BUNCH) as u32).map(|bunch| (0.0, bunch)));
            wide.resize(order.len(), (0.0, 0.0));
        }
        let mut moved = 0;
        for (bunch, wide) in state.faces.chunks(BUNCH).zip(&mut *wide) {
            let (low, high) = extent(state, bunch, *axis);
            if low < wide.0 || high > wide.1 {
                *wide = (low - SLACK, high + SLACK);
                *longest = longest.max(wide.1 - wide.0);
                moved += 1;
            }
        }
        for (low, bunch) in &mut *order {
            *low = wide[*bunch as usize].0;
        }
        if moved > order.len() / MOVED_TO_SORT_ALL {
            order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        } else if moved > 0 {
            for place in 1..order.len() {
                let entry = order[place];
                let mut to = place;
                while to > 0 && order[to - 1].0 > entry.0 {
                    order[to] = order[to - 1];
                    to -= 1;
                }
                order[to] = entry;
            }
        }
    }
}

fn extent(state: &State, bunch: &[[u32; 3]], axis: usize) -> (f32, f32) {
    bunch.iter().flatten().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &particle| {
        let place = state.positions[particle as usize][axis];
        (low.min(place), high.max(place))
    })
}

impl Method for SweepAndPrune {
    fn name(&self) -> &'static str {
        "sweep and prune, GJK"
    }

    fn begin_step(&mut self, state: &mut State) {
        core::mem::swap(&mut self.candidates, &mut self.before);
        self.candidates.clear();
        if state.near_balls().next().is_none() {
            return;
        }
        self.sort(state);
        for (ball, sphere) in state.near_balls() {
            let reach = sphere.reach + state.motion;
            let centre = Vec3A::from(sphere.centre);
            let (low, high) = (centre - reach, centre + reach);
            let first = self.order.partition_point(|entry| entry.0 < low[self.axis] - self.longest);
            let start = self.candidates.len();
            for &(least, bunch) in &self.order[first..] {
                if least > high[self.axis] {
                    break;
                }
                let first = bunch * BUNCH as u32;
                let faces = first..(first + BUNCH as u32).min(state.faces.len() as u32);
                let near = faces.filter(|&face| state.is_within(face, low, high));
                self.candidates.extend(near.map(|face| Candidate { pair: (ball, face), axis: None }));
            }
            self.candidates[start..].sort_unstable_by_key(|candidate| candidate.pair);
        }
        // Both lists are in the same order, so one pass carries the axes over.
        let mut before = self.before.iter().peekable();
        for candidate in &mut self.candidates {
            while before.next_if(|old| old.pair < candidate.pair).is_some() {}
            if let Some(old) = before.next_if(|old| old.pair == candidate.pair) {
                candidate.axis = old.axis;
            }
        }
    }

    fn find(&mut self, state: &mut State) -> usize {
        let Self { candidates, simplex, contacts, .. } = self;
        contacts.clear();
        let mut queries = 0;
        for Candidate { pair, axis } in candidates {
            let sphere = &state.balls[pair.0 as usize];
            let corners = state.corners(pair.1).map(|corner| (Vec3::from(corner) - sphere.centre) * SCALE);
            let [a, b, c] = corners;
            let apart = sphere.apart * SCALE;
            if let Some(axis) = axis {
                let nearest = -axis.dot(a).max(axis.dot(b)).max(axis.dot(c));
                if nearest >= apart {
                    continue;
                }
            }
            queries += 1;
            // The face relative to the ball's centre, the origin of the configuration space.
            let triangle = Triangle::new(a, b, c);
            let point = ConstantPoint(Vec3::ZERO);
            let pose = Pose::IDENTITY;
            let start = axis.unwrap_or_else(|| (-(a + b + c)).normalize_or(Vec3::Y));
            simplex.reset(CsoPoint::from_shapes(&pose, &triangle, &point, start));
            match closest_points(&pose, &triangle, &point, apart, true, simplex) {
                GJKResult::ClosestPoints(nearest, _, _) => {
                    let distance = nearest.length();
                    let normal = -nearest / distance.max(f32::MIN_POSITIVE);
                    // This axis lets GJK end at once, and separates the pair once the ball has left.
                    *axis = Some(normal);
                    if distance < apart {
                        let weights = weights(simplex, corners);
                        contacts.push(Contact {
                            pair: *pair,
                            weights,
                            normal,
                            depth: (apart - distance) / SCALE,
                        });
                    }
                }
                GJKResult::NoIntersection(direction) => *axis = Some(direction),
                // The centre lies in the face.
                GJKResult::Intersection | GJKResult::Proximity(_) => {
                    *axis = None;
                    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
                    let weights = weights(simplex, corners);
                    contacts.push(Contact { pair: *pair, weights, normal, depth: sphere.apart });
                }
            }
        }
        queries
    }

    fn pairs(&self, _: &State) -> Vec<Pair> {
        self.contacts.iter().map(|contact| contact.pair).collect()
    }
}

/// Weights of the corners in GJK's nearest point: those of the simplex, whose points are corners of the face.
fn weights(simplex: &VoronoiSimplex, corners: [Vec3; 3]) -> [f32; 3] {
    let mut weights = [0.0; 3];
    for i in 0..=simplex.dimension() {
        let point = simplex.point(i).orig1;
        if let Some(corner) = corners.iter().position(|&corner| corner == point) {
            weights[corner] += if simplex.dimension() == 0 { 1.0 } else { simplex.proj_coord(i) };
        }
    }
    weights
}
