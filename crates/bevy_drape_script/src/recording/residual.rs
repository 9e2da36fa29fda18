//! Numbers that follow each other in time, as differences from what was to be expected.
//!
//! A particle goes on about as it did, so a guess from its last places is near the truth, and the difference of the two
//! bit patterns is a small whole number, which takes few bytes. To add it to the same guess gives back every bit.

use serde::{Deserialize, Serialize};

/// What the numbers of a state are guessed from. Which is best changes: a recorder tries them all on a part of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Guess {
    /// The same coordinate of the particle before.
    Neighbour,
    /// The number of the last frame.
    Rest,
    /// On from the last two frames in a line.
    Line,
    /// The same, less what that was wrong by for the particle before.
    LineWithNeighbour,
    /// On from the last three frames in a parabola.
    Parabola,
}

/// Numbers of one particle: what is this far apart is the same coordinate of its neighbour.
const STRIDE: usize = 3;

/// A track's last states, newest first.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    states: [Vec<f32>; 3],
    known: usize,
}

impl History {
    /// The last state; empty before the first.
    pub fn last(&self) -> &[f32] {
        &self.states[0]
    }

    /// Forgets all states but the last.
    pub fn begin_block(&mut self) {
        self.known = 0;
    }

    /// Whether a state has been noted since the block began.
    pub fn is_begun(&self) -> bool {
        self.known > 0
    }

    /// Notes the state of a frame.
    pub fn push(&mut self, state: Vec<f32>) {
        self.states.rotate_right(1);
        self.states[0] = state;
        self.known = (self.known + 1).min(self.states.len());
    }

    /// Notes that nothing has changed.
    pub fn push_same(&mut self) {
        let state = self.states[0].clone();
        self.push(state);
    }

    /// What can be guessed from so many states.
    pub fn guesses(&self) -> &'static [Guess] {
        use Guess::{Line, LineWithNeighbour, Neighbour, Parabola, Rest};
        match self.known {
            0 => &[Neighbour],
            1 => &[Neighbour, Rest],
            2 => &[Rest, Line, LineWithNeighbour],
            _ => &[Rest, Line, LineWithNeighbour, Parabola],
        }
    }

    /// Whether there are as many states as the guess needs.
    pub fn allows(&self, guess: Guess) -> bool {
        let needed = match guess {
            Guess::Neighbour => 0,
            Guess::Rest => 1,
            Guess::Line | Guess::LineWithNeighbour => 2,
            Guess::Parabola => 3,
        };
        self.known >= needed
    }

    /// Has `what` done with a guess. All states are of the same length.
    fn guess<W: WithGuess>(&self, guess: Guess, what: W) -> W::Output {
        let [a, b, c] = &self.states;
        let line = |i: usize| a[i] + (a[i] - b[i]);
        match guess {
            Guess::Neighbour => {
                what.done(|known, i| i.checked_sub(STRIDE).map_or(0.0, |before| known[before]))
            }
            Guess::Rest => what.done(|_, i| a[i]),
            Guess::Line => what.done(|_, i| line(i)),
            Guess::LineWithNeighbour => what.done(|known, i| {
                line(i) + i.checked_sub(STRIDE).map_or(0.0, |before| known[before] - line(before))
            }),
            Guess::Parabola => what.done(|_, i| 3.0 * (a[i] - b[i]) + c[i]),
        }
    }

    /// The guess that comes nearest to `state`, by a sample of a long one.
    pub fn best_guess(&self, state: &[f32]) -> Guess {
        let length = |guess: &&Guess| self.guess(**guess, SampleLength(state));
        self.guesses().iter().min_by_key(length).copied().unwrap_or(Guess::Neighbour)
    }

    /// What has to be added to the guesses to get `state`.
    pub fn residuals(&self, guess: Guess, state: &[f32]) -> Vec<u32> {
        self.guess(guess, Residuals(state))
    }

    /// The state that these residuals stand for.
    pub fn state(&self, guess: Guess, residuals: &[u32]) -> Vec<f32> {
        self.guess(guess, Rebuild(residuals))
    }
}

/// Something that is done with a guess, compiled for each: a choice made anew for every number would cost more than the
/// guess.
trait WithGuess {
    type Output;

    /// Does it; `expected` is the guess for a number by its index, where those before it are known.
    fn done(self, expected: impl Fn(&[f32], usize) -> f32) -> Self::Output;
}

/// How many bytes a part of the residuals takes.
struct SampleLength<'a>(&'a [f32]);

impl WithGuess for SampleLength<'_> {
    type Output = usize;

    fn done(self, expected: impl Fn(&[f32], usize) -> f32) -> usize {
        // No multiple of what a row of a cloth may have.
        let stride = (self.0.len() / SAMPLES).max(1) | 1;
        let of_one = |i: usize| encoded_length(residual(self.0[i], expected(self.0, i)));
        (0..self.0.len()).step_by(stride).map(of_one).sum()
    }
}

/// About how many numbers are looked at before a guess is chosen.
const SAMPLES: usize = 512;

struct Residuals<'a>(&'a [f32]);

impl WithGuess for Residuals<'_> {
    type Output = Vec<u32>;

    fn done(self, expected: impl Fn(&[f32], usize) -> f32) -> Vec<u32> {
        self.0.iter().enumerate().map(|(i, &value)| residual(value, expected(self.0, i))).collect()
    }
}

struct Rebuild<'a>(&'a [u32]);

impl WithGuess for Rebuild<'_> {
    type Output = Vec<f32>;

    fn done(self, expected: impl Fn(&[f32], usize) -> f32) -> Vec<f32> {
        let mut state = Vec::with_capacity(self.0.len());
        for (i, &residual) in self.0.iter().enumerate() {
            let expected = bits(expected(&state, i));
            state.push(f32::from_bits(expected.wrapping_add(unzigzag(residual))));
        }
        state
    }
}

fn residual(value: f32, expected: f32) -> u32 {
    zigzag(value.to_bits().wrapping_sub(bits(expected)))
}

/// The bits of a guess. What bits a NaN has depends on the machine.
fn bits(guess: f32) -> u32 {
    if guess.is_nan() { 0 } else { guess.to_bits() }
}

/// Small positive and negative differences as small numbers: 0, -1, 1, -2 become 0, 1, 2, 3.
fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ if difference >> 31 == 1 { u32::MAX } else { 0 }
}

fn unzigzag(number: u32) -> u32 {
    (number >> 1) ^ if number & 1 == 1 { u32::MAX } else { 0 }
}

/// How many bytes `postcard` needs for a number: seven bits in each.
fn encoded_length(number: u32) -> usize {
    (38 - (number | 1).leading_zeros() as usize) / 7
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: [f32; 9] =
        [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-45, f32::MAX, -1.5];

    #[test]
    fn every_guess_gives_back_every_bit() {
        let mut history = History::default();
        let states: Vec<Vec<f32>> = (0..ODD.len())
            .map(|turn| ODD.iter().cycle().skip(turn).take(ODD.len()).copied().collect())
            .collect();
        for state in states {
            for &guess in history.guesses() {
                assert!(history.allows(guess));
                let residuals = history.residuals(guess, &state);
                let again = history.state(guess, &residuals);
                let bits = |state: &[f32]| state.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&again), bits(&state), "{guess:?}");
            }
            history.push(state);
        }
    }

    #[test]
    fn steady_motion_costs_a_byte_a_number() {
        let mut history = History::default();
        for step in 0..3 {
            history.push((0..30).map(|i| i as f32 + 0.25 * step as f32).collect());
        }
        let next: Vec<f32> = (0..30).map(|i| i as f32 + 0.75).collect();
        let guess = history.best_guess(&next);
        assert_eq!(history.residuals(guess, &next), [0; 30], "{guess:?}");
    }

    #[test]
    fn lengths_are_those_of_postcard() {
        for number in [0, 1, 127, 128, 16_383, 16_384, 2_097_151, 2_097_152, 268_435_456, u32::MAX] {
            let encoded = postcard::to_stdvec(&number).expect("a number");
            assert_eq!(encoded_length(number), encoded.len(), "{number}");
            assert_eq!(zigzag(unzigzag(number)), number);
        }
    }
}
