//! Calm: a proof that no surfaces touch in a step, and a watch over what it rests on.
//!
//! Before a step, boxes around the [blocks](super::blocks) of grids, or else around whole [leaves](super::leaves), show whether
//! anything may touch on an even way. If nothing may, nothing is listed, and a [watch](crate::state::watch) notes how far
//! particles are off that way at the end of each substep. A whole step is tried in sweeps, and taken back if something has left
//! its way. Substep by substep:
//!
//! ```text
//!     start   1   2   3             all within the slack:       still calm
//!       o---- o --o---o             one beyond it:              the proof is made anew for what is left, from this substep on;
//!            (   ) (   )                                        if there is none, the list is made
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3A;

use crate::broad_phase::swept_box::SweptBox;
use crate::constants::{CONTACT_MARGIN_OF_SURFACES, LEAST_FLAT_COSINE, SLACK_OF_CALM};
use crate::contact::surface::blocks::{Blocks, FlyingGrid, KeepApart, StillKeepApart};
use crate::contact::surface::deviation::Deviation;
use crate::contact::surface::leaves::{MOST_BULGE, Turning};
use crate::contact::surface::placed::PlacedSurfaces;
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::simd::isa::Isa;
use crate::state::body::Body;

/// The calm of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Calm {
    /// Metres that a particle may be off its way.
    slack: f32,
    /// Bounds on turns of faces that are not in blocks; none if all are.
    turning: Option<Turning>,
    /// Substeps that are left; 0 if there is no calm.
    left: u32,
    /// Those of each body.
    blocks: Vec<Blocks>,
    /// Boxes around whole bodies, each with its place.
    wholes: Vec<(usize, SweptBox)>,
}

/// Change of scaled normals that leaves a flat patch in a half-space of directions.
const MOST_TURN: f32 = LEAST_FLAT_COSINE - MOST_BULGE;

impl Calm {
    /// True if nothing can touch in this substep.
    pub fn holds(&self) -> bool {
        self.left > 0
    }

    /// True if nothing can touch in so many substeps.
    pub fn holds_for(&self, substeps: u32) -> bool {
        self.left >= substeps
    }

    pub fn end(&mut self) {
        self.left = 0;
    }

    /// Ends a substep.
    pub fn grow_older(&mut self) {
        self.left -= 1;
    }

    /// Looks whether some `substeps` are calm, or else half of them, or a quarter, if all particles go the ways that their watches
    /// know, and parts keep this `distance` at least (metres). If they are, the watches begin.
    pub fn begin(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &mut [Body],
        substeps: u32,
        distance: f32,
        isa: Isa,
    ) {
        self.slack = SLACK_OF_CALM * distance;
        let mut tried = [substeps, substeps.div_ceil(2), substeps.div_ceil(4)].into_iter();
        let calm = tried.find(|&substeps| self.keep_apart(surfaces, points, bodies, substeps, isa));
        self.left = calm.unwrap_or(0);
        if self.holds() {
            for body in bodies.iter_mut().filter(|body| body.has_self_contact()) {
                body.context.watch.begin(&body.topology.layout);
            }
        }
    }

    /// True if no parts can touch: by blocks, or by leaves where there are none or bodies come near each other.
    fn keep_apart(
        &mut self,
        surfaces: &mut PlacedSurfaces,
        points: &Points,
        bodies: &[Body],
        substeps: u32,
        isa: Isa,
    ) -> bool {
        let reach = Reach { factor: 1.0 + CONTACT_MARGIN_OF_SURFACES, slack: self.slack };
        self.turning = None;
        self.wholes.clear();
        self.blocks.resize_with(bodies.len(), Blocks::default);
        let mut are_blocks = true;
        for (place, body) in bodies.iter().enumerate().filter(|(_, body)| body.has_self_contact()) {
            let Body { particles, topology, settings, context, .. } = body;
            let growth = [settings.thickness * reach.factor, reach.slack];
            let columns = [&*context.watch.starts, &*context.watch.ways];
            let Some(grid) = FlyingGrid::new(topology, columns, substeps, growth) else {
                are_blocks = false;
                continue;
            };
            let blocks = &mut self.blocks[place];
            let Some(mut whole) = isa.run(KeepApart { grid, blocks }) else { return false };
            let shift = Vec3A::from(particles.origin - bodies[0].particles.origin);
            (whole.low, whole.high) = (whole.low + shift, whole.high + shift);
            let is_far = |&(other, of_other): &(usize, SweptBox)| {
                !(body.layers.interact(bodies[other].layers) && whole.meets(&of_other))
            };
            are_blocks &= self.wholes.iter().all(is_far);
            self.wholes.push((place, whole));
        }
        if !are_blocks {
            surfaces.fit(bodies, points);
            self.turning = surfaces.turning_if_apart(bodies, substeps, reach, isa);
        }
        are_blocks || self.turning.is_some()
    }

    /// At the end of a substep: true if all have been on their way.
    pub fn is_on_its_way(&mut self, bodies: &[Body], isa: Isa) -> bool {
        let all = bodies.iter().zip(&mut self.blocks).filter(|(body, _)| body.has_self_contact());
        all.into_iter().all(|(body, blocks)| {
            let off = &*body.context.watch.off;
            let [most, widest] = isa.run(Deviation(off));
            match self.turning {
                Some(turning) => most <= self.slack && turning.of(widest) <= MOST_TURN,
                None => most <= blocks.slack() && isa.run(StillKeepApart { blocks, off }),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use fearless_simd::Simd;
    use glam::{Quat, Vec3, Vec4};

    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::build::mesh::cloth::MeshClothBuilder;
    use crate::contact::surface::testing::{DISTANCE, Numbers, THICKNESS, bodies, flying, touching};
    use crate::simd::columns::Cell;
    use crate::simd::isa::Kernel;
    use crate::simd::miri::unless_miri;
    use crate::state::settings::{BodySettings, SelfContact};
    use crate::state::watch::WatchRows;

    const SUBSTEPS: u32 = 4;

    /// Notes the end of the first substep.
    struct Note<'a> {
        rows: WatchRows<'a>,
        position: &'a [Cell],
        strips: Range<usize>,
        cells_of_strip: usize,
    }

    impl Kernel for Note<'_> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let Self { mut rows, position, strips, cells_of_strip } = self;
            rows.note(simd, position, strips, cells_of_strip, 0);
        }
    }

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
        points.prepare_watches(&mut bodies, |body| &body.context.integrated, 0);
        calm.begin(&mut surfaces, &points, &mut bodies, SUBSTEPS, DISTANCE, Isa::default());
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
            for substep in 0..=calm.left {
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

    /// Strips that bend to and fro: where one is calm, columns that lie farther apart in it than they keep do not touch.
    #[test]
    fn no_calm_strip_touches_itself() {
        let mut calms = 0;
        let seeds = unless_miri(400, 1);
        for seed in 0..seeds {
            let mut numbers = Numbers(seed);
            let [bend, wave, phase] = [(); 3].map(|()| numbers.next());
            let length = 0.6 / 60.0;
            let (mut at, mut angle, mut curve) = ([0.0_f32; 2], 0.0_f32, Vec::new());
            for column in 0..61 {
                curve.push(at);
                let turn = 0.3 * bend + 0.6 * wave * libm::sinf(0.25 * column as f32 + 3.0 * phase);
                angle += turn;
                at = [at[0] + length * libm::cosf(angle), at[1] + length * libm::sinf(angle)];
            }
            let Proved { calm, .. } = strip(|along| curve[(along / length).round() as usize]);
            if !calm.holds() {
                continue;
            }
            calms += 1;
            let distance = |a: [f32; 2], b: [f32; 2]| glam::Vec2::from(a).distance(b.into());
            for (i, j) in (0..61).flat_map(|j| (0..j).map(move |i| (i, j))) {
                let is_far = (j - i) as f32 * length > 4.0 * DISTANCE;
                assert!(!is_far || distance(curve[i], curve[j]) > DISTANCE, "seed {seed}: {i} and {j}");
            }
        }
        assert!(unless_miri((30..300).contains(&calms), true), "{calms} of {seeds} are calm");
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
            let Proved { mut bodies, mut calm, .. } = bent(1e-3);
            let Body { particles, topology, context, .. } = &mut bodies[0];
            let position = &mut particles.position;
            position.clone_from(&context.integrated);
            slots.for_each(|slot| position.add(slot, off));
            let (cells_of_strip, strips) = topology.layout.strips();
            let (rows, position) = (context.watch.rows(), &*position.cells);
            Isa::default().run(Note { rows, position, strips: 0..strips, cells_of_strip });
            calm.is_on_its_way(&bodies, Isa::default())
        };
        let all = || 0..bent(1e-3).points.len();
        assert!(is_calm(all(), Vec3::ZERO));
        assert!(is_calm(17..18, Vec3::Z * 5e-4));
        let aside = Vec3::new(6.9e-3, 6.9e-3, 0.0);
        assert!(!is_calm(17..18, aside), "a face of 1 cm may turn over");
        let slack = Vec3::Y * SLACK_OF_CALM * DISTANCE;
        assert!(is_calm(all(), 0.9 * slack), "no face turns");
        assert!(!is_calm(all(), 1.1 * slack));
    }
}
