//! An example of one feature, as an app.
//!
//! An example is a [`Feature`] and the function that sets its scene up. All it says about drawing is a
//! [`Paint`](crate::view::paint::Paint), so the same code runs in tests without a renderer.

use core::time::Duration;

use bevy::input::InputPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

/// An example of one feature.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// The title of the window.
    pub title: &'static str,
    /// The keys, for the window; may be empty.
    pub controls: &'static str,
    /// Position of the camera in metres.
    pub eye: Vec3,
    /// The point that the camera looks at, in metres.
    pub target: Vec3,
    /// Simulated time of the picture, in seconds.
    pub picture_time: f32,
    /// Adds the example to an app that has the plugins.
    pub build: fn(&mut App),
}

impl Feature {
    /// The schedules of the example, to be run in the world of an app that has the plugins already.
    pub fn schedules(&self) -> Schedules {
        let mut script = App::empty();
        script.init_resource::<Schedules>();
        (self.build)(&mut script);
        script.world_mut().remove_resource().unwrap_or_default()
    }

    /// An app without a renderer that has the example in it, and takes one step in each update but the first.
    pub fn headless_app(&self) -> App {
        let mut app = bare_app();
        (self.build)(&mut app);
        app.finish();
        app.cleanup();
        app
    }
}

/// An app without a renderer that has nothing in it yet, and takes one step in each update but the first.
pub fn bare_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, InputPlugin));
    #[cfg(feature = "meshes")]
    app.add_plugins(crate::view::asset_files::MeshFilePlugins);
    app.add_plugins(DrapePlugins::default()).insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app
}

/// The number of steps that `app` takes in this many simulated seconds.
pub fn steps_in(app: &App, seconds: f32) -> u64 {
    let dt = app.world().resource::<Time<Fixed>>().timestep();
    Duration::from_secs_f32(seconds.max(0.0)).div_duration_f64(dt).round() as u64
}
