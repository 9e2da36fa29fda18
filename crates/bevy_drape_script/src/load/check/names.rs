//! Checks that no name stands for two things.

use super::checker::{Checker, fail};
use crate::text::SceneError;

impl Checker<'_> {
    pub fn names(&self) -> Result<(), SceneError> {
        let bodies = &self.script.bodies;
        let obstacles = &self.script.obstacles;
        if let Some(name) = obstacles.keys().find(|name| bodies.contains_key(*name)) {
            return fail(&format!("obstacles.{name}"), format!("a body is called `{name}` already"));
        }
        let winds = &self.script.winds;
        let is_taken = |name: &&String| bodies.contains_key(*name) || obstacles.contains_key(*name);
        if let Some(name) = winds.keys().find(is_taken) {
            return fail(&format!("winds.{name}"), format!("something else is called `{name}` already"));
        }
        let is_taken = |name: &&String| is_taken(name) || winds.contains_key(*name);
        if let Some(name) = self.script.cannons.keys().find(is_taken) {
            return fail(&format!("cannons.{name}"), format!("something else is called `{name}` already"));
        }
        Ok(())
    }
}
