//! Where the systems run.

use bevy::ecs::schedule::{LogLevel, ScheduleBuildSettings, ScheduleLabel};
use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;

use crate::*;

#[test]
fn what_is_shown_does_not_depend_on_chance() {
    // Not in `FixedPostUpdate`, where a system of Bevy's own meets every exclusive one in either order.
    let mut app = app_in(FixedUpdate);
    app.add_plugins(GizmoPlugin);
    app.finish();
    app.cleanup();
    let settings = ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..default() };
    for schedule in [
        FixedFirst.intern(),
        FixedUpdate.intern(),
        FixedLast.intern(),
        RunFixedMainLoop.intern(),
        PostUpdate.intern(),
    ] {
        app.edit_schedule(schedule, |schedule| {
            schedule.set_build_settings(settings.clone());
        });
    }
    let cloth = app.world_mut().spawn(swinging()).id();
    app.update();
    frame(&mut app, 1.0);
    assert_eq!(vertices(&app, cloth).len(), 81);
}
