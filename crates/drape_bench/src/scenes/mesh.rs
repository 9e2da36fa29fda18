//! Irregular triangle meshes.

use std::collections::{HashMap, HashSet};

use drape_solver::StickKind;
use drape_solver::glam::Vec3;
use spade::{DelaunayTriangulation, InsertionError, Point2, Triangulation};

use crate::random::Random;
use crate::scenes::model::{Family, Model, Pins};
use crate::scenes::world::SIDE;

/// Seed of the points and of the order of vertices.
const SEED: u64 = 3;
/// The greatest displacement of a point from its regular place, as a fraction of the spacing.
const JITTER: f64 = 0.35;

/// `count` vertices over 2 m x 2 m in the XZ plane in random order, triangulated.
///
/// All edges are structural sticks; the two corners that face each other across an inner edge are joined by a bend
/// stick, unless a stick joins them already.
///
/// # Errors
/// The error of the triangulation.
pub fn mesh(count: u32, pins: Pins) -> Result<Model, InsertionError> {
    let mut random = Random::new(SEED);
    let points = points(count, &mut random);
    let faces = triangulate(&points)?;
    let place = random.permutation(count);
    let half = f64::from(SIDE) * 0.5;
    let is_pinned = |[x, z]: [f64; 2]| z == -half && (pins == Pins::Edge || x.abs() == half);
    let mut positions = vec![Vec3::ZERO; points.len()];
    let mut pinned = Vec::new();
    for (&point, &to) in points.iter().zip(&place) {
        positions[to as usize] = Vec3::new(point[0] as f32, 0.0, point[1] as f32);
        if is_pinned(point) {
            pinned.push(to);
        }
    }
    pinned.sort_unstable();
    let faces: Vec<[u32; 3]> = faces.into_iter().map(|face| face.map(|i| place[i as usize])).collect();
    let (edges, bends) = sticks(&faces);
    let natural_order = [edges.as_slice(), &bends].concat();
    let families = vec![
        Family { kind: StickKind::Structural, sticks: edges, offset: [0, 0] },
        Family { kind: StickKind::Bend, sticks: bends, offset: [0, 0] },
    ];
    Ok(Model { positions, grid: None, pinned, families, natural_order })
}

/// `count` points in jittered rows. Those on the border stay on it.
fn points(count: u32, random: &mut Random) -> Vec<[f64; 2]> {
    let (side, rows) = (f64::from(SIDE), f64::from(count).sqrt().round() as u32);
    let spacing = side / f64::from(rows - 1);
    let mut jittered = |is_border: bool, scale: f64| {
        let offset = random.either_side() * JITTER * scale;
        if is_border { 0.0 } else { offset }
    };
    let mut points = Vec::new();
    for row in 0..rows {
        let columns = count / rows + u32::from(row < count % rows);
        let step = side / f64::from(columns - 1);
        let is_outer_row = row == 0 || row == rows - 1;
        for column in 0..columns {
            let is_outer_column = column == 0 || column == columns - 1;
            let x = f64::from(column) * step + jittered(is_outer_column, step) - side * 0.5;
            let z = f64::from(row) * spacing + jittered(is_outer_row, spacing) - side * 0.5;
            points.push([x, z]);
        }
    }
    points
}

/// The triangles of the points, in the order of their first corners.
fn triangulate(points: &[[f64; 2]]) -> Result<Vec<[u32; 3]>, InsertionError> {
    let vertices = points.iter().map(|&[x, z]| Point2::new(x, z)).collect();
    let triangulation = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(vertices)?;
    let corners = triangulation.inner_faces().map(|face| face.vertices().map(|v| v.index() as u32));
    let mut faces: Vec<[u32; 3]> = corners.collect();
    faces.sort_unstable_by_key(|&[a, b, c]| (a.min(b).min(c), a, b, c));
    Ok(faces)
}

/// Edges in the order in which the faces name them, and bend sticks across the inner ones.
fn sticks(faces: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 2]>) {
    let pair = |a: u32, b: u32| (a.min(b), a.max(b));
    let (mut edges, mut across) = (Vec::new(), Vec::new());
    let mut opposite = HashMap::new();
    for &[a, b, c] in faces {
        for (from, to, corner) in [(a, b, c), (b, c, a), (c, a, b)] {
            match opposite.insert(pair(from, to), corner) {
                None => edges.push([from, to]),
                Some(other) => across.push([other, corner]),
            }
        }
    }
    let mut joined: HashSet<(u32, u32)> = edges.iter().map(|&[a, b]| pair(a, b)).collect();
    across.retain(|&[a, b]| joined.insert(pair(a, b)));
    (edges, across)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mesh_is_a_disc_of_triangles() {
        for count in [100, 5000] {
            let points = points(count, &mut Random::new(SEED));
            assert_eq!(points.len(), count as usize);
            let faces = triangulate(&points).expect("a triangulation");
            let mut uses = HashMap::new();
            for &[a, b, c] in &faces {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    assert_eq!(uses.insert((from, to), ()), None, "one face on each side of an edge");
                }
            }
            let (edges, _) = sticks(&faces);
            assert_eq!(points.len() + faces.len(), edges.len() + 1, "Euler's formula for a disc");
            let border = edges.iter().filter(|&&[a, b]| !uses.contains_key(&(b, a))).count();
            let on_border = points.iter().filter(|p| p.iter().any(|x| x.abs() == 1.0)).count();
            assert_eq!(border, on_border, "the border is the square's");
        }
    }

    #[test]
    fn no_two_sticks_join_the_same_particles_and_inner_edges_bend() {
        let model = mesh(2000, Pins::Corners).expect("a mesh");
        let mut all: Vec<_> = model.natural_order.iter().map(|&[a, b]| (a.min(b), a.max(b))).collect();
        all.sort_unstable();
        let count = all.len();
        all.dedup();
        assert_eq!(all.len(), count);
        assert_eq!(count, model.stick_count());
        let [edges, bends] = [0, 1].map(|i| model.families[i].sticks.len());
        // Three edges and just under three bend sticks a vertex, less the border's.
        assert!((2.8..3.0).contains(&(edges as f64 / 2000.0)), "{edges}");
        assert!((2.6..2.9).contains(&(bends as f64 / 2000.0)), "{bends}");
    }

    #[test]
    fn vertices_are_shuffled_and_pins_lie_on_one_side() {
        for (pins, count) in [(Pins::Corners, 2), (Pins::Edge, 45)] {
            let model = mesh(2000, pins).expect("a mesh");
            assert_eq!(model.pinned.len(), count);
            assert!(model.pinned.iter().all(|&pin| model.positions[pin as usize].z == -1.0));
            let far = model.positions.windows(2).filter(|p| p[0].distance(p[1]) > 0.3).count();
            assert!(far > 1500, "neighbours in memory are strangers in space");
        }
    }
}
