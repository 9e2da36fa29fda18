//! The stages of a substep, one by one: each of [their list](crate::substep::order) as the call that does its work.
//!
//! Design: `docs/design/relaxation.md`.

use glam::Vec3;

use crate::constants::{CONTACT_MARGIN_OF_SURFACES, OVER_RELAXATION, ROUNDS_OF_LAYERS};
use crate::constraint::{angular_momentum, bend, volume};
use crate::contact::ball_cloth::BallClothContacts;
use crate::contact::island_contacts::IslandContacts;
use crate::contact::mover::Mover;
use crate::contact::{
    ball_ball, ball_cloth, ball_obstacle, dynamic_obstacle, embedded_obstacle, face_obstacle, impact_zone,
    joint, particle_dynamic, reaction, report, surface, tether_pull,
};
use crate::island::{Island, IslandContext};
use crate::motion::environment::Environment;
use crate::parallel::workers::Workers;
use crate::state::ball::Ball;
use crate::state::substep::Substep;
use crate::substep::island_bodies::{IslandBodies, IslandBody};
use crate::substep::order::{BodyStage, IslandStage, Span, Stages};
use crate::substep::sweep;

/// Walks some spans of the order, stage by stage.
pub(crate) fn walk<const N: usize>(
    island: &mut Island,
    environment: &Environment,
    workers: &Workers,
    spans: [Span; N],
) {
    for Span { stages, projection, mut first } in spans {
        for &stages in stages {
            match stages {
                Stages::Island(stage) => run_island_stage(island, environment, workers, stage),
                Stages::Bodies(stages) => {
                    run_body_stages(island, environment, workers, stages, (first, projection));
                    first += stages.len();
                }
            }
        }
    }
}

/// Runs some stages of all bodies. Threads share the bodies if there is no ball or mover: these belong to no body.
fn run_body_stages(
    island: &mut Island,
    environment: &Environment,
    workers: &Workers,
    stages: &[BodyStage],
    (first, projection): (usize, u32),
) {
    let substep = island.context.now(island.isa, environment);
    let Island { bodies, balls, context, .. } = island;
    let IslandContext {
        plans, contacts: IslandContacts { bodies: contacts, ball_cloth, movers, .. }, ..
    } = context;
    let places = || (first..).zip(stages);
    if balls.is_empty() && movers.is_empty() {
        let mut all = IslandBodies { bodies, contacts, plans };
        all.for_each(workers, &|(body, contacts, plan)| {
            for (place, &stage) in places() {
                // Without balls nobody asks for the index.
                let mut nothing = BallClothContacts::default();
                let others = Others { index: 0, balls: &[], ball_cloth: &mut nothing, movers: &mut [] };
                run_body_stage((body, contacts, plan), others, substep, workers, (stage, place), projection);
            }
        });
        return;
    }
    let all = bodies.iter_mut().zip(contacts).zip(plans).enumerate();
    for (index, ((body, contacts), plan)) in all {
        for (place, &stage) in places() {
            let others = Others { index, balls, ball_cloth, movers };
            run_body_stage((body, contacts, plan), others, substep, workers, (stage, place), projection);
        }
    }
}

/// Balls, movers and contacts of balls, which belong to no body; `index` is the body's place in the island.
struct Others<'a> {
    index: usize,
    balls: &'a [Ball],
    ball_cloth: &'a mut BallClothContacts,
    movers: &'a mut [Mover],
}

/// Runs one stage of one body; `place` is the stage's index in the order.
fn run_body_stage(
    (body, contacts, plan): IslandBody,
    Others { index, balls, ball_cloth, movers }: Others,
    substep: Substep,
    workers: &Workers,
    (stage, place): (BodyStage, usize),
    projection: u32,
) {
    match stage {
        BodyStage::MovePins => sweep::move_pins(body),
        BodyStage::NotePins => body.note_pin_travel(),
        BodyStage::BeginJoints => joint::begin_substep(&mut contacts.joints, body, movers),
        BodyStage::BalanceJoints => {
            joint::balance(&mut contacts.joints, body, movers, substep.duration);
        }
        BodyStage::FollowJoints => joint::follow(&mut contacts.joints, body, movers),
        BodyStage::ReleaseJoints => joint::release(&mut contacts.joints, body, movers),
        BodyStage::PullJoints => joint::pull(&mut contacts.joints, body, movers, substep),
        BodyStage::BeginContacts => {
            face_obstacle::begin_substep(&mut contacts.faces, body, substep, movers);
            embedded_obstacle::begin_substep(&mut contacts.embedded);
        }
        BodyStage::FaceContacts => face_obstacle::project(&mut contacts.faces, body, substep, movers),
        BodyStage::EmbeddedContacts => {
            embedded_obstacle::project(&mut contacts.embedded, body, substep, movers);
        }
        BodyStage::DynamicContacts => {
            particle_dynamic::project(&mut contacts.obstacles, body, substep, movers, projection == 0);
        }
        BodyStage::Tethers => {
            ball_cloth::note_touched(ball_cloth, balls, index, &body.particles);
            tether_pull::note(contacts, body, movers);
            sweep::run(body, &mut contacts.obstacles, &plan.plan, substep, plan.plan.span(place));
            ball_cloth::put_back(ball_cloth, &mut body.particles);
            tether_pull::pull(contacts, body, substep, movers);
        }
        BodyStage::Bends => bend::project(body, projection, substep.isa),
        BodyStage::Lines => sweep::solve_lines(body, plan, substep, projection, workers),
        BodyStage::Volume => volume::project(body),
        BodyStage::AngularMomentum => angular_momentum::restore(body),
        BodyStage::FaceFriction => {
            face_obstacle::apply_friction(&mut contacts.faces, body, substep, movers);
        }
        BodyStage::EmbeddedFriction => {
            embedded_obstacle::apply_friction(&mut contacts.embedded, body, substep, movers);
        }
        BodyStage::DynamicFriction => {
            particle_dynamic::apply_friction(&mut contacts.obstacles, body, substep, movers);
        }
        BodyStage::Integrate
        | BodyStage::Carry
        | BodyStage::Drive
        | BodyStage::ObstacleContacts
        | BodyStage::Sticks
        | BodyStage::Update
        | BodyStage::Damping
        | BodyStage::ObstacleFriction
        | BodyStage::Limits
        | BodyStage::Backstops
        | BodyStage::Leave
        | BodyStage::Watch => {
            sweep::run(body, &mut contacts.obstacles, &plan.plan, substep, plan.plan.span(place));
        }
    }
}

/// Runs one stage of an island.
fn run_island_stage(island: &mut Island, environment: &Environment, workers: &Workers, stage: IslandStage) {
    let substep = island.context.now(island.isa, environment);
    let Island { bodies, balls, touches, context, .. } = island;
    let IslandContext { contacts, report, reactions, .. } = context;
    let IslandContacts { surfaces, ball_cloth, ball_ball, ball_obstacle, movers, impact_zones, .. } =
        contacts;
    match stage {
        IslandStage::NoteStarts => surfaces.begin_substep(bodies, substep.index == 0),
        IslandStage::BeginMovers => dynamic_obstacle::begin_substep(movers, substep.duration),
        IslandStage::IntegrateBalls => {
            for ball in balls {
                let acceleration = environment.gravity + ball.force * ball.inverse_mass;
                ball.displacement = ball.drag.step(ball.displacement, acceleration, ball.substep);
                ball.position += ball.displacement;
                ball.projected = Vec3::ZERO;
            }
        }
        IslandStage::BeginContacts => {
            ball_obstacle::begin_substep(ball_obstacle, balls, movers, substep);
            ball_ball::begin_substep(ball_ball);
            ball_cloth::begin_substep(ball_cloth);
            surfaces.detect_on_ropes(bodies, substep, workers);
        }
        IslandStage::RopeContacts => {
            if surface::is_on_ropes(bodies) {
                surfaces.project(bodies, 1.0);
            }
        }
        IslandStage::ClothContacts => project_layers(island, environment, workers),
        IslandStage::BallClothContacts => ball_cloth::project(ball_cloth, bodies, balls, touches, substep),
        IslandStage::BallBallContacts => ball_ball::project(ball_ball, balls, touches, substep),
        IslandStage::BallObstacleContacts => {
            ball_obstacle::project(ball_obstacle, balls, movers, touches, substep);
        }
        IslandStage::UpdateBalls => {
            for ball in balls {
                ball.displacement = ball.travel();
                ball.projected = Vec3::ZERO;
            }
        }
        IslandStage::Rebound => {
            ball_obstacle::rebound(ball_obstacle, balls, movers, touches, substep);
            ball_ball::rebound(ball_ball, balls, touches, substep);
        }
        IslandStage::BallFriction => {
            ball_obstacle::apply_friction(ball_obstacle, balls, movers, substep);
            ball_ball::apply_friction(ball_ball, balls);
            ball_cloth::apply_friction(ball_cloth, bodies, balls);
        }
        IslandStage::ImpactZones => {
            let pairs = &mut ball_cloth.pairs;
            impact_zone::enforce(impact_zones, pairs, bodies, balls, touches, substep.duration);
        }
        IslandStage::TurnBalls => balls.iter_mut().for_each(Ball::turn),
        IslandStage::Account => {
            report::gather(report, contacts, bodies, balls, substep);
            reaction::gather(reactions, contacts, bodies, balls, substep);
        }
        IslandStage::KeepApart => surfaces.keep_apart(bodies, substep, workers),
    }
}

/// Projects cloth against cloth and against obstacles in turn, so that an obstacle holds up all layers of cloth on it.
fn project_layers(island: &mut Island, environment: &Environment, workers: &Workers) {
    let substep = island.context.now(island.isa, environment);
    let Island { bodies, context, .. } = island;
    let IslandContext { plans, contacts: IslandContacts { bodies: contacts, surfaces, movers, .. }, .. } =
        context;
    surfaces.detect(bodies, substep, CONTACT_MARGIN_OF_SURFACES, workers);
    if !surfaces.is_near() {
        return;
    }
    for _ in 1..ROUNDS_OF_LAYERS {
        surfaces.project(bodies, OVER_RELAXATION);
        let mut all = IslandBodies { bodies, contacts, plans };
        all.for_each(workers, &|(body, contacts, plan)| {
            if body.has_self_contact() {
                let last = plan.plan.last_contacts.clone();
                sweep::run(body, &mut contacts.obstacles, &plan.plan, substep, last);
            }
        });
        for (body, contacts) in
            bodies.iter_mut().zip(&mut *contacts).filter(|(body, _)| body.has_self_contact())
        {
            particle_dynamic::project(&mut contacts.obstacles, body, substep, movers, false);
        }
    }
    surfaces.project(bodies, 1.0);
    surfaces.settle(bodies, substep);
}
