//! Functions that the fuzz targets and the example that writes their seeds share.

use std::io::{Read, Write};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape_script::checkpoint;
use lz4_flex::frame::{FrameDecoder, FrameEncoder, FrameInfo};

/// The head of a checkpoint, up to its length.
pub fn checkpoint_head() -> Vec<u8> {
    [&checkpoint::MAGIC[..], &checkpoint::VERSION.to_le_bytes()].concat()
}

/// The head of a recording, up to its first packet.
pub const RECORDING: &[u8] = b"DRAPEREC\x01\0\0\0";

/// A world with a cloth, a ball and an obstacle, after one step.
pub fn world() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(16, 9).with_pins(ClothPins::TopCorners));
    app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.0, 1.0)));
    app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -2.0, 0.0)));
    app.update();
    app.update();
    app
}

/// Compresses like the library, with a valid checksum.
pub fn pack(plain: &[u8]) -> Vec<u8> {
    let info = FrameInfo::new().content_checksum(true);
    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
    encoder.write_all(plain).expect("memory");
    encoder.finish().expect("memory")
}

/// Decompresses [packed](pack) bytes.
pub fn unpack(packed: &[u8]) -> Vec<u8> {
    let mut plain = Vec::new();
    FrameDecoder::new(packed).read_to_end(&mut plain).expect("a frame of the library");
    plain
}
