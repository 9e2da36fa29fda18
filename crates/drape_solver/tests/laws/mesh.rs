//! Irregular meshes: the numbering of the vertices does not change the body.

use std::collections::HashMap;
use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, Environment, Isa, Island, Obstacle, Particles, Shape, StickKind, StickMaterial,
    StickProjection, TopologyBuilder, step,
};
use proptest::prelude::*;

use crate::common::*;
use crate::random::cases;

/// Vertices of a mesh in order, and its triangles' edges and the sticks across them.
struct Mesh {
    positions: Vec<Vec3>,
    edges: Vec<[u32; 2]>,
    bends: Vec<[u32; 2]>,
    faces: Vec<[u32; 3]>,
}

/// `side` x `side` vertices over 2 m x 2 m, displaced at random; each square is two triangles.
fn mesh(side: u32) -> Mesh {
    let mut dice = Dice::new(5);
    let spacing = 2.0 / (side - 1) as f32;
    let at = |column: u32, row: u32| row * side + column;
    let cells = |columns: u32, rows: u32| (0..rows).flat_map(move |row| (0..columns).map(move |c| (c, row)));
    let positions = cells(side, side).map(|(column, row)| {
        Vec3::new(column as f32 * spacing - 1.0, 1.0, row as f32 * spacing - 1.0) + dice.vector(0.2 * spacing)
    });
    let positions = positions.collect();
    let mut edges: Vec<[u32; 2]> = cells(side - 1, side).map(|(c, r)| [at(c, r), at(c + 1, r)]).collect();
    edges.extend(cells(side, side - 1).map(|(c, r)| [at(c, r), at(c, r + 1)]));
    edges.extend(cells(side - 1, side - 1).map(|(c, r)| [at(c, r), at(c + 1, r + 1)]));
    let bends = cells(side - 1, side - 1).map(|(c, r)| [at(c + 1, r), at(c, r + 1)]).collect();
    let triangles = |(c, r)| {
        let [a, b, c, d] = [at(c, r), at(c + 1, r), at(c, r + 1), at(c + 1, r + 1)];
        [[a, c, d], [a, d, b]]
    };
    let faces = cells(side - 1, side - 1).flat_map(triangles).collect();
    Mesh { positions, edges, bends, faces }
}

/// The mesh as a modeller may number it: `new[i]` is the number of vertex `i`.
fn numbered(mesh: &Mesh, new: &[u32]) -> Mesh {
    let mut positions = mesh.positions.clone();
    for (i, &to) in new.iter().enumerate() {
        positions[to as usize] = mesh.positions[i];
    }
    let renamed = |sticks: &[[u32; 2]]| sticks.iter().map(|s| s.map(|end| new[end as usize])).collect();
    let faces = mesh.faces.iter().map(|face| face.map(|corner| new[corner as usize])).collect();
    Mesh { positions, edges: renamed(&mesh.edges), bends: renamed(&mesh.bends), faces }
}

fn shuffled(count: usize) -> Vec<u32> {
    let mut dice = Dice::new(9);
    let mut order: Vec<u32> = (0..count as u32).collect();
    for i in (1..count).rev() {
        order.swap(i, (dice.unit() * (i + 1) as f32) as usize);
    }
    order
}

/// The mesh as a body. `inverse_mass` takes the number of the vertex, and is 0 for a pin.
fn body(mesh: &Mesh, inverse_mass: impl Fn(usize) -> f32, settings: BodySettings) -> Body {
    let masses: Vec<f32> = (0..mesh.positions.len()).map(inverse_mass).collect();
    let pins: Vec<u32> = (0..masses.len() as u32).filter(|&i| masses[i as usize] == 0.0).collect();
    let particles = Particles::new(Vec3::ZERO, &mesh.positions, &masses).expect("valid particles");
    let mut builder = TopologyBuilder::new(&mesh.positions);
    let soft = StickMaterial { stiffness: 0.3, ..StickMaterial::rigid(StickKind::Bend) };
    builder
        .family(StickMaterial::rigid(StickKind::Structural), mesh.edges.iter().copied())
        .and_then(|builder| builder.family(soft, mesh.bends.iter().copied()))
        .and_then(|builder| builder.faces(mesh.faces.iter().copied()))
        .and_then(|builder| builder.straight_tethers(&pins))
        .expect("valid sticks");
    Body::new(particles, Arc::new(builder.build().expect("valid topology")), settings)
}

/// A shuffled mesh of 900 uneven particles that falls on a sphere, hung from two of them.
fn falling(isa: Isa, settings: BodySettings) -> (Island, Environment) {
    let mesh = mesh(30);
    let order = shuffled(mesh.positions.len());
    let pins = [order[0] as usize, order[29] as usize];
    let mesh = numbered(&mesh, &order);
    // Some neighbours have the same mass, most do not.
    let masses = |i: usize| if pins.contains(&i) { 0.0 } else { 300.0 + (i % 5) as f32 * 40.0 };
    let sphere = obstacle(Shape::Sphere { radius: 0.5 }, Vec3::new(0.0, 0.3, 0.0), 0.5);
    let environment = Environment { obstacles: vec![Obstacle::ground(), sphere].into(), ..gravity(FRAME) };
    (Island { isa, ..Island::of_body(body(&mesh, masses, settings)) }, environment)
}

/// The hash of the mesh after a second.
pub fn hash_of_mesh(isa: Isa, settings: BodySettings) -> u64 {
    let (mut island, environment) = falling(isa, settings);
    run(&mut island, &environment, 1.0);
    hash(&island)
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for (projection, iterations) in [(StickProjection::Exact, 1), (StickProjection::SquareRootFree, 3)] {
        let settings = BodySettings { substeps: 4, iterations, projection, ..BodySettings::default() };
        let hashes: Vec<u64> = Isa::available().into_iter().map(|isa| hash_of_mesh(isa, settings)).collect();
        assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:x?}");
    }
}

#[test]
fn the_stages_one_by_one_are_the_step() {
    let settings = BodySettings { substeps: 4, iterations: 2, ..BodySettings::default() };
    let (mut whole, environment) = falling(Isa::detected(), settings);
    let (mut staged, _) = falling(Isa::detected(), settings);
    for _ in 0..60 {
        step(&mut whole, &environment).expect("finite");
        step_staged(&mut staged, &environment);
    }
    assert_eq!(hash(&whole), hash(&staged));
}

/// Sticks, tethers and faces keep their particles and lengths.
#[test]
fn a_mesh_keeps_the_numbers_of_its_vertices() {
    let mesh = numbered(&mesh(30), &shuffled(900));
    let body = body(&mesh, |i| if i == 7 { 0.0 } else { 1.0 }, bare());
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut wanted: HashMap<[u32; 2], f32> = HashMap::new();
    for &[a, b] in mesh.edges.iter().chain(&mesh.bends) {
        wanted.insert(sorted([a, b]), mesh.positions[a as usize].distance(mesh.positions[b as usize]));
    }
    let topology = &body.topology;
    for i in 0..topology.stick_count() {
        let length = wanted.remove(&sorted(topology.stick(i))).expect("one that was added, once");
        assert_eq!(topology.rest_length(i), length);
    }
    assert!(wanted.is_empty());
    assert_eq!(topology.faces(), mesh.faces);
    for (particle, pin, length) in topology.tethers() {
        assert_eq!(pin, 7);
        assert_eq!(length, mesh.positions[particle as usize].distance(mesh.positions[7]));
    }
    assert_eq!(topology.tethers().len(), 899);
    for batch in topology.batches() {
        let mut ends: Vec<u32> = batch.range().flat_map(|i| topology.stick(i)).collect();
        ends.sort_unstable();
        assert!(ends.windows(2).all(|pair| pair[0] != pair[1]), "a batch shares no particle");
    }
}

/// Positions, velocities, masses and pin targets go by the number of the vertex, before and after the first step, which
/// sorts particles into slots.
#[test]
fn a_mesh_keeps_the_state_of_its_vertices() {
    let mesh = numbered(&mesh(30), &shuffled(900));
    let pins = [3, 500, 899];
    let masses: Vec<f32> = (0..900).map(|i| if pins.contains(&i) { 0.0 } else { 1.0 + i as f32 }).collect();
    let slack = StickMaterial { stiffness: 0.0, ..StickMaterial::rigid(StickKind::Structural) };
    let mut body = joined_by(slack, &mesh.positions, &masses, &mesh.edges, bare());
    let velocity = |i: usize| Vec3::new(i as f32, 1.0, 0.0);
    (0..900).filter(|i| !pins.contains(i)).for_each(|i| body.particles.set_velocity(i, velocity(i)));
    body.particles.add_force(42, Vec3::Z * 1e6);
    let target = |i: usize| mesh.positions[i] + Vec3::Y * (1.0 + i as f32);
    pins.iter().for_each(|&i| body.particles.set_pin_target(i, target(i)));
    let mut island = Island::of_body(body);
    let dt = 1e-3;
    step(&mut island, &weightless(dt)).expect("a good step");
    for (i, &mass) in masses.iter().enumerate() {
        let particles = particles(&island);
        let (place, is_pin) = (particles.position(i), pins.contains(&i));
        assert_eq!(particles.is_pinned(i), is_pin);
        assert_eq!(particles.inverse_mass(i), mass);
        let gained = if i == 42 { Vec3::Z * (1e6 * mass * dt) } else { Vec3::ZERO };
        let expected = if is_pin { target(i) } else { mesh.positions[i] + (velocity(i) + gained) * dt };
        assert!(place.distance(expected) < 1e-4 * expected.length(), "{i}: {place} and not {expected}");
    }
    island.bodies[0].particles.set_position(42, Vec3::splat(9.0));
    assert_eq!(particles(&island).positions().position(|p| p == Vec3::splat(9.0)), Some(42));
}

/// A mesh in order and the same mesh shuffled hang alike.
#[test]
fn a_shuffled_mesh_hangs_as_the_mesh_in_order_does() {
    let settings = BodySettings { substeps: 8, drag: 1.0, ..bare() };
    let plain = mesh(24);
    let hung = |mesh: &Mesh, number: &dyn Fn(usize) -> usize| {
        let pins: Vec<usize> = (0..24).map(number).collect();
        let masses = |i: usize| if pins.contains(&i) { 0.0 } else { 576.0 };
        let mut island = Island::of_body(body(mesh, masses, settings));
        run(&mut island, &gravity(FRAME), 6.0);
        (0..576).map(|i| particles(&island).position(number(i))).collect::<Vec<_>>()
    };
    let in_order = hung(&plain, &|i| i);
    let order = shuffled(576);
    let other = hung(&numbered(&plain, &order), &|i| order[i] as usize);
    let height = |positions: &[Vec3]| positions.iter().map(|p| p.y).sum::<f32>() / positions.len() as f32;
    assert!((height(&in_order) - height(&other)).abs() < 0.02, "{} {}", height(&in_order), height(&other));
}

/// A free mesh with particles of any mass keeps its momentum.
#[test]
fn a_free_mesh_keeps_its_momentum() {
    let mesh = numbered(&mesh(30), &shuffled(900));
    let settings = BodySettings { substeps: 4, iterations: 2, ..bare() };
    let mut body = body(&mesh, |i| 200.0 + (i % 7) as f32 * 100.0, settings);
    let mut dice = Dice::new(1);
    (0..900).for_each(|i| body.particles.set_velocity(i, Vec3::X + dice.vector(0.5)));
    let mut island = Island::of_body(body);
    let before = momentum(&island);
    run_with(&mut island, &weightless(FRAME), 1.0, |island, index| {
        let error = (momentum(island) - before).length() / before.length();
        assert!(error < 1e-4, "{error} of the momentum is lost at step {index}");
    });
}

/// Each of many stretched dumbbells contracts about its own centre of mass, with either end the heavier. Checks each of
/// them, as errors may cancel in the sum.
#[test]
fn each_of_many_dumbbells_keeps_its_own_centre() {
    let count = 64;
    let rest: Vec<Vec3> = (0..2 * count).map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0)).collect();
    let inverse_masses: Vec<f32> =
        (0..2 * count).map(|i| if i / 2 % 2 == i % 2 { 1.0 } else { 0.25 }).collect();
    let sticks: Vec<[u32; 2]> = (0..count as u32).map(|k| [2 * k, 2 * k + 1]).collect();
    let mut body = joined(&rest, &inverse_masses, &sticks, bare());
    (0..count).for_each(|k| body.particles.set_position(2 * k + 1, rest[2 * k + 1] + Vec3::Y * 0.5));
    let start = body.particles.clone();
    let mut island = Island::of_body(body);
    run(&mut island, &weightless(FRAME), FRAME);
    let now = particles(&island);
    for k in 0..count {
        let [heavy, light] = if k % 2 == 0 { [2 * k + 1, 2 * k] } else { [2 * k, 2 * k + 1] };
        let centre = |p: &Particles| (p.position(heavy) * 4.0 + p.position(light)) / 5.0;
        assert!(centre(now).distance(centre(&start)) < 1e-5, "dumbbell {k} has gone to {}", centre(now));
        assert!((now.position(heavy).distance(now.position(light)) - 1.0).abs() < 1e-5);
    }
}

/// A hanging mesh gains no energy, and keeps its length.
#[test]
fn a_hanging_mesh_gains_no_energy_and_does_not_stretch() {
    for iterations in [1, 2] {
        let settings = BodySettings { substeps: 16, iterations, ..bare() };
        let (mut island, _) = falling(Isa::detected(), settings);
        let at_start: Vec<Vec3> = particles(&island).positions().collect();
        let energy = |island: &Island| {
            let particles = particles(island);
            measure::kinetic_energy(particles) + measure::potential_energy(particles, Vec3::NEG_Y * G)
        };
        let mass = measure::mass(particles(&island));
        let before = energy(&island);
        run_with(&mut island, &gravity(FRAME), 3.0, |island, index| {
            let gained = energy(island) - before;
            assert!(gained < 1e-3 * mass * f64::from(G) * 2.0, "{gained} J gained at step {index}");
        });
        let stretch = stretch(&island);
        assert!(stretch.rms < 0.1, "{}", stretch.rms);
        let pinned = (0..900).filter(|&i| particles(&island).is_pinned(i));
        for (i, pin) in pinned.map(|i| (i, particles(&island).position(i))) {
            assert_eq!(pin, at_start[i], "a pin stays");
        }
    }
}

proptest! {
    #![proptest_config(cases(24))]

    /// For any graph, each particle keeps its number and each stick its ends. A step stays finite, and gives the same bits
    /// on every instruction set.
    #[test]
    fn a_random_graph_keeps_its_numbers_and_its_bits(
        count in 256_u32..900,
        ends in proptest::collection::vec((any::<u32>(), any::<u32>()), 1..2000),
        nearby in any::<bool>(),
    ) {
        let mut dice = Dice::new(u64::from(count));
        let positions: Vec<Vec3> = (0..count).map(|_| dice.vector(1.0)).collect();
        let mut sticks: Vec<[u32; 2]> = ends
            .into_iter()
            .map(|(a, b)| [a % count, if nearby { (a % count + 1 + b % 40) % count } else { b % count }])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .filter(|[a, b]| a != b)
            .collect();
        sticks.sort_unstable();
        sticks.dedup();
        let masses: Vec<f32> = (0..count).map(|i| if i % 11 == 0 { 0.0 } else { 1.0 + (i % 3) as f32 }).collect();
        let settings = BodySettings { substeps: 2, iterations: 2, ..bare() };
        let start = joined(&positions, &masses, &sticks, settings);
        let mut found: Vec<[u32; 2]> = (0..start.topology.stick_count()).map(|i| start.topology.stick(i)).collect();
        found.sort_unstable();
        prop_assert_eq!(found, sticks);
        let mut hashes = Vec::new();
        for isa in Isa::available() {
            let mut island = Island { isa, ..Island::of_body(start.clone()) };
            step(&mut island, &weightless(FRAME)).expect("finite");
            for i in (0..count as usize).step_by(11) {
                prop_assert_eq!(particles(&island).position(i), positions[i], "pins stay");
            }
            hashes.push(hash(&island));
        }
        prop_assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]));
    }
}
