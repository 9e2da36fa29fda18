//! The mark on bodies, balls and obstacles whose contacts are reported.

use bevy::prelude::*;

/// Marks a body, ball or obstacle whose contacts are reported by
/// [`DrapeContactStarted`](crate::contact::events::DrapeContactStarted),
/// [`DrapeContactHit`](crate::contact::events::DrapeContactHit) and
/// [`DrapeContactEnded`](crate::contact::events::DrapeContactEnded). A contact is reported if either of the two has the
/// mark.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::contact::DrapeContactStarted;
///
/// fn set_up(mut commands: Commands) {
///     commands.spawn((Obstacle::cuboid(4.0, 0.1, 4.0).as_sensor(), ContactEvents));
/// }
///
/// fn listen(mut started: MessageReader<DrapeContactStarted>) {
///     for contact in started.read() {
///         println!("{} touches {} at {}", contact.body, contact.other, contact.point);
///     }
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct ContactEvents;
