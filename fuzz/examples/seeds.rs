//! Writes the seeds of `checkpoint` and `recording`: files of the library, packed and unpacked, as the targets read them.
//!
//! Run `cargo +nightly run --example seeds` in this folder.

use std::fs;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::tear::CutCloth;
use bevy_drape_script::checkpoint::Checkpoint;
use bevy_drape_script::recording::{Header, RecordSteps};
use drape_fuzz::{RECORDING, checkpoint_head, unpack, world};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, steps) in [("start", 0), ("cut", 3), ("hit", 40)] {
        let mut app = world();
        if name == "cut" {
            let edge = |x: f32| [Vec3::new(x, 0.1, -9.0), Vec3::new(x, 0.1, 9.0)];
            app.world_mut().write_message(CutCloth::sweep(edge(-9.0), edge(9.0)));
        }
        (0..steps).for_each(|_| app.update());
        let bytes = Checkpoint::take(app.world_mut(), name).to_bytes()?;
        let plain = unpack(&bytes[checkpoint_head().len() + size_of::<u64>()..]);
        fs::write(format!("seeds/checkpoint/{name}"), bytes)?;
        fs::write(format!("seeds/checkpoint/{name}.plain"), plain)?;
    }
    for (name, steps) in [("short", 3), ("long", 70)] {
        let path = format!("seeds/recording/{name}");
        record(&path, steps)?;
        fs::write(format!("{path}.plain"), packets(&fs::read(&path)?))?;
    }
    Ok(())
}

/// Records a world in which a rope comes and goes, so that a block holds all kinds of entries.
fn record(path: &str, steps: usize) -> Result<(), Box<dyn std::error::Error>> {
    let mut app = world();
    RecordSteps::create(path, Header { scene: "seed".into(), dt: 1.0 / 64.0 })?.start(&mut app);
    app.update();
    let guest = app.world_mut().spawn(Rope::new(Vec3::ZERO, Vec3::Y, 3)).id();
    (1..steps).for_each(|_| app.update());
    app.world_mut().despawn(guest);
    app.update();
    RecordSteps::finish(app.world_mut())?;
    Ok(())
}

/// The packets of a recording, each after its length in two bytes.
fn packets(file: &[u8]) -> Vec<u8> {
    let mut rest = &file[RECORDING.len()..];
    let mut plain = Vec::new();
    while let Some((length, after)) = rest.split_first_chunk() {
        let (frame, after) = after.split_at(u32::from_le_bytes(*length) as usize);
        let packet = unpack(frame);
        plain.extend(u16::try_from(packet.len()).expect("a small packet").to_le_bytes());
        plain.extend(packet);
        rest = after;
    }
    plain
}
