//! Probes: measuring a world.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::drape_solver::state::measure;
use bevy_drape::drape_solver::{self, StateHasher, StickBatch, StickKind};
use bevy_drape::prelude::*;

use super::ScenePlay;
use super::points;
use super::stage::Parts;
use crate::scene::{Axis, Counted, Energy, Measure, Measured, Names, Probe};

impl ScenePlay {
    /// What `probe` measures now; none while what it names is not there.
    pub(super) fn measure(&self, world: &World, probe: &Probe) -> Option<Measured> {
        let number = |number: f64| Some(Measured::Number(number));
        let along = |vector: DVec3, axis: &Axis| match axis {
            Axis::X => vector.x,
            Axis::Y => vector.y,
            Axis::Z => vector.z,
            Axis::Length => vector.length(),
        };
        match probe {
            Probe::Position { of, point, axis, .. } => {
                let state = points::state(world, &self.stage, of.first()?, point)?;
                number(along(state.position, axis))
            }
            Probe::Velocity { of, point, axis, .. } => {
                let state = points::state(world, &self.stage, of.first()?, point)?;
                number(along(state.velocity, axis))
            }
            Probe::Distance { from, to } => {
                let from = points::state(world, &self.stage, &from.of, &from.point)?;
                let to = points::state(world, &self.stage, &to.of, &to.point)?;
                number(from.position.distance(to.position))
            }
            Probe::Speed { of } => number(speed(world, &self.parts(world, of)?)),
            Probe::Extent { of, axis } => {
                let (least, greatest) = bounds(world, &self.parts(world, of)?)?;
                number(along((greatest - least).as_dvec3(), axis))
            }
            Probe::Least { of, axis } => {
                number(along(bounds(world, &self.parts(world, of)?)?.0.as_dvec3(), axis))
            }
            Probe::Greatest { of, axis } => {
                number(along(bounds(world, &self.parts(world, of)?)?.1.as_dvec3(), axis))
            }
            Probe::Stretch { of, measure } => number(stretch(world, &self.parts(world, of)?, *measure)),
            Probe::Volume { of } => volume(world, &self.parts(world, of)?).map(Measured::Number),
            Probe::Penetration { of } => number(self.penetration(world, &self.parts(world, of)?)),
            Probe::Energy { of, kind, .. } => number(energy(world, &self.parts(world, of)?, *kind)),
            Probe::Momentum { of, axis } => number(along(momentum(world, &self.parts(world, of)?), axis)),
            Probe::AngularMomentum { of, axis } => {
                number(along(angular_momentum(world, &self.parts(world, of)?), axis))
            }
            Probe::Activity { of } => activity(world, &self.parts(world, of)?).map(Measured::Word),
            Probe::Count(counted) => {
                let ActivityCounts { active, resting, culled, frozen } = *world.resource::<ActivityCounts>();
                let count = match counted {
                    Counted::Bodies => active + resting + culled + frozen,
                    Counted::Active => active,
                    Counted::Resting => resting,
                    Counted::Culled => culled,
                };
                number(count as f64)
            }
            Probe::Hits { of, on } => number(self.tally.hits(of, on) as f64),
            Probe::Contacts { of, on } => number(self.tally.contacts(of, on) as f64),
            Probe::Touching { of, on } => number(self.tally.touching(of, on) as f64),
            Probe::Pieces { of } => number(self.parts(world, of)?.bodies.len() as f64),
            Probe::Torn { of } => number(self.tally.torn(of) as f64),
            Probe::StateHash { of } => {
                Some(Measured::Word(format!("{:016x}", state_hash(world, &self.parts(world, of)?))))
            }
            // The runner measures it, after the scene.
            Probe::StepTimeRatio { .. } => None,
        }
    }

    /// Hash of the state of everything that moves by itself.
    pub fn state_hash(&self, world: &World) -> u64 {
        state_hash(world, &self.stage.parts(world, []))
    }

    fn parts(&self, world: &World, names: &Names) -> Option<Parts> {
        Some(self.stage.parts(world, names.iter())).filter(|parts| !parts.is_empty())
    }

    fn penetration(&self, world: &World, parts: &Parts) -> f64 {
        let mut deepest = 0.0_f32;
        let everything = self.stage.parts(world, []);
        let mut look = |point: Vec3, radius: f32, own: Option<Entity>| {
            for (_, obstacle) in self.stage.obstacles() {
                let (Some(solid), Some(place)) =
                    (world.get::<Obstacle>(obstacle), world.get::<Transform>(obstacle))
                else {
                    continue;
                };
                if !solid.is_sensor {
                    let local = place.rotation.inverse() * (point - place.translation);
                    deepest = deepest.max(radius - solid.shape.distance(local));
                }
            }
            for &ball in everything.balls.iter().filter(|&&ball| Some(ball) != own) {
                if let Some(ball) = world.get::<ProjectileState>(ball) {
                    deepest = deepest.max(radius + ball.material().radius - point.distance(ball.position()));
                }
            }
        };
        for body in bodies(world, parts) {
            body.positions().for_each(|position| look(position, 0.0, None));
        }
        for &ball in &parts.balls {
            if let Some(state) = world.get::<ProjectileState>(ball) {
                look(state.position(), state.material().radius, Some(ball));
            }
        }
        f64::from(deepest)
    }
}

fn bodies<'a>(world: &'a World, parts: &'a Parts) -> impl Iterator<Item = &'a Particles> {
    parts.bodies.iter().filter_map(|&body| world.get::<Particles>(body))
}

fn balls<'a>(world: &'a World, parts: &'a Parts) -> impl Iterator<Item = &'a ProjectileState> {
    parts.balls.iter().filter_map(|&ball| world.get::<ProjectileState>(ball))
}

fn dynamics<'a>(
    world: &'a World,
    parts: &'a Parts,
) -> impl Iterator<Item = (&'a DynamicObstacle, &'a Transform)> {
    parts
        .obstacles
        .iter()
        .filter_map(|&obstacle| world.get::<DynamicObstacle>(obstacle).zip(world.get(obstacle)))
}

fn speed(world: &World, parts: &Parts) -> f64 {
    let of_bodies = bodies(world, parts).map(|body| f64::from(measure::mean_square_speed(body)).sqrt());
    let of_balls = balls(world, parts).map(|ball| ball.velocity().as_dvec3().length());
    let of_dynamics = dynamics(world, parts).map(|(dynamic, _)| dynamic.velocity.as_dvec3().length());
    of_bodies.chain(of_balls).chain(of_dynamics).fold(0.0, f64::max)
}

/// Least and greatest corner of what has particles or is a ball.
fn bounds(world: &World, parts: &Parts) -> Option<(Vec3, Vec3)> {
    let of_bodies = bodies(world, parts).map(|body| body.bounds());
    let of_balls = balls(world, parts).map(|ball| {
        let radius = ball.material().radius;
        (ball.position() - radius, ball.position() + radius)
    });
    of_bodies.chain(of_balls).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

fn stretch(world: &World, parts: &Parts, kind: Measure) -> f64 {
    let of_body = |&body: &Entity| {
        let (Some(particles), Some(sticks)) = (world.get::<Particles>(body), world.get::<Sticks>(body))
        else {
            return 0.0;
        };
        match kind {
            Measure::Rms => measure::stretch(particles, sticks).rms,
            Measure::Max => measure::stretch(particles, sticks).max,
            Measure::P99 => {
                let structural =
                    sticks.batches().iter().filter(|batch| batch.material.kind == StickKind::Structural);
                let mut strains: Vec<f64> = structural
                    .flat_map(StickBatch::range)
                    .map(|stick| {
                        let [a, b] = sticks.stick(stick).map(|end| particles.local_position(end as usize));
                        (f64::from(a.distance(b)) / f64::from(sticks.rest_length(stick)) - 1.0).abs()
                    })
                    .collect();
                strains.sort_unstable_by(f64::total_cmp);
                strains.get(strains.len().saturating_sub(1) * 99 / 100).copied().unwrap_or(0.0)
            }
        }
    };
    parts.bodies.iter().map(of_body).fold(0.0, f64::max)
}

fn volume(world: &World, parts: &Parts) -> Option<f64> {
    let of_body = |&body: &Entity| {
        let (particles, sticks) = (world.get::<Particles>(body)?, world.get::<Sticks>(body)?);
        Some(drape_solver::volume(particles, sticks) / sticks.rest_volume()?)
    };
    parts.bodies.iter().filter_map(of_body).max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
}

fn energy(world: &World, parts: &Parts, kind: Energy) -> f64 {
    let gravity = world.resource::<DrapeGravity>().0;
    let mut kinetic = 0.0;
    let mut potential = 0.0;
    for body in bodies(world, parts) {
        kinetic += measure::kinetic_energy(body);
        potential += measure::potential_energy(body, gravity);
    }
    let of_height = |mass: f32, place: Vec3| -f64::from(mass) * gravity.as_dvec3().dot(place.as_dvec3());
    for ball in balls(world, parts) {
        kinetic += f64::from(ball.kinetic_energy());
        potential += of_height(ball.material().mass, ball.position());
    }
    for (dynamic, place) in dynamics(world, parts) {
        let spin = (place.rotation.inverse() * dynamic.angular_velocity).as_dvec3();
        kinetic += 0.5 * f64::from(dynamic.mass) * dynamic.velocity.as_dvec3().length_squared();
        kinetic += 0.5 * spin.dot(spin * dynamic.inertia.as_dvec3());
        potential += of_height(dynamic.mass * dynamic.gravity_scale, place.translation);
    }
    match kind {
        Energy::Kinetic => kinetic,
        Energy::Potential => potential,
        Energy::Mechanical => kinetic + potential,
    }
}

fn momentum(world: &World, parts: &Parts) -> DVec3 {
    let of_bodies = bodies(world, parts).map(|body| measure::momentum(body));
    let of_balls =
        balls(world, parts).map(|ball| ball.velocity().as_dvec3() * f64::from(ball.material().mass));
    let of_dynamics =
        dynamics(world, parts).map(|(dynamic, _)| dynamic.velocity.as_dvec3() * f64::from(dynamic.mass));
    of_bodies.chain(of_balls).chain(of_dynamics).sum()
}

fn angular_momentum(world: &World, parts: &Parts) -> DVec3 {
    let of_bodies = bodies(world, parts).map(|body| measure::angular_momentum(body));
    let of_balls = balls(world, parts).map(|ball| {
        ball.position().as_dvec3().cross(ball.velocity().as_dvec3()) * f64::from(ball.material().mass)
    });
    let of_dynamics = dynamics(world, parts).map(|(dynamic, place)| {
        place.translation.as_dvec3().cross(dynamic.velocity.as_dvec3()) * f64::from(dynamic.mass)
    });
    of_bodies.chain(of_balls).chain(of_dynamics).sum()
}

fn activity(world: &World, parts: &Parts) -> Option<String> {
    let states = parts.bodies.iter().chain(&parts.balls).filter_map(|&entity| world.get::<Activity>(entity));
    let liveliest = states.min_by_key(|activity| match activity {
        Activity::Active => 0,
        Activity::Resting => 1,
        Activity::Frozen => 2,
        Activity::Culled => 3,
    })?;
    Some(format!("{liveliest:?}"))
}

fn state_hash(world: &World, parts: &Parts) -> u64 {
    let mut hasher = StateHasher::new();
    for body in bodies(world, parts) {
        hasher.particles(body);
    }
    for ball in balls(world, parts) {
        hasher.ball(ball);
    }
    for (dynamic, place) in dynamics(world, parts) {
        hasher
            .numbers(&place.translation.to_array())
            .numbers(&place.rotation.to_array())
            .numbers(&dynamic.velocity.to_array())
            .numbers(&dynamic.angular_velocity.to_array());
    }
    hasher.finish()
}
