//! Blocks of frames. A block can be decoded without those before it.
//!
//! A state that has not changed costs a byte or less per frame. Others are kept as differences from a prediction.

use serde::{Deserialize, Serialize};

use super::frame::{Frame, State};
use super::residual::{History, Predictor};
use super::track::Track;

/// Consecutive frames.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Block {
    /// The tracks that exist before the first frame, in ascending order.
    pub present: Vec<u32>,
    pub frames: Vec<EncodedFrame>,
}

/// One frame.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct EncodedFrame {
    /// Simulated time in seconds.
    time: f64,
    /// The tracks that have ended since the last frame.
    ended: Vec<u32>,
    /// The tracks that begin with this frame. Each gets the next number.
    begun: Vec<Track>,
    /// The states of all present tracks, in their order.
    states: Vec<EncodedState>,
}

#[derive(Debug, Serialize, Deserialize)]
enum EncodedState {
    /// The state of the last frame.
    Same,
    /// Residuals of a prediction.
    Changed(Predictor, Vec<u32>),
}

/// A track that has begun and not ended.
#[derive(Debug, Default)]
struct PresentTrack {
    track: u32,
    value_count: usize,
    history: History,
}

/// Encodes or decodes frames one after another: knows the present tracks and their last states in this block.
#[derive(Debug, Default)]
pub(super) struct FrameCodec {
    present: Vec<PresentTrack>,
}

impl FrameCodec {
    /// Begins a block. Nothing before it is needed to decode it.
    pub fn begin_block(&mut self) -> Block {
        for present in &mut self.present {
            present.history.begin_block();
        }
        Block { present: self.present.iter().map(|present| present.track).collect(), frames: Vec::new() }
    }

    /// Encodes a frame: the tracks that have `ended` and `begun` since the last one, and the `states` of all present tracks in
    /// their order. `first` is the number of the first track that begins. Returns the frame and its approximate size in bytes.
    pub fn encode(
        &mut self,
        time: f64,
        ended: Vec<u32>,
        begun: Vec<Track>,
        first: u32,
        states: Vec<Vec<f32>>,
    ) -> (EncodedFrame, usize) {
        self.end(&ended);
        self.begin(&begun, first);
        let mut bytes = 16 + begun.iter().map(Track::encoded_length).sum::<usize>();
        let states = self.present.iter_mut().zip(states).map(|(present, state)| {
            let (coded, length) = encode_state(&mut present.history, state);
            bytes += length;
            coded
        });
        (EncodedFrame { time, ended, begun, states: states.collect() }, bytes)
    }

    /// Removes tracks, whose numbers are in ascending order.
    fn end(&mut self, ended: &[u32]) {
        self.present.retain(|present| ended.binary_search(&present.track).is_err());
    }

    fn begin(&mut self, begun: &[Track], first: u32) {
        self.present.extend((first..).zip(begun).map(|(number, track)| PresentTrack {
            track: number,
            value_count: track.kind.value_count(),
            history: History::default(),
        }));
    }

    /// Begins to decode a block. `tracks` are all that begin before its end.
    pub fn enter_block(&mut self, block: &Block, tracks: &[Track]) -> Result<(), String> {
        self.present.clear();
        for &track in &block.present {
            let known = tracks.get(track as usize).ok_or("names a track that has not come yet")?;
            if self.present.last().is_some_and(|last| last.track >= track) {
                return Err("names tracks out of order".into());
            }
            let value_count = known.kind.value_count();
            self.present.push(PresentTrack { track, value_count, history: History::default() });
        }
        Ok(())
    }

    /// True if the present tracks are those that `block` begins with.
    pub fn agrees_with(&self, block: &Block) -> bool {
        self.present.iter().map(|present| present.track).eq(block.present.iter().copied())
    }

    /// Decodes a frame. `first` is the number of the first track that begins with it. New tracks are appended to `tracks`,
    /// unless they are known already.
    pub fn decode(
        &mut self,
        coded: &EncodedFrame,
        first: usize,
        tracks: &mut Vec<Track>,
    ) -> Result<(), String> {
        let before = self.present.len();
        self.end(&coded.ended);
        if self.present.len() + coded.ended.len() != before {
            return Err("says that something has gone which was not there".into());
        }
        if let Some(track) = coded.begun.iter().find(|track| !track.kind.is_sound()) {
            return Err(format!("says that “{}” joins particles that it does not have", track.name));
        }
        let number = u32::try_from(first).map_err(|error| error.to_string())?;
        if tracks.len() == first {
            tracks.extend_from_slice(&coded.begun);
        }
        self.begin(&coded.begun, number);
        if coded.states.len() != self.present.len() {
            let (states, things) = (coded.states.len(), self.present.len());
            return Err(format!("has {states} states of {things} things"));
        }
        for (present, state) in self.present.iter_mut().zip(&coded.states) {
            match state {
                EncodedState::Same if present.history.is_begun() => present.history.push_same(),
                EncodedState::Same => return Err("repeats a state that is not in its block".into()),
                EncodedState::Changed(predictor, residuals) => {
                    if residuals.len() != present.value_count {
                        let (found, wanted) = (residuals.len(), present.value_count);
                        return Err(format!("has a state of {found} numbers instead of {wanted}"));
                    }
                    if !present.history.allows(*predictor) {
                        return Err("guesses from states that are not in its block".into());
                    }
                    let state = present.history.state(*predictor, residuals);
                    present.history.push(state);
                }
            }
        }
        Ok(())
    }

    /// Copies the frame that was decoded last.
    pub fn show(&self, coded: &EncodedFrame, frame: &mut Frame) {
        frame.time = coded.time;
        frame.states.resize_with(self.present.len(), State::default);
        for (state, present) in frame.states.iter_mut().zip(&self.present) {
            state.track = present.track as usize;
            state.values.clear();
            state.values.extend_from_slice(present.history.last());
        }
    }
}

impl EncodedFrame {
    /// The number of tracks that begin with it.
    pub fn begun(&self) -> usize {
        self.begun.len()
    }
}

impl Track {
    /// Its approximate size in bytes.
    fn encoded_length(&self) -> usize {
        let indices = match &self.kind {
            super::track::TrackKind::Body { faces, sticks, .. } => 3 * faces.len() + 2 * sticks.len(),
            _ => 8,
        };
        self.name.len() + 5 * indices
    }
}

/// Encodes a state by its best prediction, and adds it to the history. Returns the approximate size in bytes, too.
fn encode_state(history: &mut History, state: Vec<f32>) -> (EncodedState, usize) {
    let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits();
    if history.is_begun() && history.last().iter().zip(&state).all(is_same) {
        history.push(state);
        return (EncodedState::Same, 1);
    }
    let predictor = history.best_predictor(&state);
    let coded = EncodedState::Changed(predictor, history.residuals(predictor, &state));
    // Most numbers take two or three bytes.
    let length = 3 * state.len();
    history.push(state);
    (coded, length)
}
