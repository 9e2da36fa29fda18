//! Gizmos that show the solver's view of the scene: sticks coloured by strain, particles, pins, contacts.
//!
//! Off by default:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn show_gizmos(mut store: ResMut<GizmoConfigStore>) {
//!     let (config, drape) = store.config_mut::<DrapeGizmos>();
//!     config.enabled = true;
//!     drape.bend_sticks = true;
//! }
//! ```
//!
//! They show the last step, while meshes show states between the last two steps.

use bevy::color::Color;
use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;
use bevy::transform::TransformSystems;
use drape_solver::StickKind;

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::step::islands::Islands;
use crate::tools::obstacle_gizmos::draw_obstacles;

/// Gizmos to draw when this group is enabled in the `GizmoConfigStore`; see the [module](self).
#[derive(Reflect, GizmoConfigGroup, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct DrapeGizmos {
    /// Sticks that keep from stretching, coloured by [`strain_color`].
    pub structural_sticks: bool,
    /// Sticks that keep from skewing, coloured by [`strain_color`].
    pub shear_sticks: bool,
    /// Sticks that keep from folding, coloured by [`strain_color`].
    pub bend_sticks: bool,
    /// Free particles, as small crosses.
    pub particles: bool,
    /// Pinned particles, as larger crosses.
    pub pins: bool,
    /// Particles that an obstacle pushed out in the last substep, each with the surface's normal.
    pub contacts: bool,
    /// Points where balls first touched something in the last step, each with the normal.
    pub touches: bool,
    /// Outlines of obstacles; none of half-spaces, meshes, hulls and shapes of parry.
    pub obstacles: bool,
    /// Strain at which a stick becomes fully red (a fraction, 0.05 is 5 %).
    pub full_strain: f32,
    /// Half the size of a particle's cross in metres; pins are twice as large, normals eight times as long.
    pub particle_size: f32,
}

impl Default for DrapeGizmos {
    fn default() -> Self {
        Self {
            structural_sticks: true,
            shear_sticks: false,
            bend_sticks: false,
            particles: false,
            pins: true,
            contacts: true,
            touches: true,
            obstacles: false,
            full_strain: 0.05,
            particle_size: 0.01,
        }
    }
}

/// Draws [`DrapeGizmos`]. Does nothing in an app without Bevy's `GizmoPlugin`.
#[derive(Clone, Copy, Debug, Default)]
pub struct GizmosPlugin;

impl Plugin for GizmosPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<DrapeGizmos>();
    }

    /// All plugins are added by now, so it is known if the app has gizmos.
    fn finish(&self, app: &mut App) {
        if !app.is_plugin_added::<GizmoPlugin>() {
            return;
        }
        let store = app.world().get_resource::<GizmoConfigStore>();
        if store.is_none_or(|store| store.get_config::<DrapeGizmos>().is_none()) {
            // A small offset towards the camera, so that sticks are drawn on the cloth and not in it.
            let config = GizmoConfig { enabled: false, depth_bias: -0.002, ..default() };
            app.insert_gizmo_config(DrapeGizmos::default(), config);
        }
        app.add_systems(
            PostUpdate,
            (draw_bodies, draw_touches, draw_obstacles).after(TransformSystems::Propagate),
        );
    }
}

const PARTICLE_COLOR: Color = Color::srgb(0.8, 0.8, 0.8);
const PIN_COLOR: Color = Color::srgb(1.0, 0.2, 1.0);
const CONTACT_COLOR: Color = Color::srgb(1.0, 0.6, 0.0);
const TOUCH_COLOR: Color = Color::srgb(1.0, 1.0, 1.0);
const NORMAL_LENGTH: f32 = 8.0;

/// Colour of a stick of strain `strain` (length / rest length - 1): green at rest length, over yellow to red at
/// `full_strain` and more, and to blue at `-full_strain` and less.
pub fn strain_color(strain: f32, full_strain: f32) -> Color {
    let part = if strain == 0.0 { 0.0 } else { (strain / full_strain.abs()).clamp(-1.0, 1.0) };
    if part >= 0.0 {
        Color::srgb((2.0 * part).min(1.0), (2.0 - 2.0 * part).min(1.0), 0.0)
    } else {
        Color::srgb(0.0, (2.0 + 2.0 * part).min(1.0), (-2.0 * part).min(1.0))
    }
}

fn draw_bodies(mut gizmos: Gizmos<DrapeGizmos>, bodies: Query<(&Particles, &Sticks, &BodyState, &Activity)>) {
    if !gizmos.config.enabled {
        return;
    }
    let drawn = *gizmos.config_ext;
    for (particles, sticks, state, &activity) in &bodies {
        if activity == Activity::Culled || particles.len() != sticks.particle_count() {
            continue;
        }
        for batch in sticks.batches() {
            let is_drawn = match batch.material.kind {
                StickKind::Structural => drawn.structural_sticks,
                StickKind::Shear => drawn.shear_sticks,
                StickKind::Bend => drawn.bend_sticks,
            };
            for stick in batch.range().filter(|_| is_drawn) {
                let [a, b] = sticks.stick(stick).map(|end| particles.position(end as usize));
                let strain = a.distance(b) / sticks.rest_length(stick) - 1.0;
                gizmos.line(a, b, strain_color(strain, drawn.full_strain));
            }
        }
        for i in 0..particles.len() {
            if particles.is_pinned(i) && drawn.pins {
                gizmos.cross(particles.position(i), 2.0 * drawn.particle_size, PIN_COLOR);
            } else if drawn.particles && !particles.is_pinned(i) {
                gizmos.cross(particles.position(i), drawn.particle_size, PARTICLE_COLOR);
            }
        }
        if drawn.contacts {
            for (i, normal, _) in state.scratch.contacts().filter(|&(i, ..)| i < particles.len()) {
                let point = particles.position(i);
                gizmos.line(point, point + normal * (NORMAL_LENGTH * drawn.particle_size), CONTACT_COLOR);
            }
        }
    }
}

fn draw_touches(mut gizmos: Gizmos<DrapeGizmos>, islands: Res<Islands>) {
    let drawn = *gizmos.config_ext;
    if !gizmos.config.enabled || !drawn.touches {
        return;
    }
    for touch in islands.live().iter().flat_map(|island| &island.solver().touches) {
        gizmos.cross(touch.point, 2.0 * drawn.particle_size, TOUCH_COLOR);
        let tip = touch.point + touch.normal * (NORMAL_LENGTH * drawn.particle_size);
        gizmos.line(touch.point, tip, TOUCH_COLOR);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_goes_from_blue_over_green_to_red() {
        let [blue, green, red] =
            [Color::srgb(0.0, 0.0, 1.0), Color::srgb(0.0, 1.0, 0.0), Color::srgb(1.0, 0.0, 0.0)];
        assert_eq!(strain_color(-0.05, 0.05), blue);
        assert_eq!(strain_color(0.0, 0.05), green);
        assert_eq!(strain_color(0.025, 0.05), Color::srgb(1.0, 1.0, 0.0));
        assert_eq!(strain_color(0.05, 0.05), red);
    }

    #[test]
    fn colour_stays_the_same_beyond_full_strain() {
        assert_eq!(strain_color(3.0, 0.05), strain_color(0.05, 0.05));
        assert_eq!(strain_color(-1.0, 0.05), strain_color(-0.05, 0.05));
    }

    #[test]
    fn a_full_strain_of_zero_colours_every_strain_fully() {
        assert_eq!(strain_color(1e-6, 0.0), strain_color(1.0, 0.05));
        assert_eq!(strain_color(0.0, 0.0), strain_color(0.0, 0.05));
    }
}
