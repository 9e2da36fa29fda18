//! Tears and cuts (S24, S25): both sides are valid bodies, and mass and momentum stay.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, Edge, Isa, Island, Obstacle, RopeBuilder, StateHasher, StructuralSolve,
    TearLimits, Torn, step,
};

use crate::common::*;
use crate::determinism::Fresh;
use crate::drawn::{area, assert_manifold, assert_same_mass_and_momentum, mass_and_momentum, polygons};

/// A free sheet of 1 m x 1 m in the XY plane around the origin.
fn sheet(columns: u32, rows: u32) -> Body {
    ClothBuilder::new(1.0, 1.0, columns, rows)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .build(BodySettings { substeps: 4, ..BodySettings::default() })
        .expect("valid")
}

/// A cut from top to bottom at `x`.
fn down(x: f32) -> [[Vec3; 3]; 2] {
    blade(Vec3::new(x, 2.0, 0.0), Vec3::new(x, -2.0, 0.0))
}

fn cut(body: &mut Body, blade: &[[Vec3; 3]]) -> Option<Torn> {
    body.cut(blade).expect("can be cut")
}

/// Sticks and tethers join particles of the body, and no stick occurs twice.
fn assert_joined_well(body: &Body) {
    let topology = &body.topology;
    let mut ends: Vec<[u32; 2]> = (0..topology.stick_count()).map(|i| topology.stick(i)).collect();
    let count = body.particles.len() as u32;
    assert_eq!(topology.particle_count() as u32, count);
    assert!(ends.iter().all(|[a, b]| a != b && *a < count && *b < count));
    ends.iter_mut().for_each(|ends| ends.sort_unstable());
    ends.sort_unstable();
    let all = ends.len();
    ends.dedup();
    assert_eq!(ends.len(), all, "a stick is there twice");
    assert!(topology.tethers().iter().all(|&(particle, pin, _)| particle < count && pin < count));
}

/// A thousand random cuts and tears of sheets of every layout and of a mesh: what is drawn is a surface of the same
/// area, and mass and momentum are the same to 1e-5.
#[test]
fn a_thousand_cuts_and_tears_leave_manifold_pieces_of_the_same_mass_and_momentum() {
    let (mut dice, mut cuts) = (Dice::new(1), 0);
    let bodies = [
        (sheet(40, 33), 400),
        (sheet(20, 17), 250),
        (sheet(4, 60), 80),
        (sheet(7, 6), 20),
        (ball_of_cloth(), 250),
    ];
    for (mut whole, wanted) in bodies {
        for i in 0..whole.particles.len() {
            let (place, spin) = (whole.particles.position(i), Vec3::new(0.3, 1.0, -0.4));
            whole.particles.set_velocity(i, Vec3::X + spin.cross(place) + dice.vector(0.1));
        }
        let mut bodies = vec![whole];
        let area_before = area(&bodies);
        let before = mass_and_momentum(&bodies);
        let (mut opened, mut round) = (0, 0);
        while opened < wanted {
            round += 1;
            assert!(round < 20 * wanted, "only {opened} of {wanted} cuts and tears opened something");
            let largest = (0..bodies.len()).max_by_key(|&i| bodies[i].topology.faces().len()).unwrap_or(0);
            let chosen = if round % 4 < 2 { largest } else { (dice.unit() * bodies.len() as f32) as usize };
            let (low, high) = bodies[chosen].particles.bounds();
            let mut place = || low + (high - low) * Vec3::from([(); 3].map(|()| dice.unit()));
            let (from, to) = (place(), place());
            let aside = dice.vector(1.0);
            // Pulls at one particle for a moment, so that sticks tear.
            let (pulled, pull) =
                ((dice.unit() * bodies[chosen].particles.len() as f32) as usize, dice.vector(0.3));
            let body = &mut bodies[chosen];
            let torn = if round % 2 == 0 {
                cut(body, &[[from - aside, to - aside, to + aside], [from - aside, to + aside, from + aside]])
            } else {
                let place = body.particles.position(pulled);
                body.particles.set_position(pulled, place + pull);
                let mut torn = body.tear(&TearLimits { strain: 0.5, most: 4 }).expect("can tear");
                put_back(body, torn.as_ref().map(|torn| &torn.origins), pulled, place);
                for piece in torn.iter_mut().flat_map(|torn| &mut torn.pieces) {
                    put_back(&mut piece.body, Some(&piece.origins), pulled, place);
                }
                torn
            };
            opened += usize::from(torn.is_some());
            cuts += usize::from(torn.is_some() && round % 2 == 0);
            bodies.extend(torn.into_iter().flat_map(|torn| torn.pieces).map(|piece| piece.body));
        }
        let off = area(&bodies) / area_before - 1.0;
        assert!(off.abs() < 1e-4, "area off by {off}");
        for body in &bodies {
            assert_manifold(body);
            assert_joined_well(body);
        }
        assert_same_mass_and_momentum(&bodies, before);
        // The pieces can be stepped.
        let mut island = Island { bodies, ..Island::default() };
        run(&mut island, &gravity(FRAME), 0.2);
    }
    println!("law: {cuts} cuts and {} tears opened something", 1000 - cuts);
    assert!((200..=800).contains(&cuts), "of both kinds");
}

/// Puts particle `i` and its copies back to their old place.
fn put_back(body: &mut Body, origins: Option<&Vec<u32>>, i: usize, place: Vec3) {
    for now in 0..body.particles.len() {
        if origins.map_or(now, |origins| origins[now] as usize) == i {
            body.particles.set_position(now, place);
        }
    }
}

/// A closed mesh: a sphere of longitudes and latitudes.
fn ball_of_cloth() -> Body {
    let (places, faces) = sphere(Vec3::ZERO, 0.5, 24, 16);
    let mut body = joined(&places, &vec![100.0; places.len()], &[], BodySettings::default());
    let mut builder = drape_solver::TopologyBuilder::new(&places);
    let structural = drape_solver::StickMaterial::rigid(drape_solver::StickKind::Structural);
    builder.family(structural, edges(&faces)).expect("valid").faces(faces).expect("valid");
    body.topology = std::sync::Arc::new(builder.build().expect("valid"));
    body
}

/// A sheet cut in two is two sheets: the lower half falls freely, the upper hangs on.
#[test]
fn what_is_cut_off_falls_as_a_free_body() {
    for (columns, rows) in [(40, 40), (18, 18), (8, 8)] {
        let cloth = ClothBuilder::new(1.0, 1.0, columns, rows)
            .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top);
        let mut island = Island::of_body(
            cloth.build(BodySettings { drag: 0.0, ..BodySettings::default() }).expect("valid"),
        );
        let environment = gravity(FRAME);
        run(&mut island, &environment, 0.5);
        // The cut is above the middle, so that the hanging piece is the smaller one.
        let cut = cut(&mut island.bodies[0], &blade(Vec3::new(-2.0, 0.1, 0.0), Vec3::new(2.0, 0.1, 0.0)));
        let torn = cut.expect("cut through");
        assert_eq!(torn.pieces.len(), 1);
        assert!(!torn.sticks.is_empty());
        island.bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
        let centre = |island: &Island| {
            let particles = &island.bodies[0].particles;
            let (mut sum, mut mass) = (DVec3::ZERO, 0.0);
            for i in 0..particles.len() {
                let own = 1.0 / f64::from(particles.inverse_mass(i));
                sum += particles.position(i).as_dvec3() * own;
                mass += own;
            }
            sum / mass
        };
        assert!((0..island.bodies[0].particles.len()).all(|i| !island.bodies[0].particles.is_pinned(i)));
        let (start, momentum) = (centre(&island), measure::momentum(&island.bodies[0].particles));
        let speed = momentum / measure::mass(&island.bodies[0].particles);
        run(&mut island, &environment, 0.5);
        let fallen = centre(&island) - start - speed * 0.5;
        // The parabola of the substeps is h/2 ahead, as displacements begin with a whole substep's gravity.
        let substep = f64::from(FRAME) / f64::from(island.bodies[0].settings.substeps);
        let expected = -0.5 * f64::from(G) * 0.5 * (0.5 + substep);
        println!("law: fall of what is cut off {} m, expected {expected} m", fallen.y);
        assert!((fallen.y - expected).abs() < 2e-3 * expected.abs(), "{columns}: {fallen}");
        let hanging = &island.bodies[1].particles;
        assert!(hanging.positions().all(|place| place.y > 0.0), "the rest hangs");
        assert!(measure::stretch(hanging, &island.bodies[1].topology).max < 0.1);
    }
}

/// No stick and no tether crosses a cut: those that still join the two sides go around its end.
#[test]
fn a_cut_opens_and_nothing_holds_its_sides_together() {
    for ((columns, rows), settings) in each_with([(40, 40), (20, 20), (9, 9)], settings_of_both()) {
        let mut body = ClothBuilder::new(1.0, 1.0, columns, rows)
            .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Left)
            .build(BodySettings { drag: 0.5, ..settings })
            .expect("valid");
        let mut whole = Island::of_body(body.clone());
        run(&mut whole, &gravity(FRAME), 3.0);
        let line = 0.01;
        let torn =
            cut(&mut body, &blade(Vec3::new(-0.2, line, 0.0), Vec3::new(2.0, line, 0.0))).expect("cut");
        assert!(torn.pieces.is_empty(), "it still hangs together at the left");
        assert!(torn.edges.is_empty(), "a cut is straight");
        // A particle is on the same side as what it carries.
        let mut side = vec![0.0; body.particles.len()];
        for (face, polygon) in polygons(&body) {
            let heights = face.map(|corner| body.particles.position(corner as usize).y);
            let height = |point: &Vec3| (0..3).map(|i| heights[i] * point[i]).sum::<f32>();
            let centre = polygon.iter().map(height).sum::<f32>() / polygon.len() as f32;
            face.iter().for_each(|&corner| side[corner as usize] += centre - line);
        }
        for ends in (0..body.topology.stick_count()).map(|i| body.topology.stick(i).map(|end| end as usize)) {
            if ends.iter().all(|&end| body.particles.position(end).x > 0.0) {
                assert!(
                    side[ends[0]] * side[ends[1]] > 0.0,
                    "a stick from {} to {} goes across",
                    ends[0],
                    ends[1]
                );
            }
        }
        let mut island = Island::of_body(body);
        let mut gap = 0.0_f32;
        run_with(&mut island, &gravity(FRAME), 3.0, |island, _| {
            let apart = |copy: usize| {
                particles(island)
                    .position(copy)
                    .distance(particles(island).position(torn.origins[copy] as usize))
            };
            gap = ((columns * rows) as usize..torn.origins.len()).map(apart).fold(gap, f32::max);
        });
        println!("law: {} split particles came {gap} m apart", torn.origins.len() as u32 - columns * rows);
        let least = if settings.structural == StructuralSolve::Lines { 3e-3 } else { 5e-3 };
        assert!(gap > least, "{gap}");
        let body = &island.bodies[0];
        let (split, unsplit) = (stretch(&island).rms, stretch(&whole).rms);
        println!("law: {columns} {settings:?}: stretch {split}, of a whole sheet {unsplit}");
        assert!(split < 1.5 * unsplit, "stretch {split}, of a whole sheet {unsplit}");
        assert_manifold(body);
    }
}

/// A cut changes nothing away from itself: a sheet that is cut where no force acts moves like a whole one.
#[test]
fn a_sheet_that_is_cut_in_free_fall_falls_as_before() {
    let mut whole = Island::of_body(sheet(40, 33));
    let mut torn = whole.clone();
    cut(&mut torn.bodies[0], &blade(Vec3::new(-0.2, 0.03, 0.0), Vec3::new(0.3, 0.1, 0.0))).expect("opens");
    for island in [&mut whole, &mut torn] {
        run(island, &gravity(FRAME), 0.5);
    }
    for i in 0..whole.bodies[0].particles.len() {
        let off = particles(&whole).position(i).distance(particles(&torn).position(i));
        assert!(off < 1e-4, "particle {i} is {off} m off");
    }
}

/// A sheet without overlong sticks does not tear.
#[test]
fn nothing_tears_below_the_limit() {
    let mut island = Island::of_body(sheet(20, 20));
    run(&mut island, &gravity(FRAME), 0.3);
    let body = &mut island.bodies[0];
    let before = body.clone();
    assert!(body.tear(&TearLimits::default()).expect("can tear").is_none());
    assert_eq!(body.particles, before.particles);
    assert!(std::sync::Arc::ptr_eq(&body.topology, &before.topology));
}

/// A sheet that is pulled apart at two edges tears from side to side, and comes to rest in two pieces.
#[test]
fn a_sheet_that_is_pulled_apart_tears_across() {
    let cloth = ClothBuilder::new(1.0, 1.0, 24, 24)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_where(|column, _, _| column == 0 || column == 23);
    let settings = BodySettings { tethers: false, ..swept() };
    let mut island = Island::of_body(cloth.build(settings).expect("valid"));
    // Exactly in a plane, what has been crumpled could never unfold.
    let particles = &mut island.bodies[0].particles;
    for i in (0..particles.len()).filter(|&i| !particles.is_pinned(i)).collect::<Vec<_>>() {
        particles.set_position(i, particles.position(i) + Vec3::Z * (1e-4 * (i % 7) as f32));
    }
    let limits = TearLimits { strain: 0.4, most: 8 };
    let faces = island.bodies[0].topology.faces().len();
    let mut pulled = 0.0;
    while island.bodies.len() == 1 && pulled < 1.2 {
        pulled += 0.002;
        let particles = &mut island.bodies[0].particles;
        for i in (0..particles.len()).filter(|&i| i % 24 == 23 && particles.is_pinned(i)).collect::<Vec<_>>()
        {
            particles.set_pin_target(i, particles.position(i) + Vec3::X * 0.002);
        }
        step(&mut island, &weightless(FRAME)).expect("a good step");
        if let Some(torn) = island.bodies[0].tear(&limits).expect("can tear") {
            island.bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
        }
    }
    println!("law: a sheet of 1 m came apart when pulled by {pulled} m, at a limit of {} m", limits.strain);
    assert!(pulled > 0.5 * limits.strain && pulled < 2.0 * limits.strain, "{pulled}");
    assert_eq!(island.bodies.iter().map(|body| body.topology.faces().len()).sum::<usize>(), faces);
    island.bodies.iter().for_each(assert_manifold);
    run(&mut island, &weightless(FRAME), 2.0);
    let greatest =
        island.bodies.iter().map(|b| measure::stretch(&b.particles, &b.topology).max).fold(0.0, f64::max);
    assert!(greatest < 0.4, "the pull is gone: {greatest}");
}

/// A torn rope becomes two ropes, with as many links in all as before.
#[test]
fn a_rope_tears_into_two_ropes() {
    let rope = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y, 41).pin_start();
    let mut island = Island::of_body(
        rope.build(BodySettings { tethers: false, ..BodySettings::default() }).expect("valid"),
    );
    let body = &mut island.bodies[0];
    let links = body.topology.segments().len();
    let mass = measure::mass(&body.particles);
    let end = body.particles.len() - 1;
    body.particles.set_position(end, body.particles.position(end) + Vec3::NEG_Y * 0.05);
    let torn = body.tear(&TearLimits::default()).expect("can tear").expect("tears");
    assert_eq!((torn.sticks.len(), torn.pieces.len()), (1, 1));
    island.bodies.extend(torn.pieces.into_iter().map(|piece| piece.body));
    assert_eq!(island.bodies.iter().map(|body| body.topology.segments().len()).sum::<usize>(), links);
    let masses: f64 = island.bodies.iter().map(|body| measure::mass(&body.particles)).sum();
    assert!((masses - mass).abs() < 1e-5 * mass);
    let cut = cut(
        &mut island.bodies[0],
        &[[Vec3::new(-1.0, -0.51, -1.0), Vec3::new(3.0, -0.51, -1.0), Vec3::new(-1.0, -0.51, 3.0)]],
    );
    assert_eq!(cut.map(|torn| torn.pieces.len()), Some(1));
}

/// A torn curtain gives the same bits on every instruction set and any number of threads.
#[test]
fn torn_cloth_moves_to_the_same_bits_everywhere() {
    let torn = |isa: Isa, take: &dyn Fn(&mut Island)| {
        let cloth = ClothBuilder::new(2.0, 2.0, 130, 40)
            .placed(Vec3::new(-1.0, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top);
        let mut body = cloth.build(swept()).expect("valid");
        cut(&mut body, &blade(Vec3::new(-0.5, 1.3, 0.0), Vec3::new(0.9, 0.9, 0.0))).expect("opens");
        cut(&mut body, &down(0.3)).expect("opens");
        let mut island = Island { isa, ..Island::of_body(body) };
        for _ in 0..30 {
            take(&mut island);
        }
        let mut hasher = StateHasher::new();
        hasher.particles(&island.bodies[0].particles);
        hasher.finish()
    };
    let environment =
        drape_solver::Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    let whole = |island: &mut Island| step(island, &environment).expect("a good step");
    let expected = torn(Isa::detected(), &whole);
    for isa in Isa::available() {
        assert_eq!(torn(isa, &whole), expected, "{isa:?}");
    }
    let shared = |island: &mut Island| {
        drape_solver::step_on(island, &environment, &Fresh(3)).expect("a good step");
    };
    assert_eq!(torn(Isa::detected(), &shared), expected);
    let staged = |island: &mut Island| step_staged(island, &environment);
    assert_eq!(torn(Isa::detected(), &staged), expected);
}
