//! Reads any bytes as a recording: it is rejected, or every frame can be shown.
//!
//! Reads the bytes twice: unchanged, and packed with valid lengths and checksums, which the fuzzer does not find. Two bytes
//! give the number of bytes in the packet that follows, and so on.

#![no_main]

use bevy_drape_script::recording::{Recording, diff};
use drape_fuzz::{RECORDING, pack};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    show(bytes.to_vec());
    show(packed(bytes));
});

fn show(bytes: Vec<u8>) {
    let Ok(recording) = Recording::from_bytes(bytes) else { return };
    let mut cursor = recording.cursor();
    for index in (0..recording.frame_count()).rev() {
        let frame = cursor.seek(index).expect("a frame of a recording that was checked");
        for state in &frame.states {
            state.places(&recording.tracks()[state.track].kind);
        }
    }
    assert_eq!(diff(&recording, &recording).expect("frames that were checked"), None);
}

fn packed(mut bytes: &[u8]) -> Vec<u8> {
    let mut file = RECORDING.to_vec();
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let (packet, rest) = rest.split_at(rest.len().min(usize::from(u16::from_le_bytes(*length))));
        bytes = rest;
        let frame = pack(packet);
        file.extend((frame.len() as u32).to_le_bytes());
        file.extend(frame);
    }
    file
}
