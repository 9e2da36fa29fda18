//! Balls against obstacles: projection, friction with spin, rolling resistance.
//!
//! Design: `docs/design/contacts.md`.

use glam::Vec3;

use crate::constants::BALL_TRAVEL_PER_SUBSTEP;
use crate::contact::depenetration::{InitialOverlap, PushOutRate};
use crate::contact::event::{BallProjection, Other, Touch, add_impulse, record};
use crate::contact::mover::{Mover, mover_mut};
use crate::contact::obstacle_push::ObstaclePush;
use crate::contact::restitution::Impact;
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape, container_walls};
use crate::state::ball::{Ball, BallMaterial, SURFACE_INVERSE_MASS};
use crate::state::obstacles::Obstacles;
use crate::state::substep::Substep;

/// The contacts of an island's balls with obstacles.
#[derive(Clone, Debug, Default)]
pub(crate) struct BallObstacleContacts {
    pub pairs: Vec<BallObstacle>,
    /// Pairs of a ball and a near obstacle that does not stop it, such as a sensor.
    pub passable: Vec<(usize, usize)>,
    /// Obstacles near the ball that is searched.
    near: Vec<u32>,
}

impl BallObstacleContacts {
    /// Obstacles that a ball may touch, by index; one for each pair.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.iter().map(|pair| pair.obstacle)
    }

    /// The pushes of obstacles on balls in the last substep.
    pub fn given<'a>(&'a self, balls: &'a [Ball]) -> impl Iterator<Item = ObstaclePush> + 'a {
        self.pairs.iter().filter_map(|pair| pair.given(balls))
    }
}

/// A ball and an obstacle that may touch in this step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallObstacle {
    ball: usize,
    obstacle: usize,
    plane: Option<Plane>,
    /// The surface that the ball runs into in this substep, if it could otherwise pass through the obstacle.
    ahead: Option<Plane>,
    depth: f32,
    overlap: InitialOverlap,
    impact: Impact,
    normal: Vec3,
    given: BallPush,
    before: Pose,
    now: Pose,
}

/// The push of an obstacle on a ball in one substep.
#[derive(Clone, Copy, Debug, Default)]
struct BallPush {
    /// Mass times displacement, in kilogram metres.
    push: Vec3,
    /// The change of spin: moment of inertia times turn, in kg m^2.
    moment: Vec3,
}

impl BallObstacle {
    /// The push of the obstacle on the ball in the last substep, if there was one.
    fn given(&self, balls: &[Ball]) -> Option<ObstaclePush> {
        let BallPush { push, moment } = self.given;
        (self.depth > 0.0).then(|| self.obstacle_push(&balls[self.ball], push, moment))
    }

    /// The mover, if the obstacle is one; the pair takes its poses.
    fn follow<'a>(&mut self, movers: &'a mut [Mover]) -> Option<&'a mut Mover> {
        let mover = mover_mut(movers, self.obstacle)?;
        [self.before, self.now] = mover.poses(Vec3::ZERO);
        Some(mover)
    }

    /// A push (kg m) of the obstacle on the ball, with the change of spin (kg m^2) that it gives.
    fn obstacle_push(&self, ball: &Ball, push: Vec3, moment: Vec3) -> ObstaclePush {
        // A push changes the displacement of the whole substep, so it acts where the displacement began.
        let point = (ball.position - ball.travel()).as_dvec3();
        ObstaclePush { obstacle: self.obstacle, point, push, moment }
    }

    /// Adds up the push that moves the ball by `distance` (metres) along the normal, and pushes the mover back.
    fn give(&mut self, ball: &Ball, distance: f32, mover: Option<&mut Mover>, substep: f32) {
        let given = self.normal * (distance * ball.material.mass);
        self.given.push += given;
        if let Some(mover) = mover {
            mover.receive(self.obstacle_push(ball, given, Vec3::ZERO), substep);
        }
    }

    /// The plane that the ball runs into on its way through the obstacle's coordinates. None unless the way is so long
    /// that the ball could pass the obstacle within the substep.
    fn plane_ahead(&self, ball: &Ball, shape: &Shape) -> Option<Plane> {
        let start = self.before.to_local(ball.position - ball.displacement);
        let way = self.now.to_local(ball.position) - start;
        let radius = ball.material.radius;
        let is_far = way.length() > radius * BALL_TRAVEL_PER_SUBSTEP * 1.01 + shape.least_half_extent();
        if !is_far || shape.surface(start).distance <= 0.0 {
            return None;
        }
        shape.sweep_ball(radius, start, way).map(|meeting| meeting.plane)
    }
}

/// Lists the pairs whose boxes come within `dt` seconds of each other.
pub(crate) fn detect(
    contacts: &mut BallObstacleContacts,
    balls: &[Ball],
    obstacles: &Obstacles,
    dt: f32,
    gravity: f32,
) {
    let BallObstacleContacts { pairs, passable, near } = contacts;
    pairs.clear();
    passable.clear();
    for (ball_index, ball) in balls.iter().enumerate() {
        let reach = ball.reach(dt, gravity);
        near.clear();
        obstacles.near(ball.position - reach, ball.position + reach, near);
        for obstacle_index in near.iter().map(|&index| index as usize) {
            let obstacle = &obstacles[obstacle_index];
            if !obstacle.stops(ball.layers) {
                passable.push((ball_index, obstacle_index));
                continue;
            }
            let pose = obstacle.pose_at(0.0, Vec3::ZERO);
            let mut add = |plane| {
                pairs.push(BallObstacle {
                    ball: ball_index,
                    obstacle: obstacle_index,
                    plane,
                    ahead: None,
                    depth: 0.0,
                    overlap: InitialOverlap::default(),
                    impact: Impact::default(),
                    normal: Vec3::ZERO,
                    given: BallPush::default(),
                    before: pose,
                    now: pose,
                });
            };
            if let Shape::Container { half_extents } = obstacle.shape() {
                container_walls(*half_extents).into_iter().for_each(|wall| add(Some(wall)));
            } else {
                add(None);
            }
        }
    }
}

/// Moves the obstacles to the end of this substep and forgets the depths of the last one.
pub(crate) fn begin_substep(
    contacts: &mut BallObstacleContacts,
    balls: &[Ball],
    movers: &mut [Mover],
    substep: Substep,
) {
    let Substep { obstacles, index, count, .. } = substep;
    for pair in &mut contacts.pairs {
        if pair.follow(movers).is_none() {
            let obstacle = &obstacles[pair.obstacle];
            let pose_at = |k: u32| obstacle.pose_at(k as f32 / count as f32, Vec3::ZERO);
            [pair.before, pair.now] = [index, index + 1].map(pose_at);
        }
        pair.depth = 0.0;
        pair.overlap = InitialOverlap::default();
        pair.given = BallPush::default();
        pair.impact = Impact::default();
        pair.ahead = pair.plane_ahead(&balls[pair.ball], obstacles[pair.obstacle].shape());
    }
}

/// Moves every ball that lies inside an obstacle out to its surface.
pub(crate) fn project(
    contacts: &mut BallObstacleContacts,
    balls: &mut [Ball],
    movers: &mut [Mover],
    touches: &mut Vec<Touch>,
    substep: Substep,
) {
    let (rate, obstacles) = (PushOutRate::of(substep), substep.obstacles);
    for pair in &mut contacts.pairs {
        let ball = &mut balls[pair.ball];
        let mover = pair.follow(movers);
        let local = pair.now.to_local(ball.position);
        let (plane, shape) = (pair.plane.or(pair.ahead), obstacles[pair.obstacle].shape());
        let surface_at = |local: Vec3| shape.surface_or(plane, local);
        let surface = surface_at(local);
        let depth = ball.material.radius - surface.distance;
        if depth > 0.0 {
            pair.normal = pair.now.direction_to_world(surface.normal);
            let travel = ball.travel();
            let carried = pair.now.point_to_world(local) - pair.before.point_to_world(local);
            let gap_change = (travel - carried).dot(pair.normal);
            let start = pair.before.to_local(ball.position - travel);
            let at_start = || ball.material.radius - surface_at(start).distance;
            let push = pair.overlap.split(depth, gap_change, at_start, rate);
            let point = ball.position - pair.normal * surface.distance;
            let distance = push.with_velocity * own_share(ball, mover.as_deref(), point, pair.normal);
            pair.depth += distance;
            let projection = BallProjection {
                ball: pair.ball,
                other: Other::Obstacle(pair.obstacle),
                gap: -depth,
                gap_change,
                ball_position: ball.position,
                ball_travel: travel,
                point,
                normal: pair.normal,
            };
            let impulse = distance * ball.material.mass / substep.duration;
            record(touches, &projection, impulse, substep.index, substep.duration);
            pair.impact.note(gap_change, projection.fraction());
            pair.give(ball, distance, mover, substep.duration);
            ball.project(pair.normal * distance, pair.normal * push.position_only);
        }
    }
}

/// Moves balls that met an obstacle in this substep away from it, as fast as their restitution says.
pub(crate) fn rebound(
    contacts: &mut BallObstacleContacts,
    balls: &mut [Ball],
    movers: &mut [Mover],
    touches: &mut [Touch],
    substep: Substep,
) {
    for pair in &mut contacts.pairs {
        let (ball, obstacle) = (&mut balls[pair.ball], &substep.obstacles[pair.obstacle]);
        let restitution = obstacle.restitution_against(ball.material.restitution);
        let Some(rebound) = pair.impact.rebound(restitution, substep.duration) else {
            continue;
        };
        let mover = pair.follow(movers);
        let point = ball.position - pair.normal * ball.material.radius;
        let carried = point - pair.before.point_to_world(pair.now.to_local(point));
        let share = own_share(ball, mover.as_deref(), point, pair.normal);
        let change = share * (rebound.displacement - (ball.displacement - carried).dot(pair.normal));
        if change <= 0.0 {
            // Another contact has already moved the ball away faster than this, and no contact pulls.
            continue;
        }
        pair.depth += change;
        let impulse = change * ball.material.mass / substep.duration;
        add_impulse(touches, pair.ball, Other::Obstacle(pair.obstacle), impulse);
        pair.give(ball, change, mover, substep.duration);
        ball.displacement += pair.normal * change;
        ball.position += pair.normal * (share * rebound.position);
    }
}

/// Friction at the point of contact, which turns sliding into rolling, and the resistance that ends rolling.
pub(crate) fn apply_friction(
    contacts: &mut BallObstacleContacts,
    balls: &mut [Ball],
    movers: &mut [Mover],
    substep: Substep,
) {
    for pair in &mut contacts.pairs {
        if pair.depth == 0.0 {
            continue;
        }
        let ball = &mut balls[pair.ball];
        let mover = pair.follow(movers);
        let obstacle = &substep.obstacles[pair.obstacle];
        let friction = obstacle.friction_against(ball.material.surface_friction());
        let arm = pair.normal * -ball.material.radius;
        let point = ball.position + arm;
        let carried = point - pair.before.point_to_world(pair.now.to_local(point));
        // A push of slip / (3.5 w) stops the slip of a sphere's surface. Coulomb's limit holds for the push on a mass
        // point, mu * depth / w; as a slip it is 3.5 times as long.
        let slip = ball.surface_travel(arm) - carried;
        let (friction, inverse_mass) =
            (friction.scaled(SURFACE_INVERSE_MASS), SURFACE_INVERSE_MASS * ball.inverse_mass);
        let push = match &mover {
            Some(mover) => mover.slip_taken(friction, inverse_mass, slip, pair.normal, pair.depth, point).1,
            None => -friction.slip_taken(slip, pair.normal, pair.depth) / inverse_mass,
        };
        let spin = ball.spin;
        ball.push_surface(arm, push);
        resist_rolling(ball, pair.depth);
        let moment = (ball.spin - spin) * (ball.moment_of_inertia() * ball.substep);
        pair.given.push += push;
        pair.given.moment += moment;
        if let Some(mover) = mover {
            mover.receive(pair.obstacle_push(ball, push, moment), substep.duration);
        }
    }
}

/// The fraction of a push along the unit vector `normal` that moves the ball; the rest moves the obstacle, if it is a
/// mover.
fn own_share(ball: &Ball, mover: Option<&Mover>, point: Vec3, normal: Vec3) -> f32 {
    mover.map_or(1.0, |mover| ball.inverse_mass / (ball.inverse_mass + mover.inverse_mass_at(point, normal)))
}

/// The ground's reaction acts ahead of the centre by `rolling_resistance` radii and so brakes the spin by the moment
/// `resistance r N`, with `N h^2 = m depth`; it never reverses the spin. Spin about the normal is braked as well, so
/// that no ball whirls on the spot for ever.
fn resist_rolling(ball: &mut Ball, depth: f32) {
    let spin = ball.spin.length();
    let BallMaterial { radius, rolling_resistance, .. } = ball.material;
    let most = 2.5 * rolling_resistance * depth / (radius * ball.substep);
    ball.spin = if spin <= most { Vec3::ZERO } else { ball.spin * (1.0 - most / spin) };
}
