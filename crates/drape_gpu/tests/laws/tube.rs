//! Tubes around ropes: rings across the rope, never twisted, and lids.

use drape_gpu::{BodyMesh, BodyVertices, GpuError, GpuWorld, SurfaceWriter, TubeId, TubeVertices, wgpu};
use drape_solver::glam::{Mat3, Quat, Vec3};
use drape_solver::{Body, BodySettings};

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
            body,
            mesh: BodyMesh::Tube(tube),
            to_local: Mat3::from_quat(Quat::from_rotation_y(0.4)),
            origin: Vec3::new(3.0, 1.0, 0.0),
            vertex_count: tube.vertex_count(),
            first_position: 0,
            first_normal: 3,
            stride: STRIDE,
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
        let mut writer = SurfaceWriter::new(gpu());
        let step = self.world.last_step().expect("stepped");
        writer.set_bodies(&step, &[self.vertices]).expect("room");
        assert!(writer.set_step(&step, 1.0));
        let words = write(&writer, &self.target);
        let vertices = words.chunks_exact(STRIDE as usize);
        (
            centres,
            vertices.map(|words| [0, 3].map(|first| Vec3::from_slice(&words[first..first + 3]))).collect(),
        )
    }
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
fn lids_close_the_ends_of_a_tube() {
    let (centres, vertices) = Scene::new().step();
    let tangents = tangents(&centres);
    let last = centres.len() - 1;
    let lids = &vertices[centres.len() * RING..];
    assert_eq!(lids.len(), 2 * (RING + 1));
    for (lid, ring, side) in [(&lids[..=RING], 0, -1.0), (&lids[RING + 1..], last, 1.0)] {
        for (corner, [place, normal]) in lid.iter().enumerate() {
            let expected = if corner < RING { vertices[ring * RING + corner][0] } else { centres[ring] };
            assert!(place.distance(expected) < 1e-5, "corner {corner} of ring {ring} is at {place}");
            assert!(normal.distance(tangents[ring] * side) < 1e-3, "the lid looks outwards");
        }
    }
}

/// A rope that is turned round meanwhile, and one whose particles are all in one place, have tubes without a hole in them.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_rope_without_a_direction_has_a_tube() {
    let here = Vec3::splat(2.0);
    let body = joined(&[here; 70], &[0.0; 70], &[], bare());
    let (mut world, id) = world_of(&body);
    world.keep_last_positions().expect("room");
    let particles: Vec<u32> = (0..70).collect();
    let tube =
        world.add_tube(&TubeVertices { particles: &particles, sides: 3, radius: RADIUS }).expect("a tube");
    run(&mut world, &gravity(), 1);
    let vertices = BodyVertices {
        body: id,
        mesh: BodyMesh::Tube(tube),
        to_local: Mat3::IDENTITY,
        origin: Vec3::ZERO,
        vertex_count: tube.vertex_count(),
        first_position: 0,
        first_normal: 3,
        stride: STRIDE,
    };
    let mut writer = SurfaceWriter::new(gpu());
    let step = world.last_step().expect("stepped");
    writer.set_bodies(&step, &[vertices]).expect("room");
    assert!(writer.set_step(&step, 1.0));
    let words = write(&writer, &vertex_buffer(u64::from(4 * STRIDE * tube.vertex_count())));
    for words in words.chunks_exact(STRIDE as usize) {
        let [place, normal] = [0, 3].map(|first| Vec3::from_slice(&words[first..first + 3]));
        assert!(place.distance(here) < RADIUS + 1e-5 && (normal.length() - 1.0).abs() < 1e-3);
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
