//! Friction and restitution of a collider: its own, else those of its rigid body, else the default of the world.

use avian2d::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_drape::environment::CombineRule;
use bevy_drape::prelude::*;

/// What a collider is like to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub friction: Friction,
    pub restitution: Restitution,
}

impl Surface {
    /// An obstacle with the surface, of any shape.
    pub fn obstacle(&self) -> Obstacle {
        Obstacle {
            friction: self.friction.dynamic_coefficient,
            static_friction: self.friction.static_coefficient,
            friction_rule: rule(self.friction.combine_rule),
            restitution: self.restitution.coefficient,
            restitution_rule: rule(self.restitution.combine_rule),
            ..default()
        }
    }
}

/// Materials of colliders and bodies, and the defaults.
#[derive(SystemParam)]
pub(crate) struct Surfaces<'w, 's> {
    materials: Query<'w, 's, (Option<&'static Friction>, Option<&'static Restitution>)>,
    bodies: Query<'w, 's, &'static ColliderOf>,
    default_friction: Res<'w, DefaultFriction>,
    default_restitution: Res<'w, DefaultRestitution>,
}

impl Surfaces<'_, '_> {
    /// The surface of a collider, by the rules of Avian's narrow phase.
    pub fn of(&self, collider: Entity) -> Surface {
        let (own_friction, own_restitution) = self.materials.get(collider).unwrap_or_default();
        let body = self.bodies.get(collider).ok().and_then(|of| self.materials.get(of.body).ok());
        let (body_friction, body_restitution) = body.unwrap_or_default();
        Surface {
            friction: *own_friction.or(body_friction).unwrap_or(&self.default_friction.0),
            restitution: *own_restitution.or(body_restitution).unwrap_or(&self.default_restitution.0),
        }
    }
}

/// The same rule in cloth's terms. Cloth has Avian's default rule, the average, which yields to all others.
fn rule(rule: CoefficientCombine) -> CombineRule {
    match rule {
        CoefficientCombine::Average => CombineRule::Average,
        CoefficientCombine::GeometricMean => CombineRule::GeometricMean,
        CoefficientCombine::Min => CombineRule::Min,
        CoefficientCombine::Multiply => CombineRule::Multiply,
        CoefficientCombine::Max => CombineRule::Max,
    }
}
