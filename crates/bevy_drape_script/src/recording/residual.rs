//! Predicts the numbers of a state from the states before it, and keeps the residuals.
//!
//! Particles move smoothly, so a prediction from their last positions is close, and the difference of the two bit patterns is
//! a small integer, which takes few bytes. Adding it to the same prediction restores every bit.

use serde::{Deserialize, Serialize};

/// The way to predict the numbers of a state. The best one changes with the motion, so a recorder tries all on a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Predictor {
    /// The same coordinate of the particle before.
    Neighbour,
    /// The same number in the last frame.
    Rest,
    /// Linear extrapolation of the last two frames.
    Line,
    /// Linear extrapolation, corrected by its error for the particle before.
    LineWithNeighbour,
    /// Quadratic extrapolation of the last three frames.
    Parabola,
}

/// Numbers per particle, so the distance to the same coordinate of its neighbour.
const STRIDE: usize = 3;

/// The last states of a track, newest first.
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

    /// True once the block has a state.
    pub fn is_begun(&self) -> bool {
        self.known > 0
    }

    /// Adds the state of a frame.
    pub fn push(&mut self, state: Vec<f32>) {
        self.states.rotate_right(1);
        self.states[0] = state;
        self.known = (self.known + 1).min(self.states.len());
    }

    /// Adds a frame in which nothing has changed.
    pub fn push_same(&mut self) {
        let state = self.states[0].clone();
        self.push(state);
    }

    /// The predictors worth trying with so many states.
    pub fn predictors(&self) -> &'static [Predictor] {
        use Predictor::{Line, LineWithNeighbour, Neighbour, Parabola, Rest};
        match self.known {
            0 => &[Neighbour],
            1 => &[Neighbour, Rest],
            2 => &[Rest, Line, LineWithNeighbour],
            _ => &[Rest, Line, LineWithNeighbour, Parabola],
        }
    }

    /// True if there are as many states as the predictor needs.
    pub fn allows(&self, predictor: Predictor) -> bool {
        let needed = match predictor {
            Predictor::Neighbour => 0,
            Predictor::Rest => 1,
            Predictor::Line | Predictor::LineWithNeighbour => 2,
            Predictor::Parabola => 3,
        };
        self.known >= needed
    }

    /// Runs `task` with a prediction. All states have the same length.
    fn predict<T: WithPrediction>(&self, predictor: Predictor, task: T) -> T::Output {
        let [a, b, c] = &self.states;
        let line = |i: usize| a[i] + (a[i] - b[i]);
        match predictor {
            Predictor::Neighbour => {
                task.run(|known, i| i.checked_sub(STRIDE).map_or(0.0, |before| known[before]))
            }
            Predictor::Rest => task.run(|_, i| a[i]),
            Predictor::Line => task.run(|_, i| line(i)),
            Predictor::LineWithNeighbour => task.run(|known, i| {
                line(i) + i.checked_sub(STRIDE).map_or(0.0, |before| known[before] - line(before))
            }),
            Predictor::Parabola => task.run(|_, i| 3.0 * (a[i] - b[i]) + c[i]),
        }
    }

    /// The predictor that comes closest to `state`, judged by a sample of its numbers.
    pub fn best_predictor(&self, state: &[f32]) -> Predictor {
        let length = |predictor: &&Predictor| self.predict(**predictor, SampleLength(state));
        self.predictors().iter().min_by_key(length).copied().unwrap_or(Predictor::Neighbour)
    }

    /// The numbers to be added to the prediction to get `state`.
    pub fn residuals(&self, predictor: Predictor, state: &[f32]) -> Vec<u32> {
        self.predict(predictor, Residuals(state))
    }

    /// The state with these residuals.
    pub fn state(&self, predictor: Predictor, residuals: &[u32]) -> Vec<f32> {
        self.predict(predictor, Rebuild(residuals))
    }
}

/// A task that needs a prediction, compiled for each predictor: choosing one anew for every number would cost more than
/// predicting it.
trait WithPrediction {
    type Output;

    /// Runs the task. `expected` predicts the number at an index from those before it.
    fn run(self, expected: impl Fn(&[f32], usize) -> f32) -> Self::Output;
}

/// Adds up the bytes of a sample of the residuals.
struct SampleLength<'a>(&'a [f32]);

impl WithPrediction for SampleLength<'_> {
    type Output = usize;

    fn run(self, expected: impl Fn(&[f32], usize) -> f32) -> usize {
        // Odd, so that it does not keep to one column of a cloth.
        let stride = (self.0.len() / SAMPLES).max(1) | 1;
        let of_one = |i: usize| encoded_length(residual(self.0[i], expected(self.0, i)));
        (0..self.0.len()).step_by(stride).map(of_one).sum()
    }
}

/// The approximate size of the sample that chooses a predictor.
const SAMPLES: usize = 512;

struct Residuals<'a>(&'a [f32]);

impl WithPrediction for Residuals<'_> {
    type Output = Vec<u32>;

    fn run(self, expected: impl Fn(&[f32], usize) -> f32) -> Vec<u32> {
        self.0.iter().enumerate().map(|(i, &value)| residual(value, expected(self.0, i))).collect()
    }
}

struct Rebuild<'a>(&'a [u32]);

impl WithPrediction for Rebuild<'_> {
    type Output = Vec<f32>;

    fn run(self, expected: impl Fn(&[f32], usize) -> f32) -> Vec<f32> {
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

/// The bits of a prediction. Those of a NaN differ from machine to machine, so they count as 0.
fn bits(prediction: f32) -> u32 {
    if prediction.is_nan() { 0 } else { prediction.to_bits() }
}

/// Maps small differences of either sign to small numbers: 0, -1, 1, -2 become 0, 1, 2, 3.
fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ if difference >> 31 == 1 { u32::MAX } else { 0 }
}

fn unzigzag(number: u32) -> u32 {
    (number >> 1) ^ if number & 1 == 1 { u32::MAX } else { 0 }
}

/// The number of bytes that `postcard` needs for a number: seven bits in each.
fn encoded_length(number: u32) -> usize {
    (38 - (number | 1).leading_zeros() as usize) / 7
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: [f32; 9] =
        [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MIN_POSITIVE, 1e-45, f32::MAX, -1.5];

    #[test]
    fn every_predictor_restores_every_bit() {
        let mut history = History::default();
        let states: Vec<Vec<f32>> = (0..ODD.len())
            .map(|turn| ODD.iter().cycle().skip(turn).take(ODD.len()).copied().collect())
            .collect();
        for state in states {
            for &predictor in history.predictors() {
                assert!(history.allows(predictor));
                let residuals = history.residuals(predictor, &state);
                let again = history.state(predictor, &residuals);
                let bits = |state: &[f32]| state.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&again), bits(&state), "{predictor:?}");
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
        let predictor = history.best_predictor(&next);
        assert_eq!(history.residuals(predictor, &next), [0; 30], "{predictor:?}");
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
