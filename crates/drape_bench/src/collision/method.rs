//! A method of collision detection, and its contacts.

use drape_solver::glam::Vec3;

use super::state::State;

/// A ball and a face that overlap, by their numbers.
pub type Pair = (u32, u32);

/// A way to find the contacts of balls with a cloth.
pub trait Method {
    /// Its name.
    fn name(&self) -> &'static str;
    /// Broad phase, at the start of a step.
    fn begin_step(&mut self, state: &mut State);
    /// Narrow phase, in a substep: finds all contacts, with weights, normal and depth. Returns the number of faces that
    /// were queried for their nearest point.
    fn find(&mut self, state: &mut State) -> usize;
    /// The contacts that were found last.
    fn pairs(&self, state: &State) -> Vec<Pair>;
}

/// A contact, as every method finds it.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Ball and face.
    pub pair: Pair,
    /// Weights of the face's corners in the nearest point.
    pub weights: [f32; 3],
    /// Unit vector from the nearest point to the ball's centre.
    pub normal: Vec3,
    /// Penetration depth in metres.
    pub depth: f32,
}
