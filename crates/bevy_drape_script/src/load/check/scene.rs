//! Checks a scene as a whole.

use super::checker::{Checker, turn};
use crate::scene::SceneScript;
use crate::text::SceneError;

/// Checks everything that a field cannot know by itself.
///
/// # Errors
/// [`SceneError`] with the path of the first field that is wrong.
pub(crate) fn check(script: &SceneScript) -> Result<(), SceneError> {
    let checker = Checker::new(script)?;
    checker.names()?;
    checker.bodies()?;
    checker.obstacles()?;
    for (name, zone) in script.winds.iter() {
        turn(&format!("winds.{name}.turn"), &zone.turn)?;
    }
    for (name, cannon) in script.cannons.iter() {
        turn(&format!("cannons.{name}.turn"), &cannon.turn)?;
    }
    for (index, event) in script.timeline.iter().enumerate() {
        checker.event(&format!("timeline[{index}]"), event)?;
    }
    for (index, expectation) in script.expectations.iter().enumerate() {
        let field = format!("expectations[{index}]");
        checker.when(&field, &expectation.when)?;
        checker.since(&field, &expectation.probe, &expectation.when)?;
        checker.probe(&field, &expectation.probe, &expectation.expect)?;
    }
    Ok(())
}
