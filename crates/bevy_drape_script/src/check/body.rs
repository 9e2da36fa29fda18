//! Checks of what there is: bodies and obstacles.

use super::{Checker, fail, in_range, turn};
use crate::SceneError;
use crate::scene::{Body, Motion, Pins, Rig};
use crate::suggest::unknown;

impl Checker<'_> {
    fn material(&self, field: &str, material: Option<&str>) -> Result<(), SceneError> {
        match material {
            Some(name) if !self.script.materials.contains_key(name) => {
                let known = self.keys(&self.script.materials);
                let problem = unknown(&format!("no material is called `{name}`"), name, &known);
                fail(&format!("{field}.material"), problem)
            }
            _ => Ok(()),
        }
    }

    pub(super) fn bodies(&self) -> Result<(), SceneError> {
        for (name, body) in self.script.bodies.iter() {
            let field = format!("bodies.{name}");
            self.material(&field, body.material())?;
            if let Some((_, own)) = body.place() {
                turn(&format!("{field}.turn"), own)?;
            }
            match body {
                Body::Cloth(cloth) => {
                    if let Pins::Indices(indices) = &cloth.pins {
                        let count = cloth.particles.0.get() * cloth.particles.1.get();
                        for (i, &index) in indices.iter().enumerate() {
                            in_range(&format!("{field}.pins[{i}]"), index, count)?;
                        }
                    }
                }
                Body::Rope(rope) if rope.start == rope.end => {
                    return fail(&format!("{field}.end"), "expected another place than that of `start`");
                }
                Body::Rig(rig) => self.rig(&field, rig)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn rig(&self, field: &str, rig: &Rig) -> Result<(), SceneError> {
        if rig.particles.is_empty() {
            return fail(&format!("{field}.particles"), "expected one particle at least, found none");
        }
        for (index, stick) in rig.sticks.iter().enumerate() {
            for (end, name) in [("a", &stick.a), ("b", &stick.b)] {
                if !rig.particles.contains_key(name) {
                    let known = self.keys(&rig.particles);
                    let problem = unknown(&format!("no particle is called `{name}`"), name, &known);
                    return fail(&format!("{field}.sticks[{index}].{end}"), problem);
                }
            }
            if stick.a == stick.b {
                return fail(&format!("{field}.sticks[{index}].b"), "expected another particle than `a`");
            }
        }
        Ok(())
    }

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
