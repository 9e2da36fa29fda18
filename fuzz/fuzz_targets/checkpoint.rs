//! Any bytes, read as a checkpoint: refused, or restored into a world that goes on.
//!
//! Once as they are; and once packed with good checksums, as the fuzzer does not find those.

#![no_main]

use std::io::Write;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape_script::checkpoint::Checkpoint;
use libfuzzer_sys::fuzz_target;
use lz4_flex::frame::FrameEncoder;

fuzz_target!(|bytes: &[u8]| {
    restore(bytes);
    let mut encoder = FrameEncoder::new(Vec::new());
    encoder.write_all(bytes).expect("memory");
    let packed = encoder.finish().expect("memory");
    let length = (packed.len() as u64).to_le_bytes();
    restore(&[b"DRAPESAV\x01\0\0\0", &length[..], &packed].concat());
});

fn restore(bytes: &[u8]) {
    let Ok(checkpoint) = Checkpoint::from_bytes(bytes) else { return };
    let again = checkpoint.to_bytes().expect("as large as it was");
    assert!(Checkpoint::from_bytes(&again).is_ok());
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(4, 4));
    app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.0, 1.0)));
    app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -2.0, 0.0)));
    app.update();
    app.update();
    let _ = checkpoint.restore(app.world_mut());
    (0..3).for_each(|_| app.update());
}
