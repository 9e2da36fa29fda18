//! Interpolation between fixed steps, for smooth motion at any frame rate.
//!
//! ```text
//!   step 1        step 2        step 3
//!     |-------------|------x------|----> time
//!                          now: half a step after step 2, so that what is shown
//!                          lies half way from the state of step 1 to that of step 2
//! ```
//!
//! The shown state is up to one step old, but never extrapolated.

use bevy::app::RunFixedMainLoopSystems;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use crate::rigid_motion::between;
use crate::step::run::run_drape_schedule;

/// Shows an entity interpolated between its transforms after the last two fixed steps.
///
/// For balls, and for anything else that moves in the fixed loop: obstacles, cannons, the entity that a curtain is
/// pinned to. The [`Transform`] is interpolated after the fixed loop and restored before the next fixed step, so that
/// systems in the fixed loop see the true one. [`ProjectileState`](crate::ball::projectile::ProjectileState) always has
/// a ball's position after the last step.
///
/// Setting the `Transform` outside the fixed loop is a jump, which is shown at once.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, InterpolationState)]
pub struct Interpolated;

/// Shows entities with [`Interpolated`] between fixed steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct InterpolationPlugin;

impl Plugin for InterpolationPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Interpolated>()
            .add_systems(FixedFirst, restore_transforms.before(run_drape_schedule))
            .add_systems(FixedLast, record_transforms.after(run_drape_schedule))
            .add_systems(
                RunFixedMainLoop,
                show_transforms.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            );
    }
}

/// True if steps are taken in the fixed loop, so that bodies are shown between the last two.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct ShowsBetweenSteps(pub bool);

impl ShowsBetweenSteps {
    /// For steps that are taken in `schedule`.
    pub fn of(schedule: Interned<dyn ScheduleLabel>) -> Self {
        let fixed: [Interned<dyn ScheduleLabel>; 5] = [
            FixedFirst.intern(),
            FixedPreUpdate.intern(),
            FixedUpdate.intern(),
            FixedPostUpdate.intern(),
            FixedLast.intern(),
        ];
        Self(fixed.contains(&schedule))
    }
}

/// Returns the fraction, 0 to 1, between the last two steps that is shown now.
pub(crate) fn step_fraction(time: Option<&Time<Fixed>>) -> f32 {
    time.map_or(1.0, |time| time.overstep_fraction().clamp(0.0, 1.0))
}

/// Motion of an [`Interpolated`] entity; none before the first frame.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct InterpolationState(Option<Path>);

impl InterpolationState {
    /// Returns the transform after the last fixed step; none before the first one.
    pub fn end(&self) -> Option<Transform> {
        self.0.map(|path| path.end)
    }

    /// Makes the place `origin` the origin of the coordinates.
    pub fn shift_origin(&mut self, origin: Vec3) {
        if let Some(Path { start, end, shown }) = &mut self.0 {
            [start, end, shown].into_iter().for_each(|place| place.translation -= origin);
        }
    }
}

/// Motion of an entity in the last fixed step.
#[derive(Clone, Copy, Debug)]
struct Path {
    start: Transform,
    end: Transform,
    /// Transform that this module wrote or read last; any other was set by hand.
    shown: Transform,
}

impl Path {
    fn staying_at(transform: Transform) -> Self {
        Self { start: transform, end: transform, shown: transform }
    }

    /// Takes changes made by hand as jumps. Part by part, since scaling a ball does not move it.
    fn adopt(&mut self, seen: &Transform) {
        let Self { start, end, shown } = self;
        if seen.translation != shown.translation {
            (start.translation, end.translation) = (seen.translation, seen.translation);
        }
        if seen.rotation != shown.rotation {
            (start.rotation, end.rotation) = (seen.rotation, seen.rotation);
        }
        if seen.scale != shown.scale {
            (start.scale, end.scale) = (seen.scale, seen.scale);
        }
    }

    fn at(&self, fraction: f32) -> Transform {
        between(&self.start, &self.end, fraction)
    }
}

type InterpolatedQuery<'w, 's> =
    Query<'w, 's, (&'static mut Transform, &'static mut InterpolationState), With<Interpolated>>;

/// Restores the exact transforms of the last step before a fixed step.
fn restore_transforms(mut entities: InterpolatedQuery) {
    for (mut transform, mut state) in &mut entities {
        let path = state.0.get_or_insert(Path::staying_at(*transform));
        path.adopt(&transform);
        transform.set_if_neq(path.end);
        *path = Path::staying_at(path.end);
    }
}

/// Records transforms after a fixed step.
fn record_transforms(mut entities: InterpolatedQuery) {
    for (transform, mut state) in &mut entities {
        let path = state.0.get_or_insert(Path::staying_at(*transform));
        (path.end, path.shown) = (*transform, *transform);
    }
}

/// Shows interpolated transforms after the fixed loop.
fn show_transforms(mut entities: InterpolatedQuery, time: Option<Res<Time<Fixed>>>) {
    let fraction = step_fraction(time.as_deref());
    for (mut transform, mut state) in &mut entities {
        let path = state.0.get_or_insert(Path::staying_at(*transform));
        path.adopt(&transform);
        path.shown = path.at(fraction);
        transform.set_if_neq(path.shown);
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::FRAC_PI_2;

    use super::*;

    fn path() -> Path {
        let start = Transform::from_xyz(1.0, 2.0, 3.0);
        let end = Transform::from_xyz(3.0, 2.0, 1.0).with_rotation(Quat::from_rotation_y(FRAC_PI_2));
        Path { start, end, shown: end }
    }

    #[test]
    fn half_way_is_half_the_way_and_half_the_turn() {
        let half = path().at(0.5);
        assert!((half.translation - Vec3::new(2.0, 2.0, 2.0)).length() < 1e-6);
        assert!(half.rotation.angle_between(Quat::from_rotation_y(FRAC_PI_2 / 2.0)) < 1e-3);
    }

    #[test]
    fn the_ends_are_met_to_the_bit() {
        assert_eq!(path().at(0.0).translation, path().start.translation);
        assert_eq!(path().at(1.0), path().end);
    }

    #[test]
    fn opposite_quaternions_do_not_turn_the_long_way() {
        let mut path = path();
        path.start.rotation = path.end.rotation * -1.0;
        let turned = path.at(0.5).rotation;
        assert!(turned.angle_between(path.end.rotation) < 1e-3);
    }

    #[test]
    fn a_change_of_scale_does_not_stop_the_motion() {
        let mut path = path();
        let seen = path.shown.with_scale(Vec3::splat(2.0));
        path.adopt(&seen);
        assert_eq!(path.at(0.5).translation, Vec3::new(2.0, 2.0, 2.0));
        assert_eq!(path.at(0.5).scale, Vec3::splat(2.0));
    }

    #[test]
    fn a_jump_is_shown_at_once() {
        let mut path = path();
        path.adopt(&Transform::from_xyz(10.0, 0.0, 0.0));
        assert_eq!(path.at(0.0).translation, Vec3::new(10.0, 0.0, 0.0));
    }
}
