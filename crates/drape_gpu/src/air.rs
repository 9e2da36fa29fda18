//! Gravity and wind of a step, as the shaders read them.

use core::f64::consts::TAU;

use drape_solver::glam::Vec3;
use drape_solver::{Environment, Wind};

use crate::layout::{StepData, WaveData};

/// The environment of a step for the shaders, without the number of obstacles.
pub(crate) fn step_data(environment: &Environment) -> StepData {
    let Environment { dt, gravity, wind, time, .. } = environment;
    let Wind { velocity, air_density, drag_coefficient, lift_coefficient, turbulence, .. } = wind;
    let has_gusts = turbulence.speed > 0.0;
    let mut data = StepData {
        gravity: gravity.to_array(),
        duration: *dt,
        wind: velocity.to_array(),
        drag: 0.5 * air_density * drag_coefficient,
        lift: 0.5 * air_density * lift_coefficient,
        is_windy: u32::from(has_gusts || *velocity != Vec3::ZERO),
        ..StepData::default()
    };
    if has_gusts {
        let waves = turbulence.waves();
        data.wave_count = waves.len() as u32;
        for (slot, wave) in data.waves.iter_mut().zip(&waves) {
            *slot = WaveData {
                number: wave.number.as_vec3().to_array(),
                phase: (wave.phase_at_origin(*velocity, *time) % TAU) as f32,
                amplitude: wave.amplitude.as_vec3().to_array(),
                unused: 0.0,
            };
        }
    }
    data
}
