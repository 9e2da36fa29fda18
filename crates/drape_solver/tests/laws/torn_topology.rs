//! Torn bodies come back from plain numbers as they were: topology and next steps, to the last bit.

use drape_solver::glam::{Vec2, Vec3};
use drape_solver::{
    BendingFriction, BendingRigidity, Body, BodyContext, BodySettings, ClothBuilder, ClothMaterial, Edge,
    Island, MeshClothBuilder, Particles, RopeBuilder, StateHasher, TearLimits, Topology, TornTopology,
};

use crate::common::*;

/// A sheet of 1 m x 1 m in the XY plane around the origin, with pins and stiff threads that take a set.
fn sheet(columns: u32, rows: u32, is_mesh: bool) -> Body {
    let material = ClothMaterial {
        bending_rigidity: BendingRigidity::isotropic(1e-4),
        bending_friction: BendingFriction::isotropic(1e-3),
        ..ClothMaterial::default()
    };
    let settings = BodySettings { substeps: 4, ..BodySettings::default() };
    let grid = ClothBuilder::new(1.0, 1.0, columns, rows)
        .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
        .material(material)
        .pin_edge(Edge::Top)
        .build(settings)
        .expect("valid");
    if !is_mesh {
        return grid;
    }
    let places: Vec<Vec3> = grid.particles.positions().collect();
    let mesh = MeshClothBuilder::new(places, grid.topology.faces().to_vec()).material(material);
    (0..columns).fold(mesh, MeshClothBuilder::pin).build(settings).expect("valid")
}

fn state_after(mut body: Body, steps: usize) -> u64 {
    body.context = BodyContext::default();
    let mut island = Island::of_body(body);
    for _ in 0..steps {
        drape_solver::step(&mut island, &gravity(FRAME)).expect("a valid step");
    }
    let mut hasher = StateHasher::new();
    island.bodies.iter().for_each(|body| _ = hasher.particles(&body.particles));
    hasher.finish()
}

/// Asserts that the body's topology comes back from its numbers.
fn assert_comes_back(body: &Body, whole: &Topology) -> Topology {
    let numbers = TornTopology::new(&body.topology, whole);
    let back = numbers.build(whole).expect("was valid");
    assert!(
        back == *body.topology,
        "{:?}, of a whole body of {:?}",
        first_difference(&back, &body.topology),
        whole.grid_size()
    );
    back
}

fn first_difference(a: &Topology, b: &Topology) -> String {
    let [a, b] = [a, b].map(|topology| format!("{topology:?}"));
    let place = a.bytes().zip(b.bytes()).position(|(a, b)| a != b).unwrap_or(0);
    let from = place.saturating_sub(200);
    format!("{} / {}", &a[from..(place + 80).min(a.len())], &b[from..(place + 80).min(b.len())])
}

/// Sheets of every layout, meshes and ropes, cut and torn at random: after each change the topology comes back, and the body of a
/// snapshot takes the same steps.
#[test]
fn what_tears_and_cuts_make_comes_back_from_its_numbers() {
    let mut dice = Dice::new(11);
    let whole = [
        sheet(40, 33, false),
        sheet(20, 17, false),
        sheet(3, 4, false),
        sheet(4, 60, false),
        sheet(18, 24, true),
        RopeBuilder::new(Vec3::new(-0.6, 0.0, 0.0), Vec3::new(0.6, 0.1, 0.0), 60)
            .build(BodySettings::default())
            .expect("valid"),
    ];
    let (mut changes, mut pieces) = (0, 0);
    for whole in whole.iter().flat_map(|whole| [whole; 12]) {
        let mut bodies = vec![whole.clone()];
        for round in 0..4 {
            let mut place = || Vec2::new(dice.about(0.7), dice.about(0.7)).extend(0.0);
            let (from, to) = (place(), place());
            let mut others = Vec::new();
            for body in &mut bodies {
                let torn = if round == 2 {
                    (0..body.particles.len()).for_each(|i| {
                        body.particles.set_position(i, body.particles.position(i) + dice.vector(0.02));
                    });
                    body.tear(&TearLimits { strain: 0.1, most: 6 })
                } else {
                    body.cut(&blade(from, to))
                };
                let Some(torn) = torn.expect("can be torn") else { continue };
                changes += 1;
                others.extend(torn.pieces.into_iter().map(|piece| piece.body));
                for body in core::iter::once(&*body).chain(&others) {
                    assert_comes_back(body, &whole.topology);
                }
            }
            pieces += others.len();
            bodies.append(&mut others);
        }
        for body in bodies {
            let topology = assert_comes_back(&body, &whole.topology);
            let particles =
                Particles::from_snapshot(&body.particles.snapshot(), &topology).expect("was valid");
            let back = Body { particles, topology: topology.into(), ..body.clone() };
            assert_eq!(state_after(back, 3), state_after(body, 3));
        }
    }
    println!("law: {changes} changes, {pieces} pieces");
    assert!(changes > 150 && pieces > 100);
}

/// A blade along a row of a flat sheet that ends in the middle of an edge: its end lies beside the faces by rounding, and the numbers
/// were refused.
#[test]
fn an_end_beside_a_face_by_rounding_comes_back() {
    for (columns, rows) in [(40, 33), (20, 17), (9, 7), (3, 4)] {
        for (row, part) in [(1, 0.31), (2, 0.5), (2, 0.77)] {
            for lean in [0.0, 0.2, -0.37, 0.9] {
                let mut body = sheet(columns, rows, false);
                let whole = body.topology.clone();
                let y = whole.rest_position((row * columns) as usize).y;
                let place = |x: f32| Vec3::new(x, y, 0.0);
                let (from, to) = (place(-0.7), place(-0.5 + (1.0 + part) / (columns - 1) as f32));
                let wide = Vec3::new(0.0, lean, 1.0);
                body.cut(&wide_blade(from, to, wide)).expect("can be cut");
                assert_comes_back(&body, &whole);
            }
        }
    }
}
