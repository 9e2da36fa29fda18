//! All examples of features in one window.
//!
//! An example adds its systems to an empty app, of which only the schedules are kept. They run in the showcase's world while
//! the example is shown.

use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_drape::body::{DefaultBodySurface, DefaultSolverSettings};
use bevy_drape::prelude::*;
use bevy_drape::rig::Stick;

use crate::feature::example::Feature;
use crate::feature::materials::FeatureMaterialsPlugin;
use crate::feature::picture::FIELD_OF_VIEW;
use crate::showcase::film::FrameRecorderPlugin;
use crate::showcase::panel::ShowcasePanelPlugin;
use crate::showcase::selection::Showcase;
use crate::view::IN_PAGE;
use crate::view::clock_keys::control_clock;
use crate::view::orbit::Orbit;
use crate::view::pointer::PointerPlugin;
use crate::view::viewpoint::Viewpoint;
use crate::view::window::WindowError;
use crate::view::window::bare_app;

/// The systems of the example that is shown.
#[derive(Resource, Default)]
struct Playing(Vec<Schedule>);

/// Marks entities that were there before the first example. All others are despawned when the next example begins.
#[derive(Component)]
struct Stays;

/// Opens the window and stays until it is closed.
///
/// # Errors
/// `WindowError` if there is no display, or nothing to draw with.
pub fn open(features: &'static [(&'static str, Feature)]) -> Result<(), WindowError> {
    let mut app = bare_app("bevy_drape: showcase")?;
    app.add_plugins((FeatureMaterialsPlugin, PointerPlugin, ShowcasePanelPlugin))
        .insert_resource(Showcase { features, current: 0, is_due: true })
        .init_resource::<Playing>()
        .add_systems(PostStartup, keep)
        // First of all: other systems may hold commands for entities that are despawned here.
        .add_systems(First, show.run_if(|showcase: Res<Showcase>| showcase.is_due))
        .add_systems(FixedUpdate, |world: &mut World| play(world, FixedUpdate.intern()))
        .add_systems(Update, |world: &mut World| play(world, Update.intern()))
        .add_systems(Update, (control_clock, control));
    // A page has no folder for films.
    if !IN_PAGE {
        app.add_plugins(FrameRecorderPlugin);
    }
    #[cfg(all(feature = "web", target_family = "wasm"))]
    app.add_plugins(crate::showcase::page::ShowcasePagePlugin);
    app.run();
    Ok(())
}

/// Marks all entities that belong to no example.
fn keep(world: &mut World) {
    let all: Vec<Entity> = world.query::<Entity>().iter(world).collect();
    for entity in all {
        world.entity_mut(entity).insert(Stays);
    }
}

/// Despawns the old example and begins the chosen one.
fn show(world: &mut World) {
    let entities: Vec<Entity> = world
        .query_filtered::<Entity, (Without<Stays>, Without<ChildOf>, Or<(With<Transform>, With<Stick>)>)>()
        .iter(world)
        .collect();
    for entity in entities {
        if let Ok(entity) = world.get_entity_mut(entity) {
            entity.despawn();
        }
    }
    world.insert_resource(Wind::default());
    world.insert_resource(DrapeGravity::default());
    world.insert_resource(DefaultSolverSettings::default());
    world.insert_resource(DefaultBodySurface::default());
    world.insert_resource(Time::<Fixed>::default());
    let mut showcase = world.resource_mut::<Showcase>();
    showcase.is_due = false;
    let feature = *showcase.feature();
    let mut schedules = feature.schedules();
    if let Some(mut setup) = schedules.remove(Startup) {
        setup.run(world);
    }
    let rest = [FixedUpdate.intern(), Update.intern()];
    world.resource_mut::<Playing>().0 =
        rest.into_iter().filter_map(|label| schedules.remove(label)).collect();
    look(world, &feature);
}

/// Runs the systems of the example in this schedule.
fn play(world: &mut World, label: InternedScheduleLabel) {
    let mut playing = core::mem::take(&mut world.resource_mut::<Playing>().0);
    for schedule in playing.iter_mut().filter(|schedule| schedule.label() == label) {
        schedule.run(world);
    }
    world.resource_mut::<Playing>().0 = playing;
}

fn look(world: &mut World, feature: &Feature) {
    let view = Viewpoint { eye: feature.eye, target: feature.target, field_of_view: FIELD_OF_VIEW };
    let mut cameras = world.query::<(&mut Orbit, &mut Transform, &mut Projection)>();
    for (mut orbit, mut transform, mut projection) in cameras.iter_mut(world) {
        *orbit = view.orbit();
        view.apply(&mut transform, &mut projection);
    }
}

fn control(
    keys: Res<ButtonInput<KeyCode>>,
    mut showcase: ResMut<Showcase>,
    mut gizmos: ResMut<GizmoConfigStore>,
) {
    let count = showcase.features.len();
    let step = match () {
        () if keys.just_pressed(KeyCode::ArrowRight) => 1,
        () if keys.just_pressed(KeyCode::ArrowLeft) => count - 1,
        () => 0,
    };
    if step > 0 {
        showcase.current = (showcase.current + step) % count;
    }
    if step > 0 || keys.just_pressed(KeyCode::KeyR) {
        showcase.is_due = true;
    }
    if keys.just_pressed(KeyCode::KeyG) {
        let drape = gizmos.config_mut::<DrapeGizmos>().0;
        drape.enabled = !drape.enabled;
    }
}
