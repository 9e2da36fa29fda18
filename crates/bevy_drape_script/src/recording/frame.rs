//! Frames of a recording: the positions of everything after a step.

use bevy::math::{Affine3A, Quat, Vec3};

use super::track::TrackKind;

/// The positions of everything after a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Simulated time in seconds.
    pub time: f64,
    /// The states of everything that existed, in the order of their tracks.
    pub states: Vec<State>,
}

impl Frame {
    /// The state of a track; none if it did not exist.
    pub fn state(&self, track: usize) -> Option<&State> {
        let index = self.states.binary_search_by_key(&track, |state| state.track).ok()?;
        self.states.get(index)
    }
}

/// The state of a body, ball or obstacle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The index of its [`Track`](super::Track) in the recording.
    pub track: usize,
    pub(super) values: Vec<f32>,
}

impl State {
    /// The recorded numbers. The [kind](super::TrackKind) of the track documents their meaning.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    fn vector(&self, index: usize) -> Option<Vec3> {
        let [x, y, z] = *self.values.get(3 * index..)?.first_chunk()?;
        Some(Vec3::new(x, y, z))
    }

    /// The positions of a body's particles in the world, in metres.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        let origin = self.vector(0).unwrap_or_default();
        let (positions, _) = self.values.get(3..).unwrap_or_default().as_chunks::<3>();
        positions.iter().map(move |&position| origin + Vec3::from_array(position))
    }

    /// The centre of a ball in metres, and its rotation.
    pub fn ball(&self) -> Option<(Vec3, Quat)> {
        let rotation: [f32; 4] = *self.values.get(3..)?.first_chunk()?;
        Some((self.vector(0)?, Quat::from_array(rotation)))
    }

    /// Its positions in metres: all particles of a body, the centre of a ball, the origin of an obstacle.
    pub fn places(&self, kind: &TrackKind) -> Vec<Vec3> {
        match kind {
            TrackKind::Body { .. } => self.positions().collect(),
            TrackKind::Ball { .. } => self.ball().map(|(centre, _)| centre).into_iter().collect(),
            TrackKind::Obstacle { .. } => {
                self.obstacle().map(|matrix| matrix.translation.into()).into_iter().collect()
            }
        }
    }

    /// The transform of an obstacle.
    pub fn obstacle(&self) -> Option<Affine3A> {
        let columns: &[f32; 12] = self.values.first_chunk()?;
        Some(Affine3A::from_cols_array(columns))
    }
}
