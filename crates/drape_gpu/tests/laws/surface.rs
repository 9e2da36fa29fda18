//! Vertices that are written on the GPU are those that the processor would write.

use drape_gpu::{BodyMesh, BodyVertices, GpuError, GpuWorld, SurfaceWriter, WeldedVertices};
use drape_solver::glam::{Mat3, Quat, Vec3};
use drape_solver::{Body, BodySettings, ClothBuilder};

use crate::common::*;

/// Words of a vertex: position, two of something else, normal.
const STRIDE: u32 = 8;
const NORMAL: u32 = 5;

/// Positions and normals by the processor, from positions in the world.
fn expected(body: &Body, places: &[Vec3], vertices: &BodyVertices) -> Vec<[Vec3; 2]> {
    let local: Vec<Vec3> =
        places.iter().map(|&place| vertices.to_local * (place - vertices.origin)).collect();
    let mut normals = vec![Vec3::ZERO; places.len()];
    for face in body.topology.faces() {
        let [a, b, c] = face.map(|corner| local[corner as usize]);
        face.iter().for_each(|&corner| normals[corner as usize] += (b - a).cross(c - a));
    }
    let side = vertices.to_local.determinant().signum();
    local.into_iter().zip(normals).map(|(place, normal)| [place, normal.normalize() * side]).collect()
}

/// The words of a new buffer of so many bytes to which `writer` has written.
fn written(writer: &SurfaceWriter, size: u64) -> Vec<f32> {
    write(writer, &vertex_buffer(size))
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn vertices_are_those_of_the_processor() {
    let flag = |n, origin| {
        let cloth = ClothBuilder::new(1.0, 0.7, n, n).placed(origin, Vec3::X, Vec3::NEG_Y).pin(0);
        cloth.build(BodySettings::default()).expect("valid")
    };
    let bodies = [flag(12, Vec3::splat(50.0)), flag(40, Vec3::new(-3.0, 2.0, 1.0))];
    let mut world = GpuWorld::new(gpu());
    world.keep_last_positions().expect("room");
    let ids = bodies.each_ref().map(|body| world.add(body).expect("a body"));
    run(&mut world, &gravity(), 20);
    let before = ids.map(|id| positions(&world, id));
    world.begin_frame();
    run(&mut world, &gravity(), 1);
    let after = ids.map(|id| positions(&world, id));

    let turned = Mat3::from_quat(Quat::from_rotation_y(0.7));
    let to_local = [turned, turned * Mat3::from_diagonal(Vec3::new(-0.5, 2.0, 1.0))];
    let firsts = [16, 16 + 144 * STRIDE];
    let vertices: Vec<BodyVertices> = (0..2)
        .map(|i| BodyVertices {
            body: ids[i],
            mesh: BodyMesh::Particles,
            to_local: to_local[i],
            origin: Vec3::new(1.0, 2.0, 3.0),
            vertex_count: bodies[i].particles.len() as u32,
            first_position: firsts[i],
            first_normal: firsts[i] + NORMAL,
            stride: STRIDE,
        })
        .collect();
    let size = u64::from(4 * (firsts[1] + 1600 * STRIDE));
    let words = write_bodies(&world, &vertices, 0.25, &vertex_buffer(size));
    let vector = |first: usize| Vec3::from_slice(&words[first..first + 3]);
    for i in 0..2 {
        let between: Vec<Vec3> = before[i].iter().zip(&after[i]).map(|(a, b)| a.lerp(*b, 0.25)).collect();
        for (k, [place, normal]) in expected(&bodies[i], &between, &vertices[i]).into_iter().enumerate() {
            let first = firsts[i] as usize + k * STRIDE as usize;
            assert!(
                (vector(first) - place).length() < 2e-5,
                "{i}, vertex {k}: {} instead of {place}",
                vector(first)
            );
            let written = vector(first + NORMAL as usize);
            assert!(
                (written - normal).length() < 1e-3,
                "{i}, vertex {k}: normal {written} instead of {normal}"
            );
            assert_eq!(words[first + 3..first + 5], [0.0; 2], "what lies between is left alone");
        }
    }
}

/// A frame's steps leave alone what the frame before is drawn from.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_new_frame_does_not_disturb_the_one_before() {
    let body = level(10, Vec3::ZERO, BodySettings::default());
    let (mut world, id) = world_of(&body);
    world.keep_last_positions().expect("room");
    run(&mut world, &gravity(), 3);
    let shown = positions(&world, id);
    let vertices = BodyVertices {
        body: id,
        mesh: BodyMesh::Particles,
        to_local: Mat3::IDENTITY,
        origin: Vec3::ZERO,
        vertex_count: 100,
        first_position: 0,
        first_normal: 3,
        stride: 6,
    };
    let mut writer = SurfaceWriter::new(gpu());
    let step = world.last_step().expect("a world that keeps positions");
    writer.set_bodies(&step, &[vertices]).expect("room");
    assert!(writer.set_step(&step, 1.0));
    world.begin_frame();
    run(&mut world, &gravity(), 2);
    let words = written(&writer, 100 * 24);
    for (k, place) in shown.iter().enumerate() {
        // A mixture of both ends may round.
        assert!(Vec3::from_slice(&words[6 * k..6 * k + 3]).distance(*place) < 1e-6);
    }

    // The same bodies in the next step.
    assert!(writer.set_step(&world.last_step().expect("stepped"), 1.0));
    let words = written(&writer, 100 * 24);
    for (k, place) in positions(&world, id).into_iter().enumerate() {
        assert!(Vec3::from_slice(&words[6 * k..6 * k + 3]).distance(place) < 1e-6);
    }
    // One of them has gone.
    world.remove(id).expect("a body");
    run(&mut world, &gravity(), 1);
    assert!(!writer.set_step(&world.last_step().expect("stepped"), 1.0), "it is not there");
    assert!(written(&writer, 100 * 24).iter().all(|&word| word == 0.0));
}

/// A mesh of a sheet's faces: every second vertex of a seam has the normal of its own side only, the others share theirs, and one vertex belongs to nothing.
struct Seamed {
    particles: Vec<Option<u32>>,
    normals: Vec<u32>,
    faces: Vec<[u32; 3]>,
}

impl Seamed {
    /// Parts the faces of `body` into those whose corners are all below particle `seam`, and the rest.
    fn new(body: &Body, seam: u32) -> Self {
        let count = body.particles.len() as u32;
        // A vertex without a particle, those of one side in reverse, those of the other side.
        let one = |particle: u32| count - particle;
        let other = |particle: u32| count + 1 + particle;
        let particles = [None].into_iter().chain((0..count).rev().map(Some)).chain((0..count).map(Some));
        // A normal that both sides share is that of the one side.
        let normals = (0..=count).chain(
            (0..count).map(|particle| if particle % 2 == 0 { one(particle) } else { other(particle) }),
        );
        let face = |face: &[u32; 3]| {
            let is_before = face.iter().all(|&corner| corner < seam);
            face.map(|corner| if is_before || corner % 2 == 0 { one(corner) } else { other(corner) })
        };
        let faces = body.topology.faces().iter().map(face).collect();
        Self { particles: particles.collect(), normals: normals.collect(), faces }
    }

    fn vertices(&self) -> WeldedVertices<'_> {
        WeldedVertices { particles: &self.particles, normals: &self.normals, faces: &self.faces }
    }

    /// Positions and normals by the processor; none for the vertex without a particle.
    fn expected(&self, places: &[Vec3]) -> Vec<Option<[Vec3; 2]>> {
        let place = |vertex: u32| self.particles[vertex as usize].map(|particle| places[particle as usize]);
        let mut normals = vec![Vec3::ZERO; self.particles.len()];
        for face in &self.faces {
            let [a, b, c] = face.map(|corner| place(corner).expect("a particle"));
            face.iter().for_each(|&corner| normals[corner as usize] += (b - a).cross(c - a));
        }
        let vertex = |(i, &leader): (usize, &u32)| {
            let normal = normals[leader as usize].try_normalize().unwrap_or(Vec3::Z);
            place(i as u32).map(|place| [place, normal])
        };
        self.normals.iter().enumerate().map(vertex).collect()
    }
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn vertices_of_a_mesh_lie_on_their_particles() {
    let cloth = ClothBuilder::new(1.0, 0.7, 9, 9).placed(Vec3::splat(20.0), Vec3::X, Vec3::NEG_Y).pin(0);
    let body = cloth.build(BodySettings::default()).expect("valid");
    let mesh = Seamed::new(&body, 45);
    let mut world = GpuWorld::new(gpu());
    world.keep_last_positions().expect("room");
    // So that neither particles nor pairs of words begin at zero.
    world.add(&level(12, Vec3::ZERO, BodySettings::default())).expect("a body");
    let id = world.add(&body).expect("a body");
    let welded = world.add_vertices(&mesh.vertices()).expect("a mesh");
    assert_eq!(world.add_vertices(&mesh.vertices()).expect("a mesh"), welded, "equal meshes share memory");
    run(&mut world, &gravity(), 20);
    // Mirrored: the faces of a mesh look outwards in its own coordinates.
    let mirror = Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0));
    let origin = Vec3::splat(20.0);
    let vertices = BodyVertices {
        body: id,
        mesh: BodyMesh::Welded(welded),
        to_local: mirror,
        origin,
        vertex_count: welded.vertex_count(),
        first_position: 0,
        first_normal: NORMAL,
        stride: STRIDE,
    };
    let mut writer = SurfaceWriter::new(gpu());
    let step = world.last_step().expect("stepped");
    writer.set_bodies(&step, &[vertices]).expect("room");
    assert!(writer.set_step(&step, 1.0));
    let words = written(&writer, u64::from(4 * STRIDE * welded.vertex_count()));
    let places: Vec<Vec3> =
        positions(&world, id).into_iter().map(|place| mirror * (place - origin)).collect();
    for (i, expected) in mesh.expected(&places).into_iter().enumerate() {
        let first = i * STRIDE as usize;
        let written = [first, first + NORMAL as usize].map(|word| Vec3::from_slice(&words[word..word + 3]));
        let [place, normal] = expected.unwrap_or([Vec3::ZERO; 2]);
        assert!(written[0].distance(place) < 2e-5, "vertex {i}: {} instead of {place}", written[0]);
        assert!(written[1].distance(normal) < 1e-3, "vertex {i}: normal {} instead of {normal}", written[1]);
    }

    // A body with fewer particles than the mesh asks for is left out.
    let small = world.add(&level(4, Vec3::ZERO, BodySettings::default())).expect("a body");
    run(&mut world, &gravity(), 1);
    let wrong = BodyVertices { body: small, ..vertices };
    // So is one that has other vertices than there is room for.
    let short = BodyVertices { vertex_count: welded.vertex_count() - 1, ..vertices };
    let step = world.last_step().expect("stepped");
    assert!(!writer.set_step(&step, 1.0), "a body has come: the places are others");
    writer.set_bodies(&step, &[wrong, short]).expect("room");
    assert!(writer.set_step(&step, 1.0));
    assert!(written(&writer, 4096).iter().all(|&word| word == 0.0), "nothing is written");
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn meshes_that_name_what_they_have_not_are_refused() {
    let body = level(3, Vec3::ZERO, BodySettings::default());
    let good = Seamed::new(&body, 4);
    let mut world = GpuWorld::new(gpu());
    assert!(world.add_vertices(&good.vertices()).is_ok());
    let last = good.particles.len() as u32;
    let fewer = &good.normals[1..];
    let mut unknown = good.normals.clone();
    unknown[3] = last;
    let (beyond, without) = ([[1, 2, last]], [[1, 2, 0]]);
    let mut large = good.particles.clone();
    large[5] = Some(u32::MAX);
    for bad in [
        WeldedVertices { normals: fewer, ..good.vertices() },
        WeldedVertices { normals: &unknown, ..good.vertices() },
        WeldedVertices { faces: &beyond, ..good.vertices() },
        WeldedVertices { faces: &without, ..good.vertices() },
        WeldedVertices { particles: &large, ..good.vertices() },
    ] {
        assert!(matches!(world.add_vertices(&bad), Err(GpuError::Vertices(_))));
    }
}
