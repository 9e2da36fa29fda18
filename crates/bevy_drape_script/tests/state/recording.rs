//! Recordings: every bit comes back, any frame can be shown, and whatever is no recording is refused.

use bevy_drape_script::recording::{
    Form, Header, Mismatch, Recorder, Recording, RecordingError, Sample, Track, TrackKind, diff,
};
use proptest::prelude::*;

use crate::random::{between, cases};
use crate::scenes::{STEP, recorded};

/// Something in a made-up frame: its id, which is also its kind, and its numbers.
type Thing = (u64, Vec<f32>);

fn track(id: u64, count: usize) -> Track {
    let kind = match id % 3 {
        0 => TrackKind::Ball { radius: 0.5 },
        1 => TrackKind::Obstacle { form: Form::Sphere { radius: 2.0 } },
        _ => {
            let particles = (count / 3 - 1) as u32;
            TrackKind::Body { particles, faces: vec![], sticks: vec![] }
        }
    };
    Track { name: format!("thing {id}"), kind }
}

fn record(frames: &[Vec<Thing>]) -> Vec<u8> {
    let header = Header { scene: "made up".into(), dt: STEP };
    let mut recorder = Recorder::new(Vec::new(), header).expect("memory");
    for (step, things) in frames.iter().enumerate() {
        let seen = things.iter().map(|(id, values)| Sample {
            id: *id,
            describe: Box::new(|| track(*id, values.len())),
            values: values.clone(),
        });
        recorder.push(step as f64, seen.collect()).expect("sound frames");
    }
    recorder.finish().expect("memory")
}

/// What a frame shows, in bits, in the order of ids.
fn shown(recording: &Recording, index: usize) -> Vec<(String, Vec<u32>)> {
    let mut cursor = recording.cursor();
    let frame = cursor.seek(index).expect("a frame");
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect();
    let name = |track: usize| recording.tracks()[track].name.clone();
    let mut shown: Vec<_> =
        frame.states.iter().map(|state| (name(state.track), bits(state.values()))).collect();
    shown.sort();
    shown
}

fn put_in(things: &[Thing]) -> Vec<(String, Vec<u32>)> {
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect();
    let mut shown: Vec<_> = things.iter().map(|(id, values)| (format!("thing {id}"), bits(values))).collect();
    shown.sort();
    shown
}

/// Numbers of every kind, those that are none included.
fn value() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), between(-10.0, 10.0), Just(0.0), Just(-0.0)]
}

fn thing() -> impl Strategy<Value = Thing> {
    (0_u64..9, 0_usize..5).prop_flat_map(|(id, particles)| {
        let count = match id % 3 {
            0 => 7,
            1 => 12,
            _ => 3 * (particles + 1),
        };
        (Just(id), prop::collection::vec(value(), count))
    })
}

/// A frame in which no id is there twice.
fn frame() -> impl Strategy<Value = Vec<Thing>> {
    prop::collection::vec(thing(), 0..6).prop_map(|mut things| {
        things.sort_by_key(|&(id, _)| id);
        things.dedup_by_key(|&mut (id, _)| id);
        things
    })
}

proptest! {
    #![proptest_config(cases(64))]

    /// More frames than a block has, each repeated by chance, shown in any order.
    #[test]
    fn random_frames_come_back_to_the_bit(
        frames in prop::collection::vec((frame(), 1_usize..4), 0..60),
        order in prop::collection::vec(any::<prop::sample::Index>(), 20),
    ) {
        let frames: Vec<Vec<Thing>> =
            frames.into_iter().flat_map(|(frame, times)| vec![frame; times]).collect();
        let recording = Recording::from_bytes(record(&frames)).expect("a recording");
        prop_assert_eq!(recording.frame_count(), frames.len());
        prop_assert_eq!(diff(&recording, &recording).expect("frames"), None);
        let mut cursor = recording.cursor();
        for index in order {
            if frames.is_empty() {
                prop_assert!(cursor.seek(0).is_err());
                break;
            }
            let index = index.index(frames.len());
            prop_assert_eq!(cursor.seek(index).expect("a frame").time, index as f64);
            prop_assert_eq!(shown(&recording, index), put_in(&frames[index]));
        }
    }

    #[test]
    fn random_bytes_do_not_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), is_begun in any::<bool>()) {
        let mut file = if is_begun { b"DRAPEREC\x01\0\0\0".to_vec() } else { Vec::new() };
        file.extend(bytes);
        prop_assert!(Recording::from_bytes(file).is_err());
    }
}

/// Two blocks of a few things that move, rest, come and go.
fn small() -> Vec<u8> {
    let frames: Vec<Vec<Thing>> = (0..70)
        .map(|step| {
            let t = step as f32;
            let mut things = vec![(2, vec![0.0, 0.0, 0.0, t, t * t, 1.0]), (1, vec![1.0; 12])];
            if (20..40).contains(&step) {
                things.push((3, vec![t.sqrt(); 7]));
            }
            things
        })
        .collect();
    record(&frames)
}

#[test]
fn every_truncation_is_refused() {
    let bytes = small();
    assert!(Recording::from_bytes(bytes.clone()).is_ok());
    for length in 0..bytes.len() {
        match Recording::from_bytes(bytes[..length].to_vec()) {
            Err(RecordingError::NotARecording) if length == 0 => {}
            Err(RecordingError::Truncated { offset, .. }) if length > 0 => assert_eq!(offset, length),
            other => panic!("cut off at {length}: {other:?}"),
        }
    }
}

#[test]
fn every_flipped_bit_and_byte_is_refused() {
    let bytes = small();
    for place in 0..bytes.len() {
        for change in (0..8).map(|bit| 1_u8 << bit).chain([0xff]) {
            let mut changed = bytes.clone();
            changed[place] ^= change;
            let read = Recording::from_bytes(changed);
            assert!(read.is_err(), "byte {place} of {} changed by {change:#x} is not noticed", bytes.len());
        }
    }
}

#[test]
fn errors_say_what_is_wrong_and_where() {
    let message = |bytes: &[u8]| Recording::from_bytes(bytes.to_vec()).expect_err("no recording").to_string();
    let bytes = small();
    assert!(message(b"\x89PNG....").contains("DRAPEREC"));
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert!(message(&newer).contains("version 9"));
    let mut damaged = bytes.clone();
    let middle = bytes.len() / 2;
    damaged[middle] ^= 1;
    assert!(message(&damaged).contains("block"), "{}", message(&damaged));
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(message(&longer).contains("belong to nothing"), "{}", message(&longer));
    let twice = [&bytes[..], &bytes[12..]].concat();
    assert!(message(&twice).contains("belong to nothing"), "{}", message(&twice));
    let missing = Recording::load("no/such/file.drape").expect_err("no file").to_string();
    assert!(missing.contains("no/such/file.drape"), "{missing}");
}

/// A packet that claims four gigabytes, and one of many megabytes of zeros in few bytes: refused, and quickly.
#[test]
fn sizes_that_lie_cost_nothing() {
    let mut bytes = b"DRAPEREC\x01\0\0\0".to_vec();
    bytes.extend([0xff, 0xff, 0xff, 0xff, 1, 2, 3]);
    assert!(matches!(Recording::from_bytes(bytes), Err(RecordingError::Truncated { .. })));

    // A header whose scene name is said to have 2^60 letters.
    let name = [&[0_u8][..], &[0x80; 8], &[0x10]].concat();
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    std::io::Write::write_all(&mut encoder, &name).expect("memory");
    let frame = encoder.finish().expect("memory");
    let mut bytes = b"DRAPEREC\x01\0\0\0".to_vec();
    bytes.extend((frame.len() as u32).to_le_bytes());
    bytes.extend(frame);
    assert!(matches!(Recording::from_bytes(bytes), Err(RecordingError::Damaged { .. })));
}

#[test]
fn what_makes_no_sense_is_not_written() {
    let header = || Header { scene: String::new(), dt: STEP };
    let ball =
        |values: usize| Sample { id: 0, describe: Box::new(|| track(0, 7)), values: vec![0.0; values] };
    let mut recorder = Recorder::new(Vec::new(), header()).expect("memory");
    assert!(matches!(recorder.push(0.0, vec![ball(6)]), Err(RecordingError::Unencodable { .. })));
    assert!(matches!(recorder.push(0.0, vec![ball(7), ball(7)]), Err(RecordingError::Unencodable { .. })));
    let face = TrackKind::Body { particles: 2, faces: vec![[0, 1, 2]], sticks: vec![] };
    let bad = Sample {
        id: 0,
        describe: Box::new(move || Track { name: "face".into(), kind: face }),
        values: vec![0.0; 9],
    };
    assert!(matches!(recorder.push(0.0, vec![bad]), Err(RecordingError::Unencodable { .. })));
}

#[test]
fn two_runs_part_where_one_of_them_was_changed() {
    let frames = |change: Option<(usize, usize, f32)>| -> Vec<Vec<Thing>> {
        (0..80)
            .map(|step| {
                let mut values: Vec<f32> = (0..30).map(|i| (i * step) as f32 * 0.01).collect();
                if let Some((_, place, by)) = change.filter(|&(at, ..)| step >= at) {
                    values[place] += by;
                }
                vec![(2, values), (0, vec![step as f32; 7])]
            })
            .collect()
    };
    let read = |frames: &[Vec<Thing>]| Recording::from_bytes(record(frames)).expect("a recording");
    let plain = read(&frames(None));
    assert_eq!(diff(&plain, &read(&frames(None))).expect("frames"), None);
    // The second coordinate of particle 4, behind the origin, from frame 70 in the second block on.
    let changed = read(&frames(Some((70, 16, 0.25))));
    let difference = diff(&plain, &changed).expect("frames").expect("a difference");
    assert_eq!((difference.frame, difference.time), (70, 70.0));
    assert!((difference.distance() - 0.25).abs() < 1e-5);
    let Mismatch::Place { particle, name, count, .. } = &difference.what else { panic!("{difference:?}") };
    assert_eq!((*particle, name.as_str(), *count), (Some(4), "thing 2", 1));
    assert!(difference.to_string().contains("frame 70"), "{difference}");

    let shorter = read(&frames(None)[..60]);
    let difference = diff(&plain, &shorter).expect("frames").expect("a difference");
    assert_eq!(difference.what, Mismatch::End([80, 60]));
    let mut without = frames(None);
    without[30].pop();
    let difference = diff(&plain, &read(&without)).expect("frames").expect("a difference");
    let is_in_first = true;
    assert_eq!(difference.frame, 30);
    assert_eq!(difference.what, Mismatch::Presence { noun: "ball", name: "thing 0".into(), is_in_first });
}

/// A running world: what was recorded is what was there, and two equal runs do not part.
#[test]
fn a_world_is_recorded_to_the_bit_and_another_run_is_the_same() {
    let (bytes, last) = recorded(90, 0.0);
    let recording = Recording::from_bytes(bytes).expect("a recording");
    assert_eq!((recording.frame_count(), recording.header().scene.as_str()), (90, "all of it"));
    let mut cursor = recording.cursor();
    let frame = cursor.seek(89).expect("the last");
    let positions = |name: &str| {
        let track = recording.tracks().iter().position(|track| track.name == name).expect("a track");
        frame.state(track).expect("still there").positions().collect::<Vec<_>>()
    };
    assert_eq!(positions("curtain"), last);
    let of_kind = |noun| recording.tracks().iter().filter(|track| track.kind.noun() == noun).count();
    assert_eq!((of_kind("body"), of_kind("ball"), of_kind("obstacle")), (3, 2, 3));

    let (again, _) = recorded(90, 0.0);
    let again = Recording::from_bytes(again).expect("a recording");
    assert_eq!(diff(&recording, &again).expect("frames"), None);
    // A breath of wind more.
    let (other, _) = recorded(90, 1e-3);
    let other = Recording::from_bytes(other).expect("a recording");
    let difference = diff(&recording, &other).expect("frames").expect("a difference");
    assert!(difference.frame < 3 && difference.distance() < 1e-3, "{difference}");
}

/// What rests costs next to nothing.
#[test]
fn rest_is_cheap() {
    let still: Vec<Vec<Thing>> = (0..640).map(|_| vec![(2, (0..300).map(|i| i as f32).collect())]).collect();
    let size = record(&still).len();
    assert!(size < 640 * 300 / 10, "{size} bytes for 640 frames of 99 particles at rest");
}
