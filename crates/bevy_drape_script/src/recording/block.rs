//! Blocks: some frames in a row that can be read without those before them.

use serde::{Deserialize, Serialize};

use super::frame::{Frame, State};
use super::residual::{Guess, History};
use super::track::Track;

/// Some frames in a row.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Block {
    /// Tracks of what is there before the first frame, in their order.
    pub present: Vec<u32>,
    pub frames: Vec<CodedFrame>,
}

/// One frame.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct CodedFrame {
    /// Simulated time in seconds.
    time: f64,
    /// Tracks of what has gone since the last frame.
    gone: Vec<u32>,
    /// What has come; each gets the next number.
    come: Vec<Track>,
    /// The state of everything that is there, in the order of tracks.
    states: Vec<CodedState>,
}

#[derive(Debug, Serialize, Deserialize)]
enum CodedState {
    /// That of the last frame.
    Same,
    /// What differs from a guess.
    Changed(Guess, Vec<u32>),
}

/// Something that is there.
#[derive(Debug, Default)]
struct Present {
    track: u32,
    value_count: usize,
    history: History,
}

/// Where writing or reading has got to: what is there, and how it has moved in this block.
#[derive(Debug, Default)]
pub(super) struct Progress {
    present: Vec<Present>,
}

impl Progress {
    /// Begins a block: nothing before it may be needed to read it.
    pub fn begin_block(&mut self) -> Block {
        for present in &mut self.present {
            present.history.begin_block();
        }
        Block { present: self.present.iter().map(|present| present.track).collect(), frames: Vec::new() }
    }

    /// Encodes a frame: what has `gone` and `come` since the last one, and the `states` of all that is there by the order
    /// of tracks. `first` is the number of the first track that has come. Returns the frame and about how many bytes it has.
    pub fn encode(
        &mut self,
        time: f64,
        gone: Vec<u32>,
        come: Vec<Track>,
        first: u32,
        states: Vec<Vec<f32>>,
    ) -> (CodedFrame, usize) {
        self.retire(&gone);
        self.admit(&come, first);
        let mut bytes = 16 + come.iter().map(Track::encoded_length).sum::<usize>();
        let states = self.present.iter_mut().zip(states).map(|(present, state)| {
            let (coded, length) = encode_state(&mut present.history, state);
            bytes += length;
            coded
        });
        (CodedFrame { time, gone, come, states: states.collect() }, bytes)
    }

    /// Takes out what has gone; the numbers are in order.
    fn retire(&mut self, gone: &[u32]) {
        self.present.retain(|present| gone.binary_search(&present.track).is_err());
    }

    fn admit(&mut self, come: &[Track], first: u32) {
        self.present.extend((first..).zip(come).map(|(number, track)| Present {
            track: number,
            value_count: track.kind.value_count(),
            history: History::default(),
        }));
    }

    /// Begins to read a block; `tracks` are all that have come before its end.
    pub fn enter_block(&mut self, block: &Block, tracks: &[Track]) -> Result<(), String> {
        self.present.clear();
        for &track in &block.present {
            let known = tracks.get(track as usize).ok_or("names a track that has not come yet")?;
            if self.present.last().is_some_and(|last| last.track >= track) {
                return Err("names tracks out of order".into());
            }
            let value_count = known.kind.value_count();
            self.present.push(Present { track, value_count, history: History::default() });
        }
        Ok(())
    }

    /// Whether what is there is what `block` begins with.
    pub fn agrees_with(&self, block: &Block) -> bool {
        self.present.iter().map(|present| present.track).eq(block.present.iter().copied())
    }

    /// Reads a frame. `first` is the number of the first track that comes with it; what comes is appended to `tracks`
    /// unless it is known already.
    pub fn decode(
        &mut self,
        coded: &CodedFrame,
        first: usize,
        tracks: &mut Vec<Track>,
    ) -> Result<(), String> {
        let before = self.present.len();
        self.retire(&coded.gone);
        if self.present.len() + coded.gone.len() != before {
            return Err("says that something has gone which was not there".into());
        }
        if let Some(track) = coded.come.iter().find(|track| !track.kind.is_sound()) {
            return Err(format!("says that “{}” joins particles that it does not have", track.name));
        }
        let number = u32::try_from(first).map_err(|error| error.to_string())?;
        if tracks.len() == first {
            tracks.extend_from_slice(&coded.come);
        }
        self.admit(&coded.come, number);
        if coded.states.len() != self.present.len() {
            let (states, things) = (coded.states.len(), self.present.len());
            return Err(format!("has {states} states of {things} things"));
        }
        for (present, state) in self.present.iter_mut().zip(&coded.states) {
            match state {
                CodedState::Same if present.history.is_begun() => present.history.push_same(),
                CodedState::Same => return Err("repeats a state that is not in its block".into()),
                CodedState::Changed(guess, residuals) => {
                    if residuals.len() != present.value_count {
                        let (found, wanted) = (residuals.len(), present.value_count);
                        return Err(format!("has a state of {found} numbers instead of {wanted}"));
                    }
                    if !present.history.allows(*guess) {
                        return Err("guesses from states that are not in its block".into());
                    }
                    let state = present.history.state(*guess, residuals);
                    present.history.push(state);
                }
            }
        }
        Ok(())
    }

    /// Copies the frame that was read last.
    pub fn show(&self, coded: &CodedFrame, frame: &mut Frame) {
        frame.time = coded.time;
        frame.states.resize_with(self.present.len(), State::default);
        for (state, present) in frame.states.iter_mut().zip(&self.present) {
            state.track = present.track as usize;
            state.values.clear();
            state.values.extend_from_slice(present.history.last());
        }
    }
}

impl CodedFrame {
    /// How many tracks come with it.
    pub fn come(&self) -> usize {
        self.come.len()
    }
}

impl Track {
    /// About how many bytes it takes.
    fn encoded_length(&self) -> usize {
        let indices = match &self.kind {
            super::track::TrackKind::Body { faces, sticks, .. } => 3 * faces.len() + 2 * sticks.len(),
            _ => 8,
        };
        self.name.len() + 5 * indices
    }
}

/// Encodes a state by the guess that comes nearest to it, and notes it. Returns about how many bytes it has, too.
fn encode_state(history: &mut History, state: Vec<f32>) -> (CodedState, usize) {
    let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits();
    if history.is_begun() && history.last().iter().zip(&state).all(is_same) {
        history.push(state);
        return (CodedState::Same, 1);
    }
    let guess = history.best_guess(&state);
    let coded = CodedState::Changed(guess, history.residuals(guess, &state));
    // Two or three bytes a number, most of the time.
    let length = 3 * state.len();
    history.push(state);
    (coded, length)
}
