//! The drawn surface of cut and torn bodies, and what they weigh.

use std::collections::BTreeMap;

use drape_solver::Body;
use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::measure;

/// A corner of a polygon: the particles on which it depends, in order, and the bits of their weights.
type Corner = Vec<(u32, u32)>;

/// Whole faces and parts of faces of a body: the particles of the face, and the weights of them at each corner.
pub fn polygons(body: &Body) -> Vec<([u32; 3], Vec<Vec3>)> {
    let topology = &body.topology;
    let parts = topology.face_parts();
    assert!(parts.is_sorted_by_key(|part| part.face));
    let whole = |face: usize| parts.binary_search_by_key(&(face as u32), |part| part.face).is_err();
    let faces = topology.faces().iter().enumerate().filter(|(face, _)| whole(*face));
    let faces = faces.map(|(_, &face)| (face, vec![Vec3::X, Vec3::Y, Vec3::Z]));
    let parts = parts.iter().map(|part| (topology.faces()[part.face as usize], part.corners.to_vec()));
    faces.chain(parts).collect()
}

fn corner(face: [u32; 3], weights: Vec3) -> Corner {
    let mut corner: Corner =
        (0..3).filter(|&i| weights[i] != 0.0).map(|i| (face[i], weights[i].to_bits())).collect();
    corner.sort_unstable();
    corner
}

/// The place of a point of a face.
pub fn place(face: [u32; 3], weights: Vec3, at: impl Fn(usize) -> Vec3) -> DVec3 {
    (0..3).map(|i| at(face[i] as usize).as_dvec3() * f64::from(weights[i])).sum()
}

/// Area at rest of all that is drawn, in square metres.
pub fn area(bodies: &[Body]) -> f64 {
    let of_polygon = |body: &Body, (face, polygon): ([u32; 3], Vec<Vec3>)| {
        let places: Vec<DVec3> =
            polygon.iter().map(|&point| place(face, point, |i| body.topology.rest_position(i))).collect();
        let fan = places[1..].windows(2).map(|pair| (pair[0] - places[0]).cross(pair[1] - places[0]));
        0.5 * fan.sum::<DVec3>().length()
    };
    let of_body = |body: &Body| polygons(body).into_iter().map(|of| of_polygon(body, of)).sum::<f64>();
    bodies.iter().map(of_body).sum()
}

/// All that is drawn is a surface: each side bounds one polygon, or two whose senses agree, and no polygon is turned over. Faces that
/// share a particle hang together by edges.
pub fn assert_manifold(body: &Body) {
    let mut sides: BTreeMap<[Corner; 2], u32> = BTreeMap::new();
    let mut around: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let all = polygons(body);
    for (number, (face, polygon)) in all.iter().enumerate() {
        face.iter().for_each(|&particle| around.entry(particle).or_default().push(number));
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            *sides.entry([corner(*face, from), corner(*face, to)]).or_default() += 1;
            assert!((from.element_sum() - 1.0).abs() < 1e-5 && from.min_element() >= 0.0, "{from}");
            for &third in polygon {
                let turn = from.dot(to.cross(third));
                assert!(turn > -1e-5, "a corner that bends inwards: {polygon:?}");
            }
        }
    }
    for ([from, to], count) in &sides {
        assert_eq!(*count, 1, "polygons in two senses, or more than two, at {from:?} to {to:?}");
    }
    for (particle, polygons) in around {
        let sides_of = |number: usize| {
            let (face, polygon) = &all[number];
            (0..polygon.len()).map(move |i| {
                [polygon[i], polygon[(i + 1) % polygon.len()]].map(|point| corner(*face, point))
            })
        };
        let (mut reached, mut next) = (vec![polygons[0]], 0);
        while let Some(&number) = reached.get(next) {
            next += 1;
            for &other in &polygons {
                let is_beside = sides_of(number)
                    .any(|[from, to]| sides_of(other).any(|side| side == [to.clone(), from.clone()]));
                if is_beside && !reached.contains(&other) {
                    reached.push(other);
                }
            }
        }
        assert_eq!(reached.len(), polygons.len(), "faces hang together by particle {particle} alone");
    }
}

/// Mass in kg, momentum and angular momentum of all.
pub fn mass_and_momentum(bodies: &[Body]) -> (f64, DVec3, DVec3) {
    let sum = |of: fn(&drape_solver::Particles) -> DVec3| bodies.iter().map(|b| of(&b.particles)).sum();
    let mass = bodies.iter().map(|body| measure::mass(&body.particles)).sum();
    (mass, sum(measure::momentum), sum(measure::angular_momentum))
}

/// Mass, momentum and angular momentum are those of `before` to 1e-5.
pub fn assert_same_mass_and_momentum(bodies: &[Body], before: (f64, DVec3, DVec3)) {
    let after = mass_and_momentum(bodies);
    let size = before.1.length();
    assert!((after.0 - before.0).abs() < 1e-5 * before.0, "{} kg, before {} kg", after.0, before.0);
    assert!((after.1 - before.1).length() < 1e-5 * size, "{} Ns, before {} Ns", after.1, before.1);
    assert!((after.2 - before.2).length() < 1e-5 * size, "{} Nms, before {} Nms", after.2, before.2);
}
