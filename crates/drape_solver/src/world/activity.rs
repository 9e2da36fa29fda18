//! The state of a body or ball between "simulated" and "left out".

/// Tells if a body or ball is simulated, and if not, why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Activity {
    /// Simulated.
    #[default]
    Active,
    /// Came to rest: costs nothing until something touches, pushes or edits it.
    Resting,
    /// Left the play area, fell asleep far from every viewer, or cannot be simulated.
    Culled,
    /// Held still by the caller: not simulated, and touched by nothing.
    Frozen,
}

/// The number of bodies and balls in each state of [`Activity`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActivityCounts {
    /// Those that are simulated.
    pub active: usize,
    /// Those at rest.
    pub resting: usize,
    /// Those that are culled.
    pub culled: usize,
    /// Those that the caller holds still.
    pub frozen: usize,
}

impl ActivityCounts {
    /// Counts one more.
    pub(crate) fn add(&mut self, activity: Activity) {
        *match activity {
            Activity::Active => &mut self.active,
            Activity::Resting => &mut self.resting,
            Activity::Culled => &mut self.culled,
            Activity::Frozen => &mut self.frozen,
        } += 1;
    }
}
