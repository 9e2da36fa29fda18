//! The messages that the log has about bad input.

use std::sync::Mutex;

use bevy::log::tracing_subscriber::{self, Layer, layer::SubscriberExt};
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::common::*;

/// Lines of the log of this process.
static LOG: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Collector;

impl<S: bevy::log::tracing::Subscriber> Layer<S> for Collector {
    fn on_event(&self, event: &bevy::log::tracing::Event<'_>, _: tracing_subscriber::layer::Context<'_, S>) {
        struct Line(String);
        impl bevy::log::tracing::field::Visit for Line {
            fn record_debug(&mut self, _: &bevy::log::tracing::field::Field, value: &dyn core::fmt::Debug) {
                self.0 += &format!("{value:?}");
            }
        }
        let mut line = Line(format!("{} ", event.metadata().level()));
        event.record(&mut line);
        LOG.lock().expect("no panic while it is held").push(line.0);
    }
}

#[test]
fn a_fault_is_logged_as_an_error_once() {
    let subscriber = tracing_subscriber::registry().with(Collector);
    bevy::log::tracing::subscriber::set_global_default(subscriber).expect("no other test logs");
    let mut app = app();
    // Other tests log, too: this value is this test's own.
    let cloth = app.world_mut().spawn((curtain(), Fabric { areal_density: -123.25, ..default() })).id();
    let transform = app
        .world_mut()
        .spawn((free_cloth(), Name::new("a lost banner"), Transform::from_xyz(f32::NAN, 0.0, 0.0)))
        .id();
    for _ in 0..60 {
        get_mut::<Cloth>(&mut app, cloth).set_changed();
        get_mut::<Transform>(&mut app, transform).set_changed();
        step(&mut app, 1);
    }
    drop(Cloth::new(7.5, 1.0));
    drop(Cloth::new(6.25, 1.0));
    let log = LOG.lock().expect("no panic while it is held");
    let told = |word: &str| log.iter().filter(|line| line.contains(word)).cloned().collect::<Vec<_>>();
    let lines = told("-123.25");
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].starts_with("ERROR") && lines[0].contains(&cloth.to_string()), "{lines:?}");
    let capped = told("7.5 m x 1 m");
    assert!(capped.len() == 1 && capped[0].starts_with("WARN"), "{capped:?}");
    assert!(told("6.25").is_empty(), "it has a particle every 5 cm");
    let named = told("“a lost banner”");
    assert_eq!(named.len(), 1, "{named:?}");
    assert!(named[0].contains("Transform") && named[0].contains(&transform.to_string()), "{named:?}");
    assert_eq!(refusals(&app, transform).len(), 1);
}
