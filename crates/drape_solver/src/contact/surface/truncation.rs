//! Truncation: the last stage of a substep, after which no part has passed through another.
//!
//! If a plane lies between two parts at the start of a substep and at its end, and all corners go straight and evenly,
//! the two have not met on their way. Where the plane that belongs to a contact does not, the two corners that stick out
//! most are moved apart along its normal, each by its inverse mass, so that momentum is kept:
//!
//! ```text
//!     start       end             truncated
//!       o                            o
//!      ---         ---              ---
//!                   o
//! ```
//!
//! This is the planar truncation of Chen et al. 2025 ("Offset geometric contact"), for pairs: it sees only how two parts
//! move against each other, so it does not slow what moves together. In a tight heap one pair may undo what another has
//! done. Parts that are left then move as one piece, by their mean motion (the impact zones of Provot 1997), and the
//! piece grows until nothing passes. A piece that holds [pins](super::pins) of different ways follows each of them.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::contact::surface::contact::Contact;
use crate::contact::surface::pins::Followers;
use crate::contact::surface::points::Points;
use crate::union_find::Groups;

/// Turns in which pairs are moved apart one by one.
const TURNS_OF_PAIRS: u32 = 10;

/// Corners of a pair that are moved apart in a turn: three in a face, two in an edge.
const LOOKS_AT_PAIR: u32 = 4;

/// The truncation of a substep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Truncation {
    /// Pieces of a surface that move as one, if there are any.
    pieces: Groups,
    has_pieces: bool,
    motions: Vec<Motion>,
    followers: Followers,
}

/// The motion of a piece in a substep: sums over its free particles, or over its pins if it has any.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    count: u32,
    has_pins: bool,
    mass: f32,
    /// Ways times masses; the mass of a pin counts as 1.
    way: Vec3,
    /// The same of what becomes velocity.
    motion: Vec3,
}

impl Motion {
    fn add(&mut self, mass: f32, way: Vec3, motion: Vec3) {
        self.mass += mass;
        self.way += way * mass;
        self.motion += motion * mass;
    }
}

impl Truncation {
    /// Begins the end of a substep: no piece moves as one.
    pub fn begin(&mut self) {
        self.has_pieces = false;
    }

    /// Moves parts back that have passed or may have. Returns the number of times that a pair was moved. If it is called
    /// again in a substep, with what its moves have brought near, pieces only grow: in the end nothing is left to move.
    pub fn truncate(&mut self, contacts: &[Contact], points: &mut Points) -> u32 {
        let mut count = 0;
        if !self.has_pieces {
            for _ in 0..TURNS_OF_PAIRS {
                let moves: u32 = contacts.iter().map(|contact| move_apart(contact, points)).sum();
                if moves == 0 {
                    return count;
                }
                count += moves;
            }
            self.pieces.reset(points.start.len());
            self.has_pieces = true;
        }
        loop {
            let mut joined = 0;
            let passes =
                |contact: &&Contact| contact.may_pass(points) && contact.gap(points).1 < contact.least_gap();
            for contact in contacts.iter().filter(passes) {
                let [first, others @ ..] = contact.pair.ids;
                joined +=
                    u32::from(others.into_iter().fold(false, |any, id| self.pieces.join(first, id) | any));
            }
            if joined == 0 {
                return count;
            }
            count += joined;
            self.carry(points);
        }
    }
}

/// Moves the corners of a pair apart; the number of moves.
fn move_apart(contact: &Contact, points: &mut Points) -> u32 {
    if !contact.may_pass(points) {
        return 0;
    }
    let least = contact.least_gap();
    for moves in 0..LOOKS_AT_PAIR {
        let (ends, gap) = contact.gap(points);
        let [low, high] = points.inverse_masses(ends);
        if gap.is_nan() || gap >= least || low + high == 0.0 {
            return moves;
        }
        // A hair more, so that rounding does not bring the pair back.
        let way = 1.01 * least - gap;
        let [a, b] = ends.map(|id| id as usize);
        // No more becomes velocity than stops the two: what moved them in position only may be undone in position only.
        let moving = (points.motion[b] - points.motion[a]).dot(contact.normal).clamp(0.0, way);
        let [moving, shift] = [moving, way - moving].map(|part| contact.normal * (part / (low + high)));
        for (id, share) in [(a, low), (b, -high)] {
            points.move_by(id, moving * share);
            points.shift_by(id, shift * share);
        }
    }
    LOOKS_AT_PAIR
}

impl Truncation {
    /// Moves each piece as one; or, where it holds pins that go different ways, has it follow them.
    fn carry(&mut self, points: &mut Points) {
        let Self { pieces, motions, followers, .. } = self;
        motions.clear();
        motions.resize(points.start.len(), Motion::default());
        for (id, &inverse_mass) in points.inverse_mass.iter().enumerate() {
            let piece = &mut motions[pieces.root(id as u32) as usize];
            let is_pin = inverse_mass == 0.0;
            if is_pin && !piece.has_pins {
                *piece = Motion { count: piece.count, has_pins: true, ..Motion::default() };
            }
            piece.count += 1;
            if is_pin == piece.has_pins {
                let mass = if is_pin { 1.0 } else { 1.0 / inverse_mass };
                piece.add(mass, points.way(id), points.motion[id]);
            }
        }
        for id in 0..points.start.len() {
            let piece = &motions[pieces.root(id as u32) as usize];
            if piece.count > 1 && points.inverse_mass[id] > 0.0 {
                points.end[id] = points.start[id] + (piece.way / piece.mass).extend(0.0);
                points.motion[id] = piece.motion / piece.mass;
            }
        }
        followers.carry(pieces, points);
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Quat, Vec4};

    use super::*;
    use crate::contact::surface::contact::contact;
    use crate::contact::surface::pair::{Kind, Pair};
    use crate::contact::surface::testing::Numbers;
    use crate::geometry::nearest_triangle::weighted;
    use crate::simd::miri::unless_miri;

    /// Free points with these starts and ends; those of `pins` are pinned.
    fn points(starts: &[Vec3], ends: &[Vec3], pins: &[usize]) -> Points {
        let mut points = Points::default();
        let places = |places: &[Vec3]| places.iter().map(|place| place.extend(0.0)).collect::<Vec<Vec4>>();
        points.start = places(starts);
        points.end = places(ends);
        points.motion = starts.iter().zip(ends).map(|(start, end)| end - start).collect();
        points.inverse_mass = (0..starts.len()).map(|id| 1.0 + id as f32).collect();
        pins.iter().for_each(|&pin| points.inverse_mass[pin] = 0.0);
        points
    }

    fn contact_of(points: &Points, kind: Kind, ids: [u32; 4]) -> Contact {
        let starts = points.starts(ids);
        let weights = kind.nearest(starts);
        let pair = Pair { ids, kind, distance: 0.01, ..Pair::default() };
        contact(pair, weights, weighted(weights, starts)).expect("apart")
    }

    /// A corner above a face, which falls through it.
    fn falling(pins: &[usize]) -> (Points, [Contact; 1]) {
        let face = [Vec3::ZERO, Vec3::X, Vec3::Z];
        let starts = [Vec3::new(0.2, 0.02, 0.3), face[0], face[1], face[2]];
        let mut ends = starts;
        ends[0].y = -0.05;
        let points = points(&starts, &ends, pins);
        let contact = contact_of(&points, Kind::CornerFace, [0, 1, 2, 3]);
        (points, [contact])
    }

    fn momentum(points: &Points) -> DVec3 {
        (0..points.start.len()).map(|id| points.way(id).as_dvec3() / f64::from(points.inverse_mass[id])).sum()
    }

    /// Places so far apart that their gap is no number are left to the check after the step: a clamp by such a gap panicked.
    #[test]
    fn what_is_too_far_apart_is_left_alone() {
        let (mut points, contacts) = falling(&[]);
        (points.end[0].x, points.end[1].x) = (3e38, -3e38);
        let before = points.end.clone();
        assert_eq!(Truncation::default().truncate(&contacts, &mut points), 0);
        assert_eq!(points.end, before);
    }

    #[test]
    fn what_would_pass_is_moved_apart_and_momentum_is_kept() {
        let (mut points, contacts) = falling(&[]);
        let before = momentum(&points);
        let mut truncation = Truncation::default();
        truncation.begin();
        assert!(truncation.truncate(&contacts, &mut points) > 0);
        assert!(contacts[0].gap(&points).1 >= contacts[0].least_gap());
        assert!(momentum(&points).distance(before) < 1e-6);
        assert_eq!(truncation.truncate(&contacts, &mut points), 0, "it is done");
    }

    #[test]
    fn pins_stay_and_what_does_not_pass_is_left_alone() {
        let (mut points, contacts) = falling(&[1, 2, 3]);
        let mut truncation = Truncation::default();
        truncation.begin();
        truncation.truncate(&contacts, &mut points);
        assert!((1..4).all(|id| points.end[id] == points.start[id]));
        assert!(points.end[0].y > 0.0, "{}", points.end[0]);

        let (mut points, contacts) = falling(&[]);
        points.end[0].y = 0.015;
        let before = points.end.clone();
        truncation.begin();
        assert_eq!(truncation.truncate(&contacts, &mut points), 0);
        assert_eq!(points.end, before);
    }

    /// Things that fly together are not slowed, at any speed.
    #[test]
    fn only_motion_against_each_other_is_cut_short() {
        let (mut still, contacts) = falling(&[]);
        let mut truncation = Truncation::default();
        truncation.begin();
        truncation.truncate(&contacts, &mut still);
        let (mut flying, contacts) = falling(&[]);
        let way = Vec3::new(3.0, -2.0, 5.0);
        flying.end.iter_mut().for_each(|end| *end += way.extend(0.0));
        truncation.begin();
        truncation.truncate(&contacts, &mut flying);
        for (still, flying) in still.end.iter().zip(&flying.end) {
            assert!(flying.truncate().distance(still.truncate() + way) < 1e-5);
        }
    }

    /// A corner between two faces that close on it: no order of pushes finds room, so all three move as one piece.
    #[test]
    fn a_heap_that_no_pushes_sort_out_moves_as_one_piece() {
        let face = |y: f32| [Vec3::new(0.0, y, 0.0), Vec3::new(1.0, y, 0.0), Vec3::new(0.0, y, 1.0)];
        let (low, high) = (face(0.0), face(0.02));
        let starts = [&[Vec3::new(0.2, 0.01, 0.3)][..], &low, &high].concat();
        let ends = [&[Vec3::new(0.2, 0.01, 0.3)][..], &face(0.2), &face(-0.2)].concat();
        let mut points = points(&starts, &ends, &[]);
        let before = momentum(&points);
        let contacts = [[0, 1, 2, 3], [0, 4, 5, 6]].map(|ids| contact_of(&points, Kind::CornerFace, ids));
        let mut truncation = Truncation::default();
        truncation.begin();
        while truncation.truncate(&contacts, &mut points) > 0 {}
        for contact in &contacts {
            assert!(contact.gap(&points).1 >= contact.least_gap());
        }
        assert!(momentum(&points).distance(before) < 1e-5);
    }

    /// A corner between two pinned faces that turn about its middle line together: with the mean way of the pins, which is none, it
    /// would stay, and a face that has turned would be on its other side.
    #[test]
    fn a_piece_does_not_tear_away_from_pins_that_turn() {
        let face = |y: f32| [Vec3::new(-1.0, y, -0.5), Vec3::new(1.0, y, -0.5), Vec3::new(0.0, y, 1.0)];
        let starts = [&[Vec3::new(0.5, 0.0, 0.0)][..], &face(-0.01), &face(0.01)].concat();
        let turn = Quat::from_rotation_z(0.1);
        let mut ends: Vec<Vec3> = starts.iter().map(|&start| turn * start).collect();
        ends[0].y = -0.02;
        let mut points = points(&starts, &ends, &[1, 2, 3, 4, 5, 6]);
        let contacts = [[0, 1, 2, 3], [0, 4, 5, 6]].map(|ids| contact_of(&points, Kind::CornerFace, ids));
        let mut truncation = Truncation::default();
        truncation.begin();
        while truncation.truncate(&contacts, &mut points) > 0 {}
        let [corner] = points.ends([0]);
        assert!(corner.distance(turn * starts[0]) < 2e-3, "{corner}");
    }

    /// Wherever the two are, near the origin or far from it.
    #[test]
    fn the_quick_look_overlooks_nothing_that_passes() {
        let mut numbers = Numbers(7);
        let (mut passing, mut passed_over) = (0, 0);
        for round in 0..unless_miri(4000, 40) {
            let place = numbers.vector() * if round % 2 == 0 { 0.1 } else { 20.0 };
            let starts = [(); 4].map(|()| place + numbers.vector() * 0.02);
            let ends = starts.map(|start| start + numbers.vector() * 0.01);
            let points = points(&starts, &ends, &[]);
            let kind = if round % 3 == 0 { Kind::EdgeEdge } else { Kind::CornerFace };
            let contact = contact_of(&points, kind, [0, 1, 2, 3]);
            let passes = contact.gap(&points).1 < contact.least_gap();
            passing += u32::from(passes);
            passed_over += u32::from(!contact.may_pass(&points));
            assert!(!passes || contact.may_pass(&points), "{starts:?} {ends:?}");
        }
        assert!(passing > 10 && passed_over > 10, "{passing} pass, {passed_over} are passed over");
    }
}
