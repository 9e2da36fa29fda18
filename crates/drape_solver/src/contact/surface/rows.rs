//! Stars as rows of numbers, from which sixteen pairs at a time are tested.
//!
//! Places of the centre are absolute, those of all other corners relative to the centre, at the start and at the end.
//!
//! Design: `docs/design/self_contact.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x4, f32x16, mask32x16, prelude::*};
use glam::{Vec3, Vec4};

use crate::broad_phase::surface_pairs::{Lean, PlacedTree, StarBoxes};
use crate::broad_phase::swept_box::SweptBoxes;
use crate::contact::surface::reach::Reach;
use crate::geometry::nearest_lanes::{TriangleLanes, inverse, least, most};
use crate::simd::columns::LANES;
use crate::simd::isa::Kernel;
use crate::simd::lanes::{Lanes3, load};
use crate::simd::transpose::transpose;
use crate::state::star::{EDGES, FACES, Star};

/// The columns of a row: of the centre, of the edges, of the faces.
pub(crate) const CENTRE: [usize; 2] = [0, 3];
/// Half the distance to keep, in metres.
pub(crate) const THICKNESS: usize = 6;
/// 1 if the centre is tested against faces, else 0.
pub(crate) const HAS_CENTRE: usize = 7;
/// Sharpness of each edge, from 0 to 1; negative where there is no edge.
pub(crate) const SHARPNESS: usize = 8;
/// One over the squared length of each edge.
pub(crate) const EDGE_SCALE: usize = 11;
pub(crate) const EDGE: [usize; 2] = [14, 23];
pub(crate) const FACE: [usize; 2] = [32, 44];
/// For each face, one over the squared lengths of its sides from the centre, of the third side, and over the
/// determinant of the first two; the last is negative where there is no face.
pub(crate) const FACE_SCALE: usize = 56;
pub(crate) const COLUMNS: usize = 64;

/// The blocks of [`LANES`] columns in which the centre stands, and centre and edges, and the faces.
pub(crate) const CENTRES: Range<usize> = 0..1;
pub(crate) const EDGES_TOO: Range<usize> = 0..2;
pub(crate) const FACES_ONLY: Range<usize> = 2..4;

/// The columns of sixteen stars.
pub(crate) type Columns = [[f32; LANES]; COLUMNS];

/// The numbers of a star.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Row(pub [[f32; LANES]; COLUMNS / LANES]);

impl Row {
    pub const NOTHING: Self = Self([[0.0; LANES]; COLUMNS / LANES]);
}

/// Reads three columns.
#[inline(always)]
pub(crate) fn vector<S: Simd>(simd: S, columns: &[[f32; LANES]], at: usize) -> Lanes3<S> {
    Lanes3 { x: load(simd, &columns[at]), y: load(simd, &columns[at + 1]), z: load(simd, &columns[at + 2]) }
}

/// Some blocks of the columns of the rows on one `side` of up to sixteen pairs; of the first pair where there are fewer.
#[inline(always)]
pub(crate) fn gather<S: Simd>(
    simd: S,
    rows: &[Row],
    pairs: &[[u32; 2]],
    side: usize,
    blocks: Range<usize>,
    columns: &mut Columns,
) {
    let mut places = [pairs[0][side] as usize; LANES];
    places.iter_mut().zip(pairs).for_each(|(place, pair)| *place = pair[side] as usize);
    for block in blocks {
        transpose(
            #[inline(always)]
            |row| load(simd, &rows[places[row]].0[block]),
            #[inline(always)]
            |column, vector| columns[block * LANES + column] = vector.to_array(),
        );
    }
}

/// The places of four points, one after another.
#[inline(always)]
pub(crate) fn four_places<S: Simd>(simd: S, places: &[Vec4], [a, b, c, d]: [u32; 4]) -> f32x16<S> {
    let [a, b, c, d] = [
        f32x4::load_array_ref(simd, places[a as usize].as_ref()),
        f32x4::load_array_ref(simd, places[b as usize].as_ref()),
        f32x4::load_array_ref(simd, places[c as usize].as_ref()),
        f32x4::load_array_ref(simd, places[d as usize].as_ref()),
    ];
    a.combine(b).combine(c.combine(d))
}

/// The stars of one body, where they are at both ends of their ways.
#[derive(Clone, Copy)]
pub(crate) struct FlyingStars<'a> {
    /// The body's stars, with the numbers of their particles in the island; and the first of these.
    pub stars: &'a [Star],
    pub first: u32,
    /// Sharpness of each star's edges.
    pub sharpness: &'a [[f32; EDGES]],
    /// Places of the island's particles at both ends of their ways.
    pub places: [&'a [Vec4]; 2],
    pub thickness: f32,
}

impl FlyingStars<'_> {
    /// The stars of a leaf.
    fn leaf(&self, leaf: usize) -> &[Star] {
        &self.stars[leaf * LANES..(leaf + 1) * LANES]
    }

    /// Writes the columns of a leaf's stars.
    #[inline(always)]
    fn put<S: Simd>(&self, simd: S, leaf: usize, columns: &mut Columns) {
        let stars = self.leaf(leaf);
        for time in 0..2 {
            let mut points = [[0.0; LANES]; LANES];
            transpose(
                #[inline(always)]
                |lane| {
                    let Star { centre, ends: [a, b, c], .. } = stars[lane];
                    four_places(simd, self.places[time], [centre, a, b, c])
                },
                #[inline(always)]
                |column, vector| points[column] = vector.to_array(),
            );
            let centre = vector(simd, &points, 0);
            put(columns, CENTRE[time], centre);
            for k in 0..EDGES {
                put(columns, EDGE[time] + 3 * k, vector(simd, &points, 4 * (k + 1)).minus(centre));
            }
            transpose(
                #[inline(always)]
                |lane| {
                    let [[a, b], [c, d]] = stars[lane].faces;
                    four_places(simd, self.places[time], [a, b, c, d])
                },
                #[inline(always)]
                |column, vector| points[column] = vector.to_array(),
            );
            for k in 0..2 * FACES {
                put(columns, FACE[time] + 3 * k, vector(simd, &points, 4 * k).minus(centre));
            }
        }
        let sharpness = &self.sharpness[leaf * LANES..(leaf + 1) * LANES];
        for (lane, (star, sharpness)) in stars.iter().zip(sharpness).enumerate() {
            for k in 0..EDGES {
                let is_there = k < star.edge_count as usize;
                columns[SHARPNESS + k][lane] = if is_there { sharpness[k] } else { -1.0 };
            }
            for k in 0..FACES {
                columns[FACE_SCALE + 4 * k + 3][lane] = if k < star.face_count as usize { 1.0 } else { -1.0 };
            }
            columns[HAS_CENTRE][lane] = f32::from(u8::from(star.has_centre));
        }
        columns[THICKNESS] = [self.thickness; LANES];
    }
}

/// Writes the boxes of one body's stars, and how their faces lean.
pub(crate) struct PlaceBoxes<'a> {
    pub stars: FlyingStars<'a>,
    pub reach: Reach,
    /// The part of the way at which normals are looked at, besides both ends.
    pub between: f32,
    pub has_faces: bool,
    /// For each star, the least height of its faces at both ends of the way, or the length of its links.
    pub heights: &'a mut [f32],
    pub tree: &'a mut PlacedTree,
}

impl Kernel for PlaceBoxes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { stars, reach, between, has_faces, heights, tree } = self;
        let mut columns: Columns = [[0.0; LANES]; COLUMNS];
        for (leaf, heights) in heights.chunks_exact_mut(LANES).enumerate() {
            stars.put(simd, leaf, &mut columns);
            put_boxes(simd, &columns, reach, &mut tree.stars[leaf]);
            heights.copy_from_slice(&least_heights(simd, &columns, has_faces).to_array());
            if has_faces {
                lean(simd, &columns, stars.leaf(leaf), stars.first, between, &mut tree.leans);
            } else {
                lean_links(&columns, stars.leaf(leaf), stars.first, &mut tree.leans);
            }
        }
    }
}

/// Writes the rows of some leaves of one body.
pub(crate) struct PlaceRows<'a> {
    pub stars: FlyingStars<'a>,
    /// True for each leaf of the body whose rows are written.
    pub is_needed: &'a [bool],
    pub rows: &'a mut [Row],
}

impl Kernel for PlaceRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { stars, is_needed, rows } = self;
        let mut columns: Columns = [[0.0; LANES]; COLUMNS];
        for leaf in (0..is_needed.len()).filter(|&leaf| is_needed[leaf]) {
            stars.put(simd, leaf, &mut columns);
            scale(simd, &mut columns);
            let rows = &mut rows[leaf * LANES..(leaf + 1) * LANES];
            for block in 0..COLUMNS / LANES {
                transpose(
                    #[inline(always)]
                    |column| load(simd, &columns[block * LANES + column]),
                    #[inline(always)]
                    |row, vector| rows[row].0[block] = vector.to_array(),
                );
            }
        }
    }
}

#[inline(always)]
fn put<S: Simd>(columns: &mut Columns, at: usize, v: Lanes3<S>) {
    columns[at] = v.x.to_array();
    columns[at + 1] = v.y.to_array();
    columns[at + 2] = v.z.to_array();
}

/// Works out the scales of edges and faces.
#[inline(always)]
fn scale<S: Simd>(simd: S, columns: &mut Columns) {
    for k in 0..EDGES {
        let edge = vector(simd, columns, EDGE[0] + 3 * k);
        columns[EDGE_SCALE + k] = inverse(simd, edge.dot(edge)).to_array();
    }
    for k in 0..FACES {
        let face = TriangleLanes::new(simd, sides(simd, columns, k, 0));
        let at = FACE_SCALE + 4 * k;
        let is_there = load(simd, &columns[at + 3]).simd_gt(f32x16::splat(simd, 0.0));
        let [first, second, third, area] = face.inverses;
        columns[at] = first.to_array();
        columns[at + 1] = second.to_array();
        columns[at + 2] = third.to_array();
        columns[at + 3] = is_there.select(area, f32x16::splat(simd, -1.0)).to_array();
    }
}

/// The two sides of each star's face `k` from its centre, at this end of its way.
#[inline(always)]
fn sides<S: Simd>(simd: S, columns: &Columns, k: usize, end: usize) -> [Lanes3<S>; 2] {
    let at = FACE[end] + 6 * k;
    [vector(simd, columns, at), vector(simd, columns, at + 3)]
}

/// The least height of each star's faces at both ends of the way, or the length of its links, in metres; infinity if it has none.
#[inline(always)]
fn least_heights<S: Simd>(simd: S, columns: &Columns, has_faces: bool) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let mut lowest = f32x16::splat(simd, f32::INFINITY);
    if has_faces {
        for k in 0..FACES {
            let is_there = load(simd, &columns[FACE_SCALE + 4 * k + 3]).simd_gt(zero);
            for end in 0..2 {
                let [u, v] = sides(simd, columns, k, end);
                let (third, normal) = (v.minus(u), u.cross(v));
                let longest = most(u.dot(u), most(v.dot(v), third.dot(third)));
                let height = normal.dot(normal) * inverse(simd, longest);
                lowest = is_there.select(least(lowest, height), lowest);
            }
        }
    } else {
        for k in 0..EDGES {
            let is_there = load(simd, &columns[SHARPNESS + k]).simd_ge(zero);
            for at in EDGE {
                let link = vector(simd, columns, at + 3 * k);
                lowest = is_there.select(least(lowest, link.dot(link)), lowest);
            }
        }
    }
    lowest.sqrt()
}

/// Boxes around the parts of sixteen stars, and around their ways.
#[inline(always)]
fn put_boxes<S: Simd>(simd: S, columns: &Columns, reach: Reach, boxes: &mut StarBoxes) {
    let zero = f32x16::splat(simd, 0.0);
    let thickness = load(simd, &columns[THICKNESS]);
    let [s, t] = [load(simd, &columns[SHARPNESS]), load(simd, &columns[SHARPNESS + 1])];
    let sharpness = most(s, most(t, load(simd, &columns[SHARPNESS + 2])));
    let is_centre = load(simd, &columns[HAS_CENTRE]).simd_gt(zero);
    let is_face = load(simd, &columns[FACE_SCALE + 3]).simd_gt(zero);
    let of_faces = reach.of_corner(simd, thickness);
    put_box(simd, columns, 0..0, is_centre, of_faces, &mut boxes.centres);
    let of_edges = reach.of_edge(simd, thickness, sharpness);
    put_box(simd, columns, 0..EDGES, sharpness.simd_ge(zero), of_edges, &mut boxes.edges);
    put_box(simd, columns, EDGES..EDGES + 2 * FACES, is_face, of_faces, &mut boxes.faces);
    boxes.whole = boxes.centres;
    boxes.whole.add(simd, &boxes.edges);
    boxes.whole.add(simd, &boxes.faces);
}

/// Boxes around the centres and these other corners of sixteen stars, wider by the `growth`; nothing where there is no
/// such part.
#[inline(always)]
fn put_box<S: Simd>(
    simd: S,
    columns: &Columns,
    corners: Range<usize>,
    is_there: mask32x16<S>,
    growth: f32x16<S>,
    boxes: &mut SweptBoxes,
) {
    let zero = f32x16::splat(simd, 0.0);
    let endless = f32x16::splat(simd, f32::INFINITY);
    for axis in 0..3 {
        let start = load(simd, &columns[CENTRE[0] + axis]);
        let end = load(simd, &columns[CENTRE[1] + axis]);
        let (mut low, mut high, mut slow, mut fast) = (zero, zero, zero, zero);
        for k in corners.clone() {
            let at = |time: usize| {
                (if k < EDGES { EDGE[time] + 3 * k } else { FACE[time] + 3 * (k - EDGES) }) + axis
            };
            let (place, target) = (load(simd, &columns[at(0)]), load(simd, &columns[at(1)]));
            let way = target - place;
            low = least(low, place);
            high = most(high, place);
            slow = least(slow, way);
            fast = most(fast, way);
        }
        let way = end - start;
        boxes.low[axis] = is_there.select(start + low - growth, endless).to_array();
        boxes.high[axis] = is_there.select(start + high + growth, -endless).to_array();
        boxes.slow[axis] = is_there.select(way + slow, endless).to_array();
        boxes.fast[axis] = is_there.select(way + fast, -endless).to_array();
    }
}

/// Adds the normals of the stars' faces, at the start, `between` and at the end, to the leans of their corners.
#[inline(always)]
fn lean<S: Simd>(simd: S, columns: &Columns, stars: &[Star], first: u32, between: f32, leans: &mut [Lean]) {
    let part = f32x16::splat(simd, between);
    for k in 0..FACES {
        let [now, later] = [FACE[0] + 6 * k, FACE[1] + 6 * k];
        let (u, v) = (vector(simd, columns, now), vector(simd, columns, now + 3));
        let (later_u, later_v) = (vector(simd, columns, later), vector(simd, columns, later + 3));
        let middle = [u.plus(later_u.minus(u).times(part)), v.plus(later_v.minus(v).times(part))];
        let mut normals = [[[0.0; LANES]; 3]; 3];
        for (normal, [u, v]) in normals.iter_mut().zip([[u, v], middle, [later_u, later_v]]) {
            let n = u.cross(v);
            let n = n.times(inverse(simd, n.dot(n)).sqrt());
            *normal = [n.x.to_array(), n.y.to_array(), n.z.to_array()];
        }
        for (lane, star) in stars.iter().enumerate().filter(|(_, star)| k < star.face_count as usize) {
            let mut lean = Lean::NOTHING;
            for normal in &normals {
                lean.add(&Lean::of(Vec3::new(normal[0][lane], normal[1][lane], normal[2][lane])));
            }
            for corner in star.face(k) {
                leans[(corner - first) as usize].add(&lean);
            }
        }
    }
}

/// The same for the links of a rope, which cannot meet itself if they all lead one way.
#[inline(always)]
fn lean_links(columns: &Columns, stars: &[Star], first: u32, leans: &mut [Lean]) {
    for (lane, star) in stars.iter().enumerate() {
        for k in 0..star.edge_count as usize {
            for at in EDGE {
                let link = [0, 1, 2].map(|axis| columns[at + 3 * k + axis][lane]);
                let lean = Lean::of(Vec3::from(link).normalize_or_zero());
                star.edge(k).into_iter().for_each(|end| leans[(end - first) as usize].add(&lean));
            }
        }
    }
}
