//! Reads any bytes as a checkpoint: it is rejected, or restored into a world that continues.
//!
//! Reads the bytes twice: unchanged, and packed with a valid checksum, which the fuzzer does not find.

#![no_main]

use bevy_drape_script::checkpoint::Checkpoint;
use drape_fuzz::{checkpoint_head, pack, world};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    restore(bytes);
    let packed = pack(bytes);
    let length = (packed.len() as u64).to_le_bytes();
    restore(&[&checkpoint_head()[..], &length, &packed].concat());
});

fn restore(bytes: &[u8]) {
    let Ok(checkpoint) = Checkpoint::from_bytes(bytes) else { return };
    let again = checkpoint.to_bytes().expect("as large as it was");
    assert!(Checkpoint::from_bytes(&again).is_ok());
    let mut app = world();
    let _ = checkpoint.restore(app.world_mut());
    (0..3).for_each(|_| app.update());
}
