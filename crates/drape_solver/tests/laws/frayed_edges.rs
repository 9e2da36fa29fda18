//! Frayed edges: torn cloth is drawn along rough lines, on which both sides agree.

use std::collections::BTreeMap;
use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::{
    BodySettings, ClothBuilder, Environment, FacePoint, FrayedEdges, Island, TearLimits, Topology, TornPast,
    step,
};

use crate::common::swept;
use crate::drawn::place;

/// Particles along a side of a sheet of 1 m x 1 m.
const SIDE: u32 = 33;
const SPACING: f32 = 1.0 / 32.0;

/// A sheet that was pulled apart across a line through its middle at an angle in radians, and its pieces.
struct TornSheet {
    whole: Arc<Topology>,
    edges: Vec<[u32; 2]>,
    pieces: Vec<(Arc<Topology>, Vec<u32>)>,
}

impl TornSheet {
    fn new(angle: f32) -> Self {
        let pull = Vec3::new(-angle.sin(), angle.cos(), 0.0);
        let sheet = ClothBuilder::new(1.0, 1.0, SIDE, SIDE)
            .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_where(|_, _, place| place.dot(pull).abs() > 0.3);
        let settings = BodySettings { tethers: false, ..swept() };
        let mut island = Island::of_body(sheet.build(settings).expect("valid"));
        let whole = Arc::clone(&island.bodies[0].topology);
        let mut all: Vec<Vec<u32>> = vec![(0..SIDE * SIDE).collect()];
        let mut edges = Vec::new();
        let limits = TearLimits { strain: 0.3, most: 4 };
        for _ in 0..250 {
            for body in &mut island.bodies {
                let particles = &mut body.particles;
                for i in (0..particles.len()).filter(|&i| particles.is_pinned(i)).collect::<Vec<_>>() {
                    let place = particles.position(i);
                    particles.set_pin_target(i, place + pull * (0.001 * place.dot(pull).signum()));
                }
            }
            let environment = Environment { gravity: Vec3::ZERO, ..Environment::default() };
            step(&mut island, &environment).expect("a good step");
            for place in 0..island.bodies.len() {
                let Some(torn) = island.bodies[place].tear(&limits).expect("can tear") else { continue };
                let was = all[place].clone();
                let origins = |of: &[u32]| of.iter().map(|&origin| was[origin as usize]).collect();
                for edge in torn.edges {
                    let [a, b] = edge.map(|end| was[end as usize]);
                    if !edges.contains(&[a.min(b), a.max(b)]) {
                        edges.push([a.min(b), a.max(b)]);
                    }
                }
                all[place] = origins(&torn.origins);
                all.extend(torn.pieces.iter().map(|piece| origins(&piece.origins)));
                island.bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
            }
        }
        let topologies = island.bodies.into_iter().map(|body| body.topology);
        Self { whole, edges, pieces: topologies.zip(all).collect() }
    }

    fn frayed(&self, (topology, origins): &(Arc<Topology>, Vec<u32>), seed: u64) -> FrayedEdges {
        let past = TornPast { whole: &self.whole, origins, edges: &self.edges, seed };
        FrayedEdges::new(topology, &past, |_| true)
    }

    /// The triangles at rest that are drawn of all pieces.
    fn drawn(&self, seed: u64) -> Vec<[Corner; 3]> {
        let mut triangles = Vec::new();
        for (number, piece) in self.pieces.iter().enumerate() {
            let (topology, frayed) = (&piece.0, self.frayed(piece, seed));
            let rest = |particle: u32| topology.rest_position(particle as usize);
            let at = |point: &FacePoint| place_of(topology, point);
            for &[a, b, c] in topology.faces() {
                let mut outline = Vec::new();
                for [p, q] in [[a, b], [b, c], [c, a]] {
                    let own = frayed.particles.get(&p).map_or(rest(p), at);
                    outline.push(Corner { of: (number, [p, p]), place: own });
                    let edge = [p.min(q), p.max(q)];
                    let between = frayed.edges.get(&edge).map(at);
                    outline.extend(between.map(|place| Corner { of: (number, edge), place }));
                }
                // From a vertex on an edge, so that none is flat.
                let start = outline.iter().position(|corner| corner.of.1[0] != corner.of.1[1]).unwrap_or(0);
                outline.rotate_left(start);
                triangles
                    .extend((2..outline.len()).map(|last| [outline[0], outline[last - 1], outline[last]]));
            }
        }
        triangles
    }
}

/// The place of a point of a face at rest.
fn place_of(topology: &Topology, &FacePoint { face, weights }: &FacePoint) -> Vec3 {
    place(topology.faces()[face as usize], weights, |i| topology.rest_position(i)).as_vec3()
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct Corner {
    /// The piece, and its particle, twice, or the edge on which it lies.
    of: (usize, [u32; 2]),
    place: Vec3,
}

fn area([a, b, c]: [Corner; 3]) -> f32 {
    0.5 * (b.place - a.place).cross(c.place - a.place).z
}

/// The edges of the sheet inside its hem that bound one triangle only.
fn torn_edges(triangles: &[[Corner; 3]]) -> Vec<[Vec3; 2]> {
    let mut edges: BTreeMap<[(usize, [u32; 2]); 2], Vec<[Vec3; 2]>> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            edges.entry([p.of.min(q.of), p.of.max(q.of)]).or_default().push([p.place, q.place]);
        }
    }
    let is_hem = |place: Vec3| (place.x.abs() - 0.5).abs() < 1e-6 || (place.y.abs() - 0.5).abs() < 1e-6;
    let single = edges.into_values().filter(|same| same.len() == 1).flatten();
    single.filter(|ends| !ends.iter().all(|&end| is_hem(end))).collect()
}

/// Threads at several angles to the pull, so that tears run straight, in steps, and into each other.
const ANGLES: [f32; 7] = [0.0, 0.3, 0.6, 0.785, 1.1, -0.5, 0.45];

/// Both sides of a tear are drawn along the same line, so that nothing is lost and no gap shows before it opens.
#[test]
fn torn_sheets_are_drawn_with_all_of_their_area_and_no_face_turned_over() {
    for angle in ANGLES {
        let sheet = TornSheet::new(angle);
        assert!(sheet.edges.len() > 40, "only {} edges tore", sheet.edges.len());
        for seed in 0..40 {
            let drawn = sheet.drawn(seed);
            let areas = || drawn.iter().map(|&triangle| area(triangle));
            let least = areas().fold(f32::INFINITY, f32::min) / (0.5 * SPACING * SPACING);
            assert!(least > 1e-3, "a triangle of {least} of a face at {angle} with seed {seed}");
            assert!((areas().sum::<f32>() - 1.0).abs() < 1e-5, "{} m2", areas().sum::<f32>());
            let sides = torn_edges(&drawn);
            assert_eq!(sides.len(), 4 * sheet.edges.len(), "two stretches of each edge, on two sides");
            let off = |p: [Vec3; 2], q: [Vec3; 2]| p[0].distance(q[1]).max(p[1].distance(q[0]));
            for &side in &sides {
                let apart = sides.iter().map(|&other| off(side, other)).fold(f32::INFINITY, f32::min);
                assert!(apart < 1e-6, "no other side within {apart} m of {side:?}");
            }
        }
    }
}

/// The ends of torn edges inside the sheet, with the places at which they are drawn and the other ends of those edges, at rest.
fn moved(sheet: &TornSheet, seed: u64) -> BTreeMap<u32, (Vec3, Vec<u32>)> {
    let mut moved = BTreeMap::new();
    for piece in &sheet.pieces {
        for (particle, point) in sheet.frayed(piece, seed).particles {
            let place = place_of(&piece.0, &point);
            let origin = piece.1[particle as usize];
            let others = sheet.edges.iter().filter(|edge| edge.contains(&origin));
            let others = others.map(|&[a, b]| if a == origin { b } else { a }).collect();
            moved.insert(origin, (place, others));
        }
    }
    moved
}

/// The corner at which a tear changes from one thread to another is drawn inside the step; along a thread the edge is rough, by less
/// than half of the spacing. The way it goes depends on the seed alone. The hem of the sheet stays.
#[test]
fn torn_edges_are_rough_and_their_steps_are_slopes() {
    let (mut steps, mut offsets) = (0, Vec::new());
    for angle in ANGLES {
        let sheet = TornSheet::new(angle);
        let rest = |particle: u32| sheet.whole.rest_position(particle as usize);
        let all = moved(&sheet, 7);
        assert_eq!(all, moved(&sheet, 7));
        let others = moved(&sheet, 8);
        for piece in &sheet.pieces {
            for ([p, q], point) in sheet.frayed(piece, 7).edges {
                let rest = |particle: u32| piece.0.rest_position(particle as usize);
                let off = (place_of(&piece.0, &point) - rest(p)).reject_from(rest(q) - rest(p)).length();
                assert!(off < 0.5 * SPACING, "{off} m beside an edge");
            }
        }
        assert!(all.keys().eq(others.keys()));
        for ((&particle, (place, ends)), (other, _)) in all.iter().zip(others.values()) {
            let at = rest(particle);
            assert!(at.x.abs().max(at.y.abs()) < 0.5 - 0.5 * SPACING, "{at} lies on the hem");
            assert!(place != other, "the same place for two seeds: {place}");
            assert!(place.distance(at) < 0.33 * SPACING, "{} m off", place.distance(at));
            if let [before, behind] = ends[..] {
                let inside = rest(before).midpoint(rest(behind)) - at;
                if inside.length() > 0.1 * SPACING {
                    steps += 1;
                    assert!((*place - at).dot(inside) > 0.0, "{at} is drawn outside of its step at {place}");
                } else {
                    let along = (rest(behind) - rest(before)).normalize();
                    offsets.push((*place - at).reject_from(along).length() / SPACING);
                }
            }
        }
    }
    assert!(steps > 20, "{steps}");
    let rms = (offsets.iter().map(|off| off * off).sum::<f32>() / offsets.len() as f32).sqrt();
    println!("law: torn threads are drawn with a roughness of {rms} of the spacing; {steps} steps");
    assert!((0.08..0.3).contains(&rms), "{rms}");
}
