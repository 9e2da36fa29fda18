//! Calm: a proof that no surfaces touch in a step, and a watch over what it rests on.
//!
//! When a step begins, boxes and leans of whole [leaves](super::leaves) show whether anything may touch on its way in free
//! flight. If nothing may, nothing is listed, and at the end of each substep one pass looks how far particles are off that
//! way:
//!
//! ```text
//!     start   1   2   3             all within the slack:       still calm
//!       o---- o --o---o             one beyond it:              the proof is made anew for what is left, from this substep on;
//!            (   ) (   )                                        if there is none, the list is made
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::constants::{CONTACT_MARGIN_OF_SURFACES, LEAST_FLAT_COSINE, SLACK_OF_CALM};
use crate::contact::surface::leaves::{MOST_BULGE, Turning};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::geometry::nearest_lanes::{least, most};
use crate::simd::columns::{Cell, Columns};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::Lanes3;
use crate::state::body::Body;
use crate::state::substep::Substep;

/// The calm of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Calm {
    /// Places of all particles when the step began, and the way of each in a substep of free flight, in metres.
    starts: Vec<Cell>,
    ways: Vec<Cell>,
    /// Metres that a particle may be off its way.
    slack: f32,
    turning: Turning,
    /// Substeps that are left; 0 if there is no calm.
    left: u32,
    age: u32,
}

/// Change of scaled normals that leaves a flat patch in a half-space of directions.
const MOST_TURN: f32 = LEAST_FLAT_COSINE - MOST_BULGE;

impl Calm {
    /// True if nothing can touch in this substep.
    pub fn holds(&self) -> bool {
        self.left > 0
    }

    pub fn end(&mut self) {
        self.left = 0;
    }

    /// Looks whether the rest of a step is calm, if all particles go on from the start of this substep as they have gone to the
    /// `column` that is given, and parts keep this `distance` at least (metres).
    pub fn begin(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        column: fn(&Body) -> &Columns,
        substep: Substep,
        distance: f32,
    ) {
        let left = substep.count - substep.index;
        self.slack = SLACK_OF_CALM * distance;
        let reach = Reach { factor: 1.0 + CONTACT_MARGIN_OF_SURFACES, slack: self.slack };
        self.end();
        let Some(turning) = surfaces.turning_if_apart(bodies, points, column, left, reach, substep.isa)
        else {
            return;
        };
        (self.turning, self.left, self.age) = (turning, left, 0);
        self.starts.clone_from(&points.start_cells);
        self.ways.clear();
        for (_, next, starts) in points.cells_of(bodies, column) {
            self.ways.extend(next.iter().zip(starts).map(|(next, start)| next.minus(start)));
        }
    }

    /// At the end of a substep: true if all are on their way.
    pub fn is_on_its_way(&self, points: &Points, bodies: &[Body], isa: Isa) -> bool {
        let part = (self.age + 1) as f32;
        points.cells_of(bodies, |body| &body.particles.position).all(|(cells, now, _)| {
            let (starts, ways) = (&self.starts[cells.clone()], &self.ways[cells]);
            let [low, high] = isa.run(OffWay { starts, ways, now, part });
            let off = low.abs().max(high.abs()).length();
            off <= self.slack && self.turning.of((high - low).length()) <= MOST_TURN
        })
    }

    /// Ends a substep.
    pub fn grow_older(&mut self) {
        self.left -= 1;
        self.age += 1;
    }
}

/// The box around how far particles are off their ways.
struct OffWay<'a> {
    starts: &'a [Cell],
    ways: &'a [Cell],
    now: &'a [Cell],
    part: f32,
}

impl Kernel for OffWay<'_> {
    type Output = [Vec3; 2];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [Vec3; 2] {
        let part = f32x16::splat(simd, self.part);
        let mut low = Lanes3::splat(simd, Vec3::INFINITY);
        let mut high = Lanes3::splat(simd, Vec3::NEG_INFINITY);
        for ((start, way), now) in self.starts.iter().zip(self.ways).zip(self.now) {
            let expected = Lanes3::load(simd, start).plus(Lanes3::load(simd, way).times(part));
            let off = Lanes3::load(simd, now).minus(expected);
            low = Lanes3 { x: least(low.x, off.x), y: least(low.y, off.y), z: least(low.z, off.z) };
            high = Lanes3 { x: most(high.x, off.x), y: most(high.y, off.y), z: most(high.z, off.z) };
        }
        let least_of = |axis: f32x16<S>| axis.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let most_of = |axis: f32x16<S>| axis.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        [
            Vec3::new(least_of(low.x), least_of(low.y), least_of(low.z)),
            Vec3::new(most_of(high.x), most_of(high.y), most_of(high.z)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use glam::{Quat, Vec4};

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::build::mesh::cloth::MeshClothBuilder;
    use crate::contact::surface::testing::{DISTANCE, Numbers, THICKNESS, bodies, flying, touching};
    use crate::simd::miri::unless_miri;
    use crate::state::settings::{BodySettings, SelfContact};

    const SUBSTEPS: u32 = 4;

    struct Proved {
        bodies: Vec<Body>,
        points: Points,
        surfaces: PlacedSurfaces,
        calm: Calm,
    }

    /// Bodies after one substep of flight, and the calm of what is left.
    fn proved(mut bodies: Vec<Body>, points: Points) -> Proved {
        let origin = bodies[0].particles.origin;
        for (place, body) in bodies.iter_mut().enumerate() {
            let shift = body.particles.origin - origin;
            body.context.integrated = body.particles.position.clone();
            for slot in 0..body.particles.inverse_mass.len() {
                let flight = points.flight[points.first[place] as usize + slot].truncate();
                body.context.integrated.set(slot, flight - shift);
            }
        }
        let mut surfaces = PlacedSurfaces::default();
        surfaces.fit(&bodies, &points);
        surfaces.look_at_all();
        let mut calm = Calm::default();
        let substep = Substep { count: SUBSTEPS, ..Substep::default() };
        calm.begin(&mut surfaces, &points, &bodies, |body| &body.context.integrated, substep, DISTANCE);
        Proved { bodies, points, surfaces, calm }
    }

    #[test]
    fn nothing_touches_within_the_slack_of_its_way_in_a_calm() {
        let mut calms = 0;
        let seeds = unless_miri(1500, 2);
        for seed in 0..seeds {
            let mut numbers = Numbers(seed);
            let bodies = bodies(&mut numbers, 0.09, 2e-4);
            let points = flying(&bodies, &mut numbers, 0.05, 2e-4);
            let Proved { points, surfaces, calm, .. } = proved(bodies, points);
            if !calm.holds() {
                continue;
            }
            calms += 1;
            let slack = 0.99 * SLACK_OF_CALM * DISTANCE;
            for substep in 0..=SUBSTEPS {
                let part = substep as f32;
                let places: Vec<Vec4> = points
                    .start
                    .iter()
                    .zip(&points.flight)
                    .map(|(&start, &flight)| {
                        let off = numbers.vector().normalize_or_zero() * slack;
                        start + (flight - start) * part + off.extend(0.0)
                    })
                    .collect();
                let found = touching(&surfaces, &points, &places);
                assert!(found.is_empty(), "seed {seed}, substep {substep}: {:?}", found[0]);
            }
        }
        assert!(unless_miri((50..1000).contains(&calms), true), "{calms} of {seeds} are calm");
    }

    fn settings() -> BodySettings {
        BodySettings { thickness: THICKNESS, self_contact: SelfContact::On, ..BodySettings::default() }
    }

    /// A body that turns and flies off, with its particles at these places, and the calm of its step.
    fn placed(mut body: Body, place: impl Fn(Vec3) -> Vec3) -> Proved {
        body.particles.arrange(&body.topology.layout);
        for i in 0..body.particles.len() {
            body.particles.set_position(i, place(body.topology.rest[i]));
        }
        let bodies = vec![body];
        let mut points = Points::default();
        points.begin_substep(&bodies);
        points.read_starts(&bodies);
        let turn = Quat::from_rotation_y(0.03);
        let flight = |start: &Vec4| (turn * start.truncate() + Vec3::X).extend(0.0);
        points.flight = points.start.iter().map(flight).collect();
        points.end = points.flight.clone();
        proved(bodies, points)
    }

    /// A strip of 0.6 m with 61 x 11 particles that lies like this: `place` gets the distance along it in metres.
    fn strip(place: impl Fn(f32) -> [f32; 2]) -> Proved {
        let strip = ClothBuilder::new(0.6, 0.1, 61, 11).build(settings()).expect("valid");
        placed(strip, |rest| {
            let [x, z] = place(rest.x);
            Vec3::new(x, rest.y, z)
        })
    }

    /// An arc of this angle in radians.
    fn bent(angle: f32) -> Proved {
        let radius = 0.6 / angle;
        strip(|along| {
            let (sin, cos) = (libm::sinf(along / radius), libm::cosf(along / radius));
            [radius * sin, radius * (1.0 - cos)]
        })
    }

    #[test]
    fn a_sheet_is_calm_until_its_parts_come_near_each_other() {
        assert!(bent(1e-3).calm.holds(), "it is flat");
        assert!(bent(1.5).calm.holds(), "it is curved");
        // The ends of the ring are 1 cm apart.
        assert!(!bent(6.2).calm.holds(), "its ends are near each other");
        assert!(!bent(30.0).calm.holds(), "it is rolled up");
    }

    /// What is near itself along the sheet, too: leaves are 4 cm wide.
    #[test]
    fn a_narrow_fold_is_not_calm() {
        let hem = |along: f32| if along < 0.56 { [along, 0.0] } else { [1.12 - along, 0.012] };
        assert!(!strip(hem).calm.holds(), "the last 4 cm lie on the rest");
        let pleat = |along: f32| match along {
            ..0.28 => [along, 0.0],
            0.28..0.32 => [0.56 - along, 0.012],
            _ => [along - 0.08, 0.024],
        };
        assert!(
            !strip(pleat).calm.holds(),
            "what lies above the pleat looks the same way as what lies below"
        );
    }

    /// Two pieces of one mesh, small enough for one leaf, lie flat above each other.
    #[test]
    fn pieces_that_do_not_hang_together_are_not_flat() {
        let place =
            |i: u32| Vec3::new((i % 4) as f32 * 0.05, 0.015 * (i / 8) as f32, (i / 4 % 2) as f32 * 0.05);
        let squares = [0, 1, 2, 8, 9, 10].map(|i| [[i, i + 4, i + 1], [i + 1, i + 4, i + 5]]);
        let mesh = MeshClothBuilder::new((0..16).map(place).collect(), squares.concat());
        assert!(!placed(mesh.build(settings()).expect("valid"), |rest| rest).calm.holds());
    }

    /// A calm ends where a particle leaves its way by more than the slack, or a face turns, but not where all go on.
    #[test]
    fn a_calm_ends_when_something_leaves_its_way() {
        let is_calm = |slots: Range<usize>, off: Vec3| {
            let Proved { mut bodies, points, calm, .. } = bent(1e-3);
            let body = &mut bodies[0];
            body.particles.position = body.context.integrated.clone();
            slots.for_each(|slot| body.particles.position.add(slot, off));
            calm.is_on_its_way(&points, &bodies, Isa::default())
        };
        let all = || 0..bent(1e-3).points.len();
        assert!(is_calm(all(), Vec3::ZERO));
        assert!(is_calm(17..18, Vec3::Z * 5e-4));
        assert!(!is_calm(17..18, Vec3::Z * 4e-3), "faces of 1 cm turn by more than 20 degrees");
        let slack = Vec3::Y * SLACK_OF_CALM * DISTANCE;
        assert!(is_calm(all(), 0.9 * slack), "no face turns");
        assert!(!is_calm(all(), 1.1 * slack));
    }
}
