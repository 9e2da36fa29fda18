//! Checks of bodies.

use super::checker::{Checker, fail, in_range, turn};
use crate::scene::{Body, Pins, Rig};
use crate::text::{SceneError, unknown};

impl Checker<'_> {
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
}
