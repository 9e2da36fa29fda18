//! Single stages of a body, for tests of the kernels below.

use crate::contact::particle_obstacle::ObstacleContacts;
use crate::state::body::Body;
use crate::state::substep::Substep;
use crate::substep::begin::{begin_step, prepare};
use crate::substep::order::{BodyStage, Order};
use crate::substep::plan::BodyPlan;
use crate::substep::sweep;

/// Takes a body through these stages of the first iteration of a step of one substep, `dt` seconds long.
pub(crate) fn run_stages(body: &mut Body, dt: f32, stages: &[BodyStage]) {
    let (mut plan, order) = (BodyPlan::default(), Order::default());
    prepare(body);
    let structural = body.settings.structural;
    begin_step(body, &mut plan, order, dt, 1, 1, structural);
    sweep::move_pins(body);
    let all = order.of_body(1).enumerate();
    for (place, _) in all.filter(|(_, (stage, projection))| *projection == 0 && stages.contains(stage)) {
        let span = plan.plan.span(place);
        sweep::run(body, &mut ObstacleContacts::default(), &plan.plan, Substep::default(), span);
    }
}
