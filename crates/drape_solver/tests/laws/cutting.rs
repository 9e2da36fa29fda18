//! Cuts follow the blade (S25): what is drawn ends on the stroke, and nothing of it is lost.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::crossings::CrossingCounter;
use drape_solver::state::measure;
use drape_solver::{Body, BodySettings, ClothBuilder, Edge, Island, MeshClothBuilder, SelfContact, Torn};

use crate::common::*;
use crate::drawn::{
    area, assert_manifold, assert_same_mass_and_momentum, mass_and_momentum, place, polygons,
};

fn cut(body: &mut Body, from: Vec3, to: Vec3) -> Option<Torn> {
    body.cut(&blade(from, to)).expect("can be cut")
}

/// A free sheet of 1 m x 1 m in the XY plane around the origin, as a grid or as a mesh of uneven triangles.
fn sheet(columns: u32, rows: u32, is_mesh: bool) -> Body {
    let grid = ClothBuilder::new(1.0, 1.0, columns, rows)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .build(BodySettings { substeps: 4, ..BodySettings::default() })
        .expect("valid");
    if !is_mesh {
        return grid;
    }
    let mut dice = Dice::new(columns.into());
    let places = grid.particles.positions().map(|place| {
        let is_rim = place.abs().max_element() > 0.499;
        if is_rim { place } else { place + dice.vector(0.3 / columns as f32).with_z(0.0) }
    });
    let mesh = MeshClothBuilder::new(places.collect(), grid.topology.faces().to_vec());
    mesh.build(BodySettings { substeps: 4, ..BodySettings::default() }).expect("valid")
}

/// Part of the way from `from` to `to`, and metres beside it, of a place in the XY plane.
fn along(from: Vec3, to: Vec3, place: DVec3) -> [f64; 2] {
    let way = (to - from).as_dvec3();
    let off = place - from.as_dvec3();
    [off.dot(way) / way.length_squared(), way.cross(off).z / way.length()]
}

/// A thousand random strokes through grids and meshes: each polygon that a stroke passes right through ends on it to 1 mm. All that is
/// drawn is a surface, and area, mass and momentum stay.
#[test]
fn a_thousand_strokes_end_on_the_blade_and_lose_nothing() {
    let mut dice = Dice::new(7);
    let mut farthest = 0.0_f64;
    for (columns, rows, is_mesh, strokes) in [
        (40, 33, false, 300),
        (9, 7, false, 100),
        (33, 40, true, 300),
        (12, 12, true, 200),
        (3, 4, false, 100),
    ] {
        let mut done = 0;
        while done < strokes {
            let mut whole = sheet(columns, rows, is_mesh);
            for i in 0..whole.particles.len() {
                let (place, spin) = (whole.particles.position(i), Vec3::new(0.3, 1.0, -0.4));
                whole.particles.set_velocity(i, Vec3::X + spin.cross(place));
            }
            let mut bodies = vec![whole];
            let (area_before, before) = (area(&bodies), mass_and_momentum(&bodies));
            // Ten strokes across each other in each sheet.
            for _ in 0..10 {
                let mut place = || Vec3::new(dice.about(0.7), dice.about(0.7), 0.0);
                let (from, to) = (place(), place());
                let mut pieces = Vec::new();
                for body in &mut bodies {
                    let torn = cut(body, from, to);
                    pieces.extend(torn.into_iter().flat_map(|torn| torn.pieces).map(|piece| piece.body));
                }
                bodies.append(&mut pieces);
                done += 1;
                for (face, polygon) in bodies.iter().flat_map(polygons_in_world) {
                    let _ = face;
                    let seen: Vec<[f64; 2]> = polygon.iter().map(|&place| along(from, to, place)).collect();
                    // Parts of the way at which the outline crosses the stroke.
                    let crossed: Vec<f64> = (0..seen.len())
                        .filter_map(|i| {
                            let ([p, a], [q, b]) = (seen[i], seen[(i + 1) % seen.len()]);
                            (a * b < 0.0).then(|| p + (q - p) * a / (a - b))
                        })
                        .collect();
                    let is_through =
                        crossed.len() == 2 && crossed.iter().all(|&part| (0.0..=1.0).contains(&part));
                    if is_through {
                        let beside = |sign: f64| seen.iter().map(|seen| sign * seen[1]).fold(0.0, f64::max);
                        farthest = farthest.max(beside(1.0).min(beside(-1.0)));
                    }
                }
            }
            bodies.iter().for_each(assert_manifold);
            let off = area(&bodies) / area_before - 1.0;
            assert!(off.abs() < 1e-4, "area off by {off}");
            assert_same_mass_and_momentum(&bodies, before);
            let mut island = Island { bodies, ..Island::default() };
            run(&mut island, &gravity(FRAME), 0.1);
        }
    }
    println!("law: cut edges {:.2} mm off the stroke at most", farthest * 1e3);
    assert!(farthest < 1e-3, "{farthest} m off the stroke");
}

fn polygons_in_world(body: &Body) -> Vec<([u32; 3], Vec<DVec3>)> {
    let to_world = |(face, polygon): ([u32; 3], Vec<Vec3>)| {
        let places = polygon.iter().map(|&point| place(face, point, |i| body.particles.position(i)));
        (face, places.collect())
    };
    polygons(body).into_iter().map(to_world).collect()
}

/// The greatest distance from the line `y = height` of what is drawn on the wrong side of it, in metres.
fn across_level(bodies: &[Body], height: f64) -> f64 {
    let beside = |polygon: &[DVec3], sign: f64| {
        polygon.iter().map(|place| sign * (place.y - height)).fold(0.0, f64::max)
    };
    let all = bodies.iter().flat_map(polygons_in_world);
    all.map(|(_, polygon)| beside(&polygon, 1.0).min(beside(&polygon, -1.0))).fold(0.0, f64::max)
}

/// A knife that takes many steps through a sheet, each much smaller than a face, cuts as one that takes a single step. Each of its strokes
/// ends inside a face, where the next one goes on.
#[test]
fn a_slow_knife_cuts_like_a_fast_one() {
    for (is_mesh, steps) in [(false, 1), (false, 7), (false, 300), (true, 300)] {
        let mut body = sheet(20, 17, is_mesh);
        let mut pieces = Vec::new();
        for i in 0..steps {
            let x = |i: i32| -0.7 + 1.4 * i as f32 / steps as f32;
            let [from, to] = [i, i + 1].map(|i| Vec3::new(x(i), 0.013, 0.0));
            pieces.extend(cut(&mut body, from, to).into_iter().flat_map(|torn| torn.pieces));
        }
        assert_eq!(pieces.len(), 1, "in {steps} steps");
        let bodies = [body, pieces.remove(0).body];
        bodies.iter().for_each(assert_manifold);
        let off = across_level(&bodies, 0.013);
        assert!(off < 1e-3, "{off} m off the stroke");
        assert!((area(&bodies) - 1.0).abs() < 1e-4);
    }
}

/// A blade that goes along a row of particles, or nearly so, parts whole faces: no slivers are left along it.
#[test]
fn a_blade_through_corners_divides_no_face() {
    for off in [0.0, 1e-4, -3e-4] {
        let mut body = sheet(21, 21, false);
        let torn = cut(&mut body, Vec3::new(-0.8, off, 0.0), Vec3::new(0.8, -off, 0.0)).expect("opens");
        assert_eq!((body.topology.face_parts().len(), torn.pieces.len()), (0, 1), "at {off}");
        assert_eq!(body.particles.len() + torn.pieces[0].body.particles.len(), 22 * 21);
    }
}

/// A stroke that only goes through one face opens nothing yet: its two parts move as one face. The next stroke opens both.
#[test]
fn a_stroke_through_one_face_opens_nothing_until_it_goes_on() {
    let mut body = sheet(11, 11, false);
    let (faces, particles) = (body.topology.faces().len(), body.particles.len());
    let [start, middle, end] = [-0.035, 0.045, 0.255].map(|x| Vec3::new(x, 0.5 * x + 0.03, 0.0));
    let torn = cut(&mut body, start, middle).expect("divides a face");
    assert!(torn.pieces.is_empty());
    assert_eq!((body.topology.faces().len(), body.particles.len()), (faces, particles));
    assert!(body.topology.face_parts().iter().any(|part| part.share() < 0.9), "it is divided");
    cut(&mut body, middle, end).expect("goes on");
    assert!(body.particles.len() > particles);
    assert_manifold(&body);
    let off = polygons_in_world(&body).into_iter().map(|(_, polygon)| {
        let seen = polygon.iter().map(|&place| along(start, end, place));
        let inside: Vec<f64> =
            seen.filter(|seen| (0.25..0.75).contains(&seen[0])).map(|seen| seen[1]).collect();
        let beside = |sign: f64| inside.iter().map(|off| sign * off).fold(0.0, f64::max);
        beside(1.0).min(beside(-1.0))
    });
    assert!(off.fold(0.0, f64::max) < 1e-3, "along the whole of it");
}

/// The triangles of a blade in another order: the second half of each quad first.
fn turned(mut triangles: Vec<[Vec3; 3]>) -> Vec<[Vec3; 3]> {
    triangles.as_chunks_mut().0.iter_mut().for_each(|pair: &mut [[Vec3; 3]; 2]| pair.swap(0, 1));
    triangles
}

/// Crooked paths from rim to rim part a sheet in two, in one cut or in many, and in any order of the blade's triangles.
#[test]
fn any_path_from_rim_to_rim_parts_a_sheet_in_two() {
    let mut dice = Dice::new(11);
    for round in 0..160 {
        let (columns, rows) = [(20, 17), (6, 6), (9, 12)][round % 3];
        let whole = sheet(columns, rows, round % 2 == 1);
        let joints = [1, 3, 10, 60][round % 4];
        let (slope, wave, start) = (dice.about(0.3), dice.about(0.1), dice.about(0.3));
        let path: Vec<Vec3> = (0..=joints)
            .map(|i| {
                let x = -0.7 + 1.4 * i as f32 / joints as f32;
                Vec3::new(
                    x,
                    start + slope * x + wave * (9.0 * x).sin() + dice.about(0.1 / joints as f32),
                    0.0,
                )
            })
            .collect();
        let strokes: Vec<[Vec3; 3]> = path.windows(2).flat_map(|ends| blade(ends[0], ends[1])).collect();
        for order in [
            strokes.clone(),
            turned(strokes),
            path.iter()
                .rev()
                .copied()
                .collect::<Vec<_>>()
                .windows(2)
                .flat_map(|ends| blade(ends[0], ends[1]))
                .collect(),
        ] {
            for at_once in [order.len(), 2] {
                let mut bodies = vec![whole.clone()];
                for blade in order.chunks(at_once) {
                    let torn = bodies.iter_mut().filter_map(|body| body.cut(blade).expect("can be cut"));
                    let pieces: Vec<Body> =
                        torn.flat_map(|torn| torn.pieces).map(|piece| piece.body).collect();
                    bodies.extend(pieces);
                }
                assert_eq!(bodies.len(), 2, "round {round}, {joints} joints, {at_once} triangles at once");
                bodies.iter().for_each(assert_manifold);
                assert!((area(&bodies) - 1.0).abs() < 1e-4);
            }
        }
    }
}

/// A knife that waits in a sheet goes on where it has stopped, though another one has cut across its way.
#[test]
fn a_stroke_goes_on_after_another_has_crossed_its_way() {
    let mut bodies = vec![sheet(20, 17, false)];
    let mut stroke = |from: Vec3, to: Vec3| {
        let torn = bodies.iter_mut().filter_map(|body| cut(body, from, to));
        let pieces: Vec<Body> = torn.flat_map(|torn| torn.pieces).map(|piece| piece.body).collect();
        bodies.extend(pieces);
        bodies.len()
    };
    let at = |x: f32| Vec3::new(x, 0.013, 0.0);
    stroke(at(-0.7), at(0.02));
    assert_eq!(stroke(Vec3::new(0.0115, 0.7, 0.0), Vec3::new(0.0115, -0.7, 0.0)), 3);
    assert_eq!(stroke(at(0.02), at(0.7)), 4);
}

/// A blade of two sides, each triangle twice, cuts as one of one side; so do two that stop in one face, crossed by a third.
#[test]
fn a_blade_of_two_sides_cuts_once() {
    let mut dice = Dice::new(3);
    for _ in 0..40 {
        let mut body = sheet(12, 9, false);
        let [from, to] = [-0.7, 0.7].map(|x| Vec3::new(x, dice.about(0.4), 0.0));
        let middle = from.lerp(to, dice.unit());
        let one: Vec<[Vec3; 3]> = [blade(from, middle), blade(middle, to)].concat();
        let back: Vec<[Vec3; 3]> = one.iter().map(|&[p, q, r]| [p, r, q]).collect();
        let torn = body.cut(&[one, back].concat()).expect("can be cut").expect("opens");
        assert_eq!(torn.pieces.len(), 1, "from {from} by {middle} to {to}");
    }
    let mut bodies = vec![sheet(6, 6, false)];
    let mut stroke = |from: [f32; 2], to: [f32; 2]| {
        let [from, to] = [from, to].map(|[x, y]| Vec3::new(x, y, 0.0));
        let torn = bodies.iter_mut().filter_map(|body| cut(body, from, to));
        let pieces: Vec<Body> = torn.flat_map(|torn| torn.pieces).map(|piece| piece.body).collect();
        bodies.extend(pieces);
        bodies.len()
    };
    for y in [0.03, 0.05] {
        stroke([-0.7, y], [0.06, y]);
    }
    assert_eq!(stroke([0.02, 0.7], [0.02, -0.7]), 4, "two halves, and a strip between the two ways");
    for y in [0.03, 0.05] {
        stroke([0.06, y], [0.7, y]);
    }
    assert_eq!(bodies.len(), 6);
    bodies.iter().for_each(assert_manifold);
}

/// A blade that only goes through corners of faces leaves a grid as quick as it was.
#[test]
fn a_prick_leaves_a_grid_whole() {
    let mut body = sheet(20, 17, false);
    let grid = body.topology.grid_size();
    assert!(cut(&mut body, Vec3::new(0.01, 0.013, 0.0), Vec3::new(0.015, 0.011, 0.0)).is_none());
    cut(&mut body, Vec3::new(0.01, 0.013, 0.0), Vec3::new(0.03, 0.013, 0.0)).expect("through an edge");
    assert_eq!(body.topology.grid_size(), grid);
    // A blade that stays where it is changes nothing more: inside a face, through a face, along edges.
    for (from, to) in [
        (Vec3::new(0.01, 0.013, 0.0), Vec3::new(0.03, 0.013, 0.0)),
        (Vec3::new(-0.2, 0.3, 0.0), Vec3::new(-0.1, 0.28, 0.0)),
        (Vec3::new(-0.6, 0.5, 0.0), Vec3::new(0.6, 0.5, 0.0)),
        (Vec3::new(-0.5, -0.125, 0.0), Vec3::new(-0.44, -0.125, 0.0)),
    ] {
        cut(&mut body, from, to);
        assert!(cut(&mut body, from, to).is_none(), "from {from} to {to}");
    }
}

/// A path with sharp turns inside faces takes out what it goes around: on sheets that wave, from rim to rim and as a loop.
#[test]
fn paths_with_turns_cut_out_what_they_go_around() {
    let corners = [(-0.8, -0.21), (0.02, -0.21), (0.02, -0.8)];
    let star = [(0.3, 0.02), (-0.1, 0.31), (-0.24, -0.13), (0.2, -0.3), (0.06, -0.02), (0.3, 0.02)];
    for (path, expected, slack) in [(&corners[..], 0.52 * 0.29, 0.01), (&star, 0.1508, 0.01)] {
        for is_mesh in [false, true] {
            let mut body = sheet(20, 17, is_mesh);
            for i in 0..body.particles.len() {
                let place = body.particles.position(i);
                body.particles.set_position(i, place.with_z(0.05 * (9.0 * place.x + 5.0 * place.y).sin()));
            }
            let path: Vec<Vec3> = path.iter().map(|&(x, y)| Vec3::new(x, y, 0.0)).collect();
            let strokes: Vec<[Vec3; 3]> = path.windows(2).flat_map(|ends| blade(ends[0], ends[1])).collect();
            let torn = body.cut(&strokes).expect("can be cut").expect("opens");
            assert_eq!(torn.pieces.len(), 1);
            let mut bodies = vec![body];
            bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
            bodies.iter().for_each(assert_manifold);
            let own = bodies.iter().map(|body| area(core::slice::from_ref(body))).fold(f64::MAX, f64::min);
            assert!((own - expected).abs() < slack, "{own} m^2 were cut out, not {expected} m^2");
            assert!((area(&bodies) - 1.0).abs() < 1e-4);
        }
    }
}

/// Three slits through one point, in one cut: six petals that only hang together at their outer ends.
#[test]
fn slits_that_cross_in_a_face_open_to_their_middle() {
    let mut body = sheet(12, 12, false);
    let centre = Vec3::new(0.02, -0.015, 0.0);
    let slits = [0.3_f32, 1.4, 2.5].map(|angle| {
        let way = Vec3::new(angle.cos(), angle.sin(), 0.0) * 0.3;
        blade(centre - way, centre + way)
    });
    body.cut(slits.as_flattened()).expect("can be cut").expect("opens");
    assert_manifold(&body);
    let near = polygons(&body).into_iter().filter(|(face, polygon)| {
        let places = polygon.iter().map(|&point| place(*face, point, |i| body.particles.position(i)));
        let (mut least, mut sum) = (f64::MAX, DVec3::ZERO);
        for place in places {
            least = least.min(place.distance(centre.as_dvec3()));
            sum += place;
        }
        least < 1e-3 && sum.is_finite()
    });
    let petals: Vec<[u32; 3]> = near.map(|(face, _)| face).collect();
    assert_eq!(petals.len(), 6, "parts at the middle");
    for (i, petal) in petals.iter().enumerate() {
        assert!(petals[i + 1..].iter().all(|other| petal != other), "each moves by itself");
    }
}

/// Two strokes closer together than the rows leave a strip between them: it has its area, its mass and its place, and falls.
#[test]
fn a_strip_narrower_than_a_face_is_cloth() {
    let whole = sheet(20, 20, false);
    let mass = mass_and_momentum(core::slice::from_ref(&whole)).0;
    let mut bodies = vec![whole];
    for height in [0.005, 0.025] {
        let mut pieces = Vec::new();
        for body in &mut bodies {
            let torn = cut(body, Vec3::new(-2.0, height, 0.0), Vec3::new(2.0, height, 0.0));
            pieces.extend(torn.into_iter().flat_map(|torn| torn.pieces).map(|piece| piece.body));
        }
        bodies.append(&mut pieces);
    }
    assert_eq!(bodies.len(), 3);
    bodies.sort_by(|p, q| area(core::slice::from_ref(p)).total_cmp(&area(core::slice::from_ref(q))));
    let strip = core::slice::from_ref(&bodies[0]);
    assert!((area(strip) - 0.02).abs() < 1e-5, "{}", area(strip));
    let own = mass_and_momentum(strip).0 / mass;
    assert!((own - 0.02).abs() < 0.01, "{own} of the mass");
    let mut island = Island { bodies, ..Island::default() };
    run(&mut island, &gravity(FRAME), 0.5);
    let stretch = measure::stretch(&island.bodies[0].particles, &island.bodies[0].topology).max;
    assert!(stretch < 1e-3, "it falls freely, and is stretched by {stretch}");
}

/// Cloth that touches itself does not cross itself where it is cut, as both sides have the faces of the cut. The sides of a slit stay
/// still, those of two pieces nearly so.
#[test]
fn the_sides_of_a_cut_do_not_cross() {
    for (columns, is_mesh) in [(20, false), (15, true)] {
        let mut body = sheet(columns, 18, is_mesh);
        (body.settings.self_contact, body.settings.thickness) = (SelfContact::On, 4e-3);
        for (from, to, count, most) in [
            (Vec3::new(0.111, 0.3, 0.0), Vec3::new(0.12, -0.3, 0.0), 1, 0.01),
            (Vec3::new(-0.7, 0.013, 0.0), Vec3::new(0.7, 0.04, 0.0), 2, 0.1),
        ] {
            let torn = cut(&mut body, from, to).expect("opens");
            let mut bodies = vec![body.clone()];
            bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
            assert_eq!(bodies.len(), count);
            let mut island = Island { bodies, ..Island::default() };
            let mut counter = CrossingCounter::of(island.bodies.iter().map(|body| &*body.topology));
            assert_eq!(counter.count(&places(&island)), 0);
            run(&mut island, &weightless(FRAME), 0.5);
            let fastest = island.bodies.iter().flat_map(|body| body.particles.velocities());
            let fastest = fastest.map(Vec3::length).fold(0.0, f32::max);
            println!("law: the sides of a cut move at {fastest} m/s");
            assert!(fastest < most, "{fastest} m/s");
        }
    }
}

fn places(island: &Island) -> Vec<DVec3> {
    let all = island.bodies.iter().flat_map(|body| body.particles.positions());
    all.map(Vec3::as_dvec3).collect()
}

/// Each piece weighs what is drawn of it, wherever in a row of faces it ends.
#[test]
fn pieces_weigh_what_is_drawn_of_them() {
    let mut off = 0.0_f64;
    for tenth in 1..10 {
        let mut body = sheet(11, 11, false);
        let whole = mass_and_momentum(core::slice::from_ref(&body)).0;
        let height = 0.01 * tenth as f32;
        cut(&mut body, Vec3::new(-0.8, height, 0.0), Vec3::new(0.8, height, 0.0)).expect("cut through");
        let largest = core::slice::from_ref(&body);
        off = off.max((mass_and_momentum(largest).0 / whole - area(largest)).abs());
    }
    println!("law: pieces weigh {:.2} % of the sheet more or less than their area", off * 100.0);
    assert!(off < 0.012, "{off} of the sheet");
}

/// Blades without an area, beside the cloth, in its plane, or nowhere cut nothing.
#[test]
fn blades_that_are_none_cut_nothing() {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
    let blades = [
        [Vec3::ZERO; 3],
        [-x, Vec3::ZERO, x],
        [z, z + x, z + y],
        [-x - y, x - y, y],
        [x.with_y(f32::NAN), y - z, z],
        [x * f32::INFINITY, y - z, -x],
    ];
    for is_mesh in [false, true] {
        let mut body = sheet(9, 9, is_mesh);
        assert!(body.cut(&[]).expect("nothing to do").is_none());
        for blade in blades {
            assert!(body.cut(&[blade]).expect("nothing to do").is_none(), "{blade:?}");
        }
        assert!(body.topology.face_parts().is_empty());
    }
}

/// A curtain that is cut just below the row of its pins falls: the copies of pins that carry what is cut off are free. What hangs on keeps
/// its pins, on both sides where the blade goes through them.
#[test]
fn what_is_cut_off_below_the_pins_falls() {
    let curtain = ClothBuilder::new(1.0, 1.0, 12, 12)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings { drag: 0.0, ..BodySettings::default() })
        .expect("valid");
    let mut below = curtain.clone();
    let torn = cut(&mut below, Vec3::new(-2.0, 0.46, 0.0), Vec3::new(2.0, 0.46, 0.0)).expect("cut through");
    let mut bodies = vec![below];
    bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
    let pins = |body: &Body| (0..body.particles.len()).filter(|&i| body.particles.is_pinned(i)).count();
    let mut count: Vec<usize> = bodies.iter().map(pins).collect();
    count.sort_unstable();
    assert_eq!(count, [0, 12]);
    let mut island = Island { bodies, ..Island::default() };
    run(&mut island, &gravity(FRAME), 0.5);
    let fallen = island.bodies.iter().find(|body| pins(body) == 0).expect("one without pins");
    assert!(fallen.topology.tethers().is_empty(), "nothing holds it");
    assert!(fallen.particles.positions().all(|place| place.y < 0.5 - 1.0), "it hangs");

    // Through two of the pins.
    let [left, right] = [4, 7].map(|pin| curtain.particles.position(pin));
    let mut bodies = vec![curtain];
    for pin in [left, right] {
        let down = Vec3::NEG_Y * 2.0;
        let torn = bodies.iter_mut().filter_map(|body| cut(body, pin - down, pin + down));
        let pieces: Vec<Body> = torn.flat_map(|torn| torn.pieces).map(|piece| piece.body).collect();
        bodies.extend(pieces);
    }
    let mut count: Vec<usize> = bodies.iter().map(pins).collect();
    count.sort_unstable();
    assert_eq!(count, [4, 5, 5], "of 12 pins, two on both sides");
}
