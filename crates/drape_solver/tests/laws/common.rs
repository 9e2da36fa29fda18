//! Scenes, measures and assertions that the tests share.

use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::splitmix::SplitMix64;
use drape_solver::state::measure;
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Isa, Island,
    MeshClothBuilder, Obstacle, Particles, Placement, Quality, RigidBody, SelfContact, Shape, StateHasher,
    StickKind, StickMaterial, StickProjection, StructuralSolve, TopologyBuilder, step,
};

/// Standard gravity of the tests in m/s^2.
pub const G: f32 = 9.81;

/// Both solvers of structural sticks.
pub const BOTH: [StructuralSolve; 2] = [StructuralSolve::Sweeps, StructuralSolve::Lines];

/// Each of the cases with each of the others.
pub fn each_with<A: Clone, B>(
    cases: impl IntoIterator<Item = A>,
    others: impl IntoIterator<Item = B> + Clone,
) -> impl Iterator<Item = (A, B)> {
    cases.into_iter().flat_map(move |case| others.clone().into_iter().map(move |other| (case.clone(), other)))
}

/// Settings of both solvers: the default swept, the default, and high quality.
pub fn settings_of_both() -> [BodySettings; 3] {
    [swept(), BodySettings::default(), Quality::High.into()]
}

/// The default settings, but swept.
pub fn swept() -> BodySettings {
    BodySettings { structural: StructuralSolve::Sweeps, ..BodySettings::default() }
}

/// A frame of a 60 Hz game in seconds.
pub const FRAME: f32 = 1.0 / 60.0;

/// `size`, or `small` under Miri, which takes some thousand times as long.
pub fn unless_miri<T>(size: T, small: T) -> T {
    if cfg!(miri) { small } else { size }
}

/// Settings with every feature off, for tests to switch on.
pub fn bare() -> BodySettings {
    BodySettings {
        substeps: 1,
        iterations: 1,
        tolerance: 0.0,
        drag: 0.0,
        friction: 0.0,
        static_friction: 0.0,
        thickness: 0.0,
        projection: StickProjection::Exact,
        structural: StructuralSolve::Sweeps,
        tethers: false,
        self_contact: SelfContact::Off,
    }
}

/// Gravity and nothing else, in steps of `dt` seconds.
pub fn gravity(dt: f32) -> Environment {
    Environment { dt, gravity: Vec3::NEG_Y * G, ..Environment::default() }
}

/// No gravity, in steps of `dt` seconds.
pub fn weightless(dt: f32) -> Environment {
    Environment { dt, gravity: Vec3::ZERO, ..Environment::default() }
}

/// Loose particles of 1 kg at `positions`.
pub fn loose(positions: &[Vec3], settings: BodySettings) -> Body {
    joined(positions, &vec![1.0; positions.len()], &[], settings)
}

/// Particles with these inverse masses, joined by rigid sticks at their distances.
pub fn joined(
    positions: &[Vec3],
    inverse_masses: &[f32],
    sticks: &[[u32; 2]],
    settings: BodySettings,
) -> Body {
    joined_by(StickMaterial::rigid(StickKind::Structural), positions, inverse_masses, sticks, settings)
}

/// Particles joined by sticks of `material`.
pub fn joined_by(
    material: StickMaterial,
    positions: &[Vec3],
    inverse_masses: &[f32],
    sticks: &[[u32; 2]],
    settings: BodySettings,
) -> Body {
    let particles = Particles::new(Vec3::ZERO, positions, inverse_masses).expect("valid particles");
    let mut builder = TopologyBuilder::new(positions);
    builder.family(material, sticks.iter().copied()).expect("valid sticks");
    Body::new(particles, Arc::new(builder.build().expect("valid topology")), settings)
}

/// A cloth of squares as a mesh, with its pins.
pub fn mesh_of(cloth: ClothBuilder, material: ClothMaterial, settings: BodySettings) -> Body {
    let (particles, topology) = cloth.build_parts().expect("valid");
    let places = particles.positions().collect();
    let pins = (0..particles.len()).filter(|&i| particles.is_pinned(i)).map(|i| i as u32);
    let mesh = MeshClothBuilder::new(places, topology.faces().to_vec()).material(material);
    pins.fold(mesh, MeshClothBuilder::pin).build(settings).expect("valid")
}

/// A ball with no friction, drag or rolling resistance.
pub fn smooth(radius: f32, mass: f32) -> BallMaterial {
    BallMaterial { radius, mass, friction: 0.0, rolling_resistance: 0.0, ..BallMaterial::default() }
}

/// A ball with valid values.
pub fn ball(material: BallMaterial, position: Vec3, velocity: Vec3) -> Ball {
    Ball::new(material, position, velocity).expect("a valid ball")
}

/// An obstacle with valid values.
pub fn obstacle(shape: Shape, at: Vec3, friction: f32) -> Obstacle {
    Obstacle::new(shape, Placement::at(at), friction).expect("a valid obstacle")
}

/// Ground without friction.
pub fn ice() -> Obstacle {
    obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::ZERO, 0.0)
}

/// Steps through `seconds` (two steps under Miri), and calls `look` after each step.
pub fn run_with(
    island: &mut Island,
    environment: &Environment,
    seconds: f32,
    mut look: impl FnMut(&Island, usize),
) {
    let steps = (seconds / environment.dt).round() as usize;
    for index in 0..unless_miri(steps, steps.min(2)) {
        step(island, environment).expect("a good step");
        look(island, index);
    }
}

/// Steps through `seconds`.
pub fn run(island: &mut Island, environment: &Environment, seconds: f32) {
    run_with(island, environment, seconds, |_, _| {});
}

/// The particles of the island's only body.
pub fn particles(island: &Island) -> &Particles {
    &island.bodies[0].particles
}

/// Greatest speed of the island's first body in m/s.
pub fn greatest_speed(island: &Island) -> f32 {
    particles(island).velocities().map(Vec3::length).fold(0.0, f32::max)
}

/// Stretch of the island's first body.
pub fn stretch(island: &Island) -> measure::Stretch {
    measure::stretch(&island.bodies[0].particles, &island.bodies[0].topology)
}

/// Mean stretch of the island's first body, which falls for so many seconds.
pub fn stretch_in_motion(island: &mut Island, seconds: f32) -> f64 {
    let (mut sum, mut steps) = (0.0, 0);
    run_with(island, &gravity(FRAME), seconds, |island, _| {
        sum += stretch(island).rms;
        steps += 1;
    });
    sum / f64::from(steps)
}

/// Linear momentum of all bodies and balls in kg m/s.
pub fn momentum(island: &Island) -> DVec3 {
    let bodies: DVec3 = island.bodies.iter().map(|body| measure::momentum(&body.particles)).sum();
    let balls: DVec3 =
        island.balls.iter().map(|b| b.velocity().as_dvec3() * f64::from(b.material().mass)).sum();
    bodies + balls
}

/// Angular momentum of all bodies and balls about the world's origin in kg m^2/s, spin included.
pub fn angular_momentum(island: &Island) -> DVec3 {
    let bodies: DVec3 = island.bodies.iter().map(|body| measure::angular_momentum(&body.particles)).sum();
    let balls = island.balls.iter().map(|b| {
        let (mass, radius) = (f64::from(b.material().mass), f64::from(b.material().radius));
        let orbit = b.position().as_dvec3().cross(b.velocity().as_dvec3()) * mass;
        orbit + b.spin().as_dvec3() * (0.4 * mass * radius * radius)
    });
    bodies + balls.sum::<DVec3>()
}

/// Kinetic energy of all bodies and balls in joules.
pub fn kinetic_energy(island: &Island) -> f64 {
    let bodies: f64 = island.bodies.iter().map(|body| measure::kinetic_energy(&body.particles)).sum();
    bodies + island.balls.iter().map(|b| f64::from(b.kinetic_energy())).sum::<f64>()
}

/// Half the side of a box in metres.
pub const HALF: f32 = 0.15;

/// The motion of a solid box that is at rest.
pub fn cube(mass: f32) -> RigidBody {
    let side = 2.0 * HALF;
    RigidBody::new(mass, Vec3::splat(mass * side * side / 6.0)).expect("a valid body")
}

/// The same in flight at `velocity` (m/s), without spin.
pub fn flying_cube(mass: f32, velocity: Vec3) -> RigidBody {
    let mut body = cube(mass);
    body.velocity = velocity;
    body
}

/// Momentum of a rigid body in kg m/s.
pub fn momentum_of(body: RigidBody) -> DVec3 {
    body.velocity.as_dvec3() * f64::from(body.mass())
}

/// Angular momentum of a rigid body about the world's origin in kg m^2/s.
pub fn angular_momentum_of(body: RigidBody, placement: Placement) -> DVec3 {
    let orbit = placement.translation.as_dvec3().cross(momentum_of(body));
    orbit + body.angular_momentum(placement).as_dvec3()
}

/// Asserts that `found` differs from `expected` by at most the part `part` of it.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, part: f64) {
    let error = (found - expected).abs();
    assert!(error <= part * expected.abs(), "{what}: {found} is not within {part} of {expected}");
}

/// Prints the expected and the measured value of the law `name`, and asserts that they differ by at most the part `part`.
#[track_caller]
pub fn law(name: &str, measured: f64, expected: f64, part: f64) {
    let error = (measured - expected) / expected;
    println!(
        "law: {name}: measured {measured:.6}, expected {expected:.6}, off by {error:+.1e} of {part:.1e}"
    );
    assert!(error.abs() <= part, "{name}: {measured} is not within {part} of {expected}");
}

/// Prints the error of a law, which should be 0, and asserts that it is at most `tolerance`.
#[track_caller]
pub fn law_of_error(name: &str, error: f64, tolerance: f64) {
    println!("law: {name}: measured {error:.1e}, expected 0, within {tolerance:.1e}");
    assert!(error.abs() <= tolerance, "{name}: {error} is more than {tolerance}");
}

/// Centre of mass of the free particles in metres.
pub fn centre_of_mass(particles: &Particles) -> DVec3 {
    let masses = (0..particles.len()).filter(|&i| !particles.is_pinned(i)).map(|i| {
        let mass = 1.0 / f64::from(particles.inverse_mass(i));
        let place = particles.origin().as_dvec3() + particles.local_position(i).as_dvec3();
        (mass, place * mass)
    });
    let (mass, moment) = masses.fold((0.0, DVec3::ZERO), |(m, p), (mass, moment)| (m + mass, p + moment));
    moment / mass
}

/// Pseudorandom numbers from a seed, the same in every run.
pub struct Dice(SplitMix64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64(seed))
    }

    /// The next number from 0 to 1.
    pub fn unit(&mut self) -> f32 {
        (self.0.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// A number from `-half` to `half`.
    pub fn about(&mut self, half: f32) -> f32 {
        (2.0 * self.unit() - 1.0) * half
    }

    /// A vector with each component from `-half` to `half`.
    pub fn vector(&mut self, half: f32) -> Vec3 {
        Vec3::new(self.about(half), self.about(half), self.about(half))
    }
}

/// Vertices and faces of a sphere around `centre`, counter-clockwise seen from outside.
pub fn sphere(centre: Vec3, radius: f32, around: u32, down: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut places = vec![centre + Vec3::Y * radius];
    for row in 1..down {
        for column in 0..around {
            let (polar, azimuth) = (
                std::f32::consts::PI * row as f32 / down as f32,
                std::f32::consts::TAU * column as f32 / around as f32,
            );
            let way = Vec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos());
            places.push(centre + way * radius);
        }
    }
    places.push(centre - Vec3::Y * radius);
    let last = places.len() as u32 - 1;
    let at = |row: u32, column: u32| 1 + (row - 1) * around + column % around;
    let mut faces = Vec::new();
    for column in 0..around {
        faces.push([0, at(1, column), at(1, column + 1)]);
        faces.push([last, at(down - 1, column + 1), at(down - 1, column)]);
        for row in 1..down - 1 {
            let [a, b, c, d] =
                [at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)];
            faces.extend([[a, d, b], [a, c, d]]);
        }
    }
    (places, faces)
}

/// The edges of some faces, each once, lower index first.
pub fn edges(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<[u32; 2]> = sides.map(|[p, q]| [p.min(q), p.max(q)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Runs a step stage by stage, like a schedule.
pub fn step_staged(island: &mut Island, environment: &Environment) {
    step::begin(island, environment).expect("valid");
    step::accumulate_forces(island, environment);
    step::detect_collisions(island, environment);
    for _ in 0..island.substeps() {
        step::integrate(island, environment);
        step::relax(island, environment);
        step::project_collisions(island, environment);
    }
    step::finish(island).expect("finite");
}

/// Runs a step at once.
pub fn step_whole(island: &mut Island, environment: &Environment) {
    step(island, environment).expect("a good step");
}

/// Takes one step of an island.
pub type TakeStep = fn(&mut Island, &Environment);

/// Asserts that a scene ends alike on every instruction set, and whether its steps are taken at once or stage by stage.
pub fn assert_same_on_all<T: PartialEq + Debug>(run: impl Fn(Isa, TakeStep) -> T) {
    let expected = run(Isa::detected(), step_whole);
    assert_eq!(run(Isa::detected(), step_staged), expected);
    for isa in Isa::available() {
        assert_eq!(run(isa, step_whole), expected, "{isa:?}");
    }
}

/// Asserts that a body in an animation goes on with the same bits when its state is restored in another one, which is made in
/// the same way. `animate` moves a body, whose particles have these places at rest, to a time in seconds.
pub fn assert_goes_on_when_restored(bodies: [Body; 2], animate: impl Fn(&mut Body, &[Vec3], f32)) {
    let [mut island, mut other] = bodies.map(Island::of_body);
    let rest = positions(&island.bodies[0]);
    let run = |island: &mut Island, steps: Range<usize>| {
        for index in steps {
            animate(&mut island.bodies[0], &rest, index as f32 * FRAME);
            step_whole(island, &gravity(FRAME));
        }
    };
    run(&mut island, 1..20);
    animate(&mut island.bodies[0], &rest, 20.0 * FRAME);
    let (state, still_for) = (island.bodies[0].particles.snapshot(), island.bodies[0].still_for());
    run(&mut island, 20..40);
    other.bodies[0].particles.restore(&state).expect("the same cloth");
    other.bodies[0].context.set_still_for(still_for);
    run(&mut other, 20..40);
    assert_eq!(hash(&other), hash(&island));
}

/// Signed distance from a tapered capsule: the farthest of the planes that touch the hull of two balls, in the plane of the axis.
pub fn to_tapered_capsule(p: Vec3, half_length: f32, bottom: f32, top: f32) -> f32 {
    let out = p.truncate().with_y(p.z).length();
    let planes = (-500..=500).map(|index| (index as f32 * core::f32::consts::PI / 1000.0).sin_cos());
    let beyond = planes.map(|(up, across)| {
        across * out + up * p.y - (bottom - up * half_length).max(top + up * half_length)
    });
    beyond.fold(f32::NEG_INFINITY, f32::max)
}

/// The bits of all bodies, then of all balls.
pub fn hash(island: &Island) -> u64 {
    let mut hasher = StateHasher::new();
    for body in &island.bodies {
        hasher.particles(&body.particles);
    }
    for ball in &island.balls {
        hasher.ball(ball);
    }
    hasher.finish()
}

/// Where the particles are (world, metres).
pub fn positions(body: &Body) -> Vec<Vec3> {
    body.particles.positions().collect()
}

/// A sheet of a metre and `n` x `n` particles that hangs from its top edge, 2 m above the ground.
pub fn hanging_sheet(n: u32) -> Body {
    ClothBuilder::new(1.0, 1.0, n, n)
        .placed(Vec3::new(-0.5, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid")
}

/// A level sheet of `n` x `n` particles and one metre, pinned at two corners or at an edge. For a `violent` start, particles
/// are displaced by up to half a spacing.
pub fn level_sheet(
    n: u32,
    corners: bool,
    material: ClothMaterial,
    settings: BodySettings,
    violent: bool,
) -> Island {
    let mut sheet = ClothBuilder::new(1.0, 1.0, n, n).placed(Vec3::ZERO, Vec3::X, Vec3::Z).material(material);
    sheet = if corners { sheet.pin(0).pin(n - 1) } else { sheet.pin_edge(Edge::Top) };
    let mut body = sheet.build(settings).expect("valid");
    if violent {
        shake(&mut body, 0.5 / (n - 1) as f32, u64::from(n));
    }
    Island::of_body(body)
}

/// Edges that pass through faces.
pub fn crossings(island: &Island) -> usize {
    measure::crossings(island.bodies.iter().map(|body| (&body.particles, &*body.topology)))
}

/// Displaces every free particle at random by up to `most` metres along each axis.
pub fn shake(body: &mut Body, most: f32, seed: u64) {
    let mut dice = Dice::new(seed);
    for i in 0..body.particles.len() {
        if !body.particles.is_pinned(i) {
            let moved = body.particles.position(i) + dice.vector(most);
            body.particles.set_position(i, moved);
        }
    }
}

/// A free cloth of a square metre and 0.2 kg, level, with 16 substeps.
pub fn free_cloth(thickness: f32) -> Body {
    let settings = BodySettings { substeps: 16, iterations: 4, friction: 0.5, thickness, ..bare() };
    let material = ClothMaterial { areal_density: 0.2, damping: 0.0, ..ClothMaterial::default() };
    ClothBuilder::new(1.0, 1.0, 17, 17).material(material).build(settings).expect("a valid cloth")
}

/// Mean position of all particles in metres.
pub fn centre(body: &Body) -> Vec3 {
    let particles = &body.particles;
    (0..particles.len()).map(|i| particles.position(i)).sum::<Vec3>() / particles.len() as f32
}

/// The direction along the first row of a [free cloth](free_cloth).
pub fn along(body: &Body) -> Vec3 {
    (body.particles.position(1) - body.particles.position(0)).normalize()
}

/// The normal of a [free cloth](free_cloth).
pub fn normal(body: &Body) -> Vec3 {
    along(body).cross(body.particles.position(17) - body.particles.position(0)).normalize()
}

/// A blade from one point to another, through sheets in the XY plane.
pub fn blade(from: Vec3, to: Vec3) -> [[Vec3; 3]; 2] {
    wide_blade(from, to, Vec3::Z * 2.0)
}

/// A blade from one point to another that reaches as far as `wide` to both sides.
pub fn wide_blade(from: Vec3, to: Vec3, wide: Vec3) -> [[Vec3; 3]; 2] {
    [[from - wide, to - wide, to + wide], [from - wide, to + wide, from + wide]]
}
