//! Vertices that are written on the GPU are those that the processor would write.

use drape_gpu::{BodyVertices, GpuWorld, SurfaceWriter, wgpu};
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

/// The words of a buffer of so many bytes to which `writer` has written.
fn written(writer: &SurfaceWriter, size: u64) -> Vec<f32> {
    let device = gpu().device();
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let target = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let staging = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    writer.encode(&mut encoder, &target);
    encoder.copy_buffer_to_buffer(&target, 0, &staging, 0, size);
    gpu().queue().submit([encoder.finish()]);
    let (sender, mapped) = std::sync::mpsc::channel();
    staging.slice(..).map_async(wgpu::MapMode::Read, move |result| sender.send(result).expect("heard"));
    gpu().wait().expect("a device");
    mapped.recv().expect("sent").expect("mapped");
    let view = staging.slice(..).get_mapped_range().expect("mapped");
    view.chunks_exact(4).map(|word| f32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
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
            to_local: to_local[i],
            origin: Vec3::new(1.0, 2.0, 3.0),
            fraction: 0.25,
            first_position: firsts[i],
            first_normal: firsts[i] + NORMAL,
            stride: STRIDE,
        })
        .collect();
    let size = u64::from(4 * (firsts[1] + 1600 * STRIDE));
    let mut writer = SurfaceWriter::new(gpu());
    writer
        .set_bodies(&world.last_step().expect("a world that keeps positions"), &vertices)
        .expect("a world that keeps positions");

    let words = written(&writer, size);
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
        to_local: Mat3::IDENTITY,
        origin: Vec3::ZERO,
        fraction: 1.0,
        first_position: 0,
        first_normal: 3,
        stride: 6,
    };
    let mut writer = SurfaceWriter::new(gpu());
    writer.set_bodies(&world.last_step().expect("a world that keeps positions"), &[vertices]).expect("room");
    world.begin_frame();
    run(&mut world, &gravity(), 2);
    let words = written(&writer, 100 * 24);
    for (k, place) in shown.iter().enumerate() {
        // A mixture of both ends may round.
        assert!(Vec3::from_slice(&words[6 * k..6 * k + 3]).distance(*place) < 1e-6);
    }
}
