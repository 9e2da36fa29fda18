//! Checks of obstacles.

use super::checker::{Checker, fail, turn};
use crate::scene::Motion;
use crate::text::SceneError;

impl Checker<'_> {
    pub(super) fn obstacles(&self) -> Result<(), SceneError> {
        for (name, obstacle) in self.script.obstacles.iter() {
            let field = format!("obstacles.{name}");
            self.material(&field, obstacle.material.as_deref())?;
            turn(&format!("{field}.turn"), &obstacle.turn)?;
            if let Err(error) = obstacle.shape.build() {
                return fail(&format!("{field}.shape"), error);
            }
            match &obstacle.motion {
                Motion::Static | Motion::Steady(_) => {}
                Motion::Keyframes(keyframes) => {
                    let field = format!("{field}.motion.keys");
                    if keyframes.keys.is_empty() {
                        return fail(&field, "expected one key at least, found none");
                    }
                    for (index, pair) in keyframes.keys.windows(2).enumerate() {
                        if pair[1].time <= pair[0].time {
                            let field = format!("{field}[{}].time", index + 1);
                            let problem = format!("expected a time after {} s", pair[0].time.get());
                            return fail(&field, problem);
                        }
                    }
                    for (index, key) in keyframes.keys.iter().enumerate() {
                        turn(&format!("{field}[{index}].turn"), &key.turn)?;
                    }
                }
                Motion::Dynamic(dynamic) => {
                    if dynamic.component(&obstacle.shape).is_none() {
                        let problem =
                            "expected moments of inertia, as this shape is neither a sphere nor a cuboid";
                        return fail(&format!("{field}.motion.inertia"), problem);
                    }
                }
            }
        }
        Ok(())
    }
}
