//! Tubes around ropes: rings across the rope, never twisted, and caps.

use drape_gpu::{BodyMesh, BodyVertices, GpuBodyId, GpuError, GpuWorld, TubeId, TubeVertices, wgpu};
use drape_solver::glam::{Mat3, Quat, Vec3};
use drape_solver::{Body, BodySettings, RopeBuilder};

use crate::common::*;

const RADIUS: f32 = 0.02;
const SIDES: usize = 6;
/// Corners of a ring; the first is there twice.
const RING: usize = SIDES + 1;
/// Words of a vertex: position and normal.
const STRIDE: u32 = 6;

/// More particles than a workgroup has threads.
const PARTICLES: u32 = 150;

/// A rope that is wound up as a spring, so tightly that it bends by 40 degrees from link to link, and stays so.
fn spring() -> Body {
    let place = |i: u32| {
        let angle = 0.7 * i as f32;
        Vec3::new(3.0 + 0.1 * angle.cos(), 1.0 - 0.01 * i as f32, 0.1 * angle.sin())
    };
    let places: Vec<Vec3> = (0..PARTICLES).map(place).collect();
    joined(&places, &[0.0; PARTICLES as usize], &[], bare())
}

/// A world with a spring in it that keeps positions, and a tube around all particles in reverse.
struct Scene {
    world: GpuWorld,
    vertices: BodyVertices,
    target: wgpu::Buffer,
}

impl Scene {
    fn new() -> Self {
        let mut world = GpuWorld::new(gpu());
        world.keep_last_positions().expect("room");
        // So that neither particles nor pairs of words begin at zero.
        world.add(&level(12, Vec3::ZERO, BodySettings::default())).expect("a body");
        let body = world.add(&spring()).expect("a body");
        let particles: Vec<u32> = (0..PARTICLES).rev().collect();
        let tube = TubeVertices { particles: &particles, sides: SIDES as u32, radius: RADIUS };
        let tube = world.add_tube(&tube).expect("a tube");
        let vertices = BodyVertices {
            to_local: Mat3::from_quat(Quat::from_rotation_y(0.4)),
            origin: Vec3::new(3.0, 1.0, 0.0),
            ..alone(body, tube)
        };
        let target = vertex_buffer(u64::from(4 * STRIDE * tube.vertex_count()));
        Self { world, vertices, target }
    }

    /// Takes a step; returns the centres of the rings, and places and normals of the vertices.
    fn step(&mut self) -> (Vec<Vec3>, Vec<[Vec3; 2]>) {
        run(&mut self.world, &gravity(), 1);
        let BodyVertices { body, to_local, origin, .. } = self.vertices;
        let places = positions(&self.world, body).into_iter().rev();
        let centres = places.map(|place| to_local * (place - origin)).collect();
        (centres, split(&write_bodies(&self.world, &[self.vertices], 1.0, &self.target)))
    }
}

/// The vertices of a tube that is alone in its buffer.
fn alone(body: GpuBodyId, tube: TubeId) -> BodyVertices {
    BodyVertices {
        body,
        mesh: BodyMesh::Tube(tube),
        to_local: Mat3::IDENTITY,
        origin: Vec3::ZERO,
        vertex_count: tube.vertex_count(),
        first_position: 0,
        first_normal: 3,
        stride: STRIDE,
    }
}

/// Places and normals of vertices.
fn split(words: &[f32]) -> Vec<[Vec3; 2]> {
    let vertex = |words: &[f32]| [0, 3].map(|first| Vec3::from_slice(&words[first..first + 3]));
    words.chunks_exact(STRIDE as usize).map(vertex).collect()
}

/// The direction of a line at each of its points.
fn tangents(centres: &[Vec3]) -> Vec<Vec3> {
    let link = |i: usize| (centres[i + 1] - centres[i]).normalize();
    let last = centres.len() - 1;
    let mean = |i: usize| link(i.saturating_sub(1)) + link(i.min(last - 1));
    (0..=last).map(|i| mean(i).normalize()).collect()
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn rings_are_circles_across_the_rope_and_never_twisted() {
    let mut scene = Scene::new();
    let mut before: Option<Vec3> = None;
    for turn in 0..16 {
        // The spring turns, so that its first link passes both axes.
        scene.vertices.to_local = Mat3::from_rotation_y(0.3 * turn as f32);
        let (centres, vertices) = scene.step();
        let tangents = tangents(&centres);
        for (i, (&centre, &tangent)) in centres.iter().zip(&tangents).enumerate() {
            let ring = &vertices[i * RING..(i + 1) * RING];
            let mut middle = Vec3::ZERO;
            for (corner, [place, normal]) in ring.iter().enumerate() {
                let arm = *place - centre;
                assert!((arm.length() - RADIUS).abs() < 1e-5, "ring {i} has a radius of {}", arm.length());
                assert!(arm.dot(tangent).abs() < 2e-5, "ring {i} is askew by {}", arm.dot(tangent));
                assert!(normal.distance(arm / RADIUS) < 2e-3, "a normal of ring {i} is {normal}");
                middle += if corner > 0 { arm / SIDES as f32 } else { Vec3::ZERO };
            }
            assert!(middle.length() < 1e-5, "the corners of ring {i} go round");
            assert_eq!(ring[0], ring[SIDES], "the seam of the texture is closed");
            if i > 0 {
                let carried = Quat::from_rotation_arc(tangents[i - 1], tangent) * vertices[(i - 1) * RING][1];
                assert!(carried.distance(ring[0][1]) < 2e-3, "ring {i} is twisted");
            }
        }
        let across = vertices[0][1];
        assert!(before.is_none_or(|before| before.distance(across) < 0.4), "the tube spins about itself");
        before = Some(across);
    }
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn caps_close_the_ends_of_a_tube() {
    let (centres, vertices) = Scene::new().step();
    let tangents = tangents(&centres);
    let last = centres.len() - 1;
    let caps = &vertices[centres.len() * RING..];
    assert_eq!(caps.len(), 2 * (RING + 1));
    for (cap, ring, side) in [(&caps[..=RING], 0, -1.0), (&caps[RING + 1..], last, 1.0)] {
        for (corner, [place, normal]) in cap.iter().enumerate() {
            let expected = if corner < RING { vertices[ring * RING + corner][0] } else { centres[ring] };
            assert!(place.distance(expected) < 1e-5, "corner {corner} of ring {ring} is at {place}");
            assert!(normal.distance(tangents[ring] * side) < 1e-3, "the cap looks outwards");
        }
    }
}

/// Places and normals of the rings around each particle of a body at rest, written into a buffer that was filled with `old`.
fn rings_at_rest(places: &[Vec3], old: f32) -> Vec<[Vec3; 2]> {
    let count = places.len();
    let body = joined(places, &vec![0.0; count], &[], bare());
    let (mut world, id) = world_of(&body);
    world.keep_last_positions().expect("room");
    let particles: Vec<u32> = (0..count as u32).collect();
    let tube = TubeVertices { particles: &particles, sides: SIDES as u32, radius: RADIUS };
    let tube = world.add_tube(&tube).expect("a tube");
    run(&mut world, &gravity(), 1);
    let target = vertex_buffer(u64::from(4 * STRIDE * tube.vertex_count()));
    let words = vec![old.to_le_bytes(); (STRIDE * tube.vertex_count()) as usize];
    gpu().queue().write_buffer(&target, 0, words.as_flattened());
    let mut vertices = split(&write_bodies(&world, &[alone(id, tube)], 1.0, &target));
    vertices.truncate(count * RING);
    vertices
}

/// A rope whose particles are all in one place, and one that goes back the way that it came, have rings all the same, whatever the buffer held.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_rope_without_a_direction_has_a_tube() {
    let fold = |i: i32| Vec3::splat(2.0) + Vec3::new(0.1, 0.2, -0.1) * (3 - (i - 3).abs()) as f32;
    // The rings start from the vector that the buffer holds: here along the rope, then no number.
    let diagonal = |i: i32| Vec3::splat(0.1 * i as f32);
    for (places, old) in [
        (vec![Vec3::splat(2.0); 70], 0.0),
        ((0..7).map(fold).collect::<Vec<_>>(), 0.0),
        ((0..7).map(diagonal).collect(), 1.0 / 3.0_f32.sqrt()),
        ((0..7).map(diagonal).collect(), f32::NAN),
    ] {
        let vertices = rings_at_rest(&places, old);
        for (i, (ring, &centre)) in vertices.chunks_exact(RING).zip(&places).enumerate() {
            let arms: Vec<Vec3> = ring.iter().map(|[place, _]| *place - centre).collect();
            assert!(arms.iter().all(|arm| (arm.length() - RADIUS).abs() < 1e-5), "{old}, ring {i}: {arms:?}");
            // Round, not flat.
            let area: Vec3 = arms.windows(2).map(|pair| pair[0].cross(pair[1])).sum();
            let expected = SIDES as f32 * RADIUS * RADIUS * (core::f32::consts::TAU / SIDES as f32).sin();
            assert!((area.length() / expected - 1.0).abs() < 1e-2, "{old}, ring {i} has {area}");
            assert!(arms[..SIDES].iter().sum::<Vec3>().length() < 1e-5);
        }
    }
}

/// Sheets and tubes of one writer share a table: each finds its own.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn one_writer_writes_surfaces_and_tubes_between_two_steps() {
    let mut world = GpuWorld::new(gpu());
    world.keep_last_positions().expect("room");
    let rope = |x: f32, count| {
        let rope = RopeBuilder::new(Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, 1.0), count).pin_start();
        rope.build(BodySettings::default()).expect("valid")
    };
    let bodies = [rope(0.0, 20), level(9, Vec3::ZERO, BodySettings::default()), rope(2.0, 70)];
    let ids = bodies.each_ref().map(|body| world.add(body).expect("a body"));
    let meshes = bodies.each_ref().map(|body| {
        let particles: Vec<u32> = (0..body.particles.len() as u32).collect();
        let tube = TubeVertices { particles: &particles, sides: SIDES as u32, radius: RADIUS };
        let is_sheet = !body.topology.faces().is_empty();
        if is_sheet { BodyMesh::Particles } else { BodyMesh::Tube(world.add_tube(&tube).expect("a tube")) }
    });
    run(&mut world, &gravity(), 10);
    let before = ids.map(|id| positions(&world, id));
    run(&mut world, &gravity(), 1);
    let after = ids.map(|id| positions(&world, id));
    let mut first_vertex = 0;
    let vertices = [0, 1, 2].map(|i| {
        let vertex_count =
            meshes[i].vertex_count(bodies[i].particles.len() as u32).expect("enough particles");
        let first_position = STRIDE * first_vertex;
        first_vertex += vertex_count;
        BodyVertices {
            body: ids[i],
            mesh: meshes[i],
            to_local: Mat3::IDENTITY,
            origin: Vec3::ZERO,
            vertex_count,
            first_position,
            first_normal: first_position + 3,
            stride: STRIDE,
        }
    });
    let target = vertex_buffer(u64::from(4 * STRIDE * first_vertex));
    let words = write_bodies(&world, &vertices, 0.25, &target);
    for (i, vertices) in vertices.iter().enumerate() {
        let place =
            |vertex: usize| Vec3::from_slice(&words[vertices.first_position as usize + 6 * vertex..][..3]);
        for (k, (from, to)) in before[i].iter().zip(&after[i]).enumerate() {
            // A ring lies around its particle.
            let written = match meshes[i] {
                BodyMesh::Tube(_) => {
                    (0..SIDES).map(|side| place(k * RING + side)).sum::<Vec3>() / SIDES as f32
                }
                _ => place(k),
            };
            let expected = from.lerp(*to, 0.25);
            assert!(written.distance(expected) < 1e-4, "{i}, {k}: {written} instead of {expected}");
        }
        let way = before[i].iter().zip(&after[i]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(way > 0.01, "there is something to see between two steps: {way} m");
    }
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn tubes_that_are_none_are_refused_and_equal_ones_share_memory() {
    let mut world = GpuWorld::new(gpu());
    let good = TubeVertices { particles: &[0, 1, 2], sides: 3, radius: RADIUS };
    let mut add = |tube: TubeVertices| world.add_tube(&tube);
    let known: TubeId = add(good).expect("a tube");
    assert_eq!(known.vertex_count(), 5 * 4 + 2);
    assert_eq!(add(good).expect("a tube"), known);
    assert_ne!(add(TubeVertices { particles: &[2, 1, 0], ..good }).expect("a tube"), known);
    for bad in [
        TubeVertices { particles: &[0], ..good },
        TubeVertices { particles: &[0, u32::MAX], ..good },
        TubeVertices { sides: 2, ..good },
        TubeVertices { sides: u32::MAX, ..good },
        TubeVertices { radius: 0.0, ..good },
        TubeVertices { radius: f32::NAN, ..good },
    ] {
        assert!(matches!(add(bad), Err(GpuError::Vertices(_))), "{bad:?}");
    }
}
