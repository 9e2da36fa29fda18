//! Reports of the GPU, some frames late: boxes and speeds of bodies.
//!
//! ```text
//!                    2 reach
//!     +-------------------------------+   the bounds that are kept: they hold the
//!     |    reach                      |   box that is needed, and are at most twice
//!     |  +-----------------------+    |   as large
//!     |  |   +---------------+   |    |
//!     |  |   | as reported   |   |    |   reach: the way that the fastest particle
//!     |  |   +---------------+   |    |   goes until the next report
//!     |  +-----------------------+    |
//!     +-------------------------------+
//! ```

use bevy::camera::primitives::Aabb;
use bevy::math::Vec3A;
use bevy::prelude::*;
use drape_gpu::{BodyStatus, GpuBodyId, PendingStatuses};
use drape_solver::Body;
use drape_solver::constants::REST_SPEED;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;
use drape_solver::world::waking::Proxy;

use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::Particles;
use crate::clock::DrapeClock;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, SolveOnGpu};
use crate::gpu::rest::sleeper;
use crate::refusal::Refusals;
use crate::render::entity_space::EntitySpace;
use crate::render::rope_mesh::RopeSurface;
use crate::sleep::scene_manager::SceneManager;

/// Metres per second by which a body may become faster until the next report.
const SURPRISE: f32 = 1.0;

/// More regions than this are not looked through.
const MOST_REGIONS: usize = 10_000;

/// A report that will come.
#[derive(Debug)]
pub(super) struct PendingReport {
    statuses: PendingStatuses,
    /// Simulated time in seconds when it was asked for.
    time: f64,
}

/// Changes since a report was asked for, of which it cannot know.
#[derive(Debug, Default)]
pub(super) struct Disturbances {
    /// True if gravity or wind changed, or there were too many regions.
    is_everywhere: bool,
    /// Boxes of obstacles that moved, appeared or vanished.
    regions: Vec<Proxy>,
}

impl Disturbances {
    /// Adds those of a step.
    pub fn add(&mut self, is_everywhere: bool, regions: &[Proxy]) {
        // A report may take long, if the device is lost.
        self.is_everywhere |= is_everywhere || self.regions.len() > MOST_REGIONS;
        if !self.is_everywhere {
            self.regions.extend(regions);
        }
    }

    /// True if they may have moved `body`.
    fn reach(&self, body: &Proxy) -> bool {
        self.is_everywhere || self.regions.iter().any(|region| region.wakes(body))
    }
}

/// The last report of a body.
#[derive(Component, Clone, Copy, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct LastReport {
    /// Box around the particles.
    pub bounds: Bounds,
    /// Metres by which a particle may leave it until the next report.
    reach: f32,
    /// Simulated time in seconds since when all particles have been slow; none if one was not.
    pub still_since: Option<f64>,
    /// True if its entity moved while it was frozen: it begins again there.
    pub was_carried: bool,
}

impl LastReport {
    /// Before the first report, of a body that is there now.
    pub fn at(body: &Body) -> Self {
        let Extent { bounds, .. } = Extent::of(&body.particles, &body.topology);
        // It falls by a tenth of that until the first report.
        Self { bounds, reach: 0.1, still_since: None, was_carried: false }
    }
}

/// When the GPU has reported, puts bodies to sleep that have been still for long enough, and culls those that left the play area; then asks for the
/// next report.
pub(crate) fn take_report(
    // Gizmos of other bodies read their activities.
    mut on_gpu: Query<(Entity, &GpuBody, &OnGpu, &mut LastReport, &mut Activity), Without<Particles>>,
    clock: Res<DrapeClock>,
    manager: Res<SceneManager>,
    mut bodies: ResMut<GpuBodies>,
    mut refusals: ResMut<Refusals>,
    mut asked_at: Local<u64>,
) {
    let GpuBodies { world: Some(world), report, disturbances, .. } = &mut *bodies else { return };
    let (mut statuses, mut time) = (Vec::new(), 0.0);
    if let Some(pending) = report.take() {
        time = pending.time;
        match pending.statuses.try_take() {
            Ok(Ok(reported)) => statuses = reported,
            Ok(Err(statuses)) => {
                *report = Some(PendingReport { statuses, time });
                return;
            }
            // A step of our own device notices it, and a new frame that of the renderer.
            Err(_) => return,
        }
    }
    let meanwhile = core::mem::take(disturbances);
    if core::mem::replace(&mut *asked_at, clock.steps()) != clock.steps() {
        let statuses = world.request_statuses().ok();
        *report = statuses.map(|statuses| PendingReport { statuses, time: clock.elapsed() });
    }
    if statuses.is_empty() {
        return;
    }
    let rules = manager.rules();
    // The next one comes as much later as this one did, if frames are as long.
    let lateness = (2.0 * (clock.elapsed() - time)).max(0.0) as f32 + clock.delta();
    let mut next = 0;
    for (entity, body, parts, mut last, mut activity) in &mut on_gpu {
        if *activity != Activity::Active {
            continue;
        }
        let Some(place) = place_of(&statuses, body.id(), next) else { continue };
        let status = &statuses[place].1;
        next = place + 1;
        if status.has_fault {
            let fault = "a particle is nowhere, or too far away, and stays where it was";
            refusals.entity(entity, SolveOnGpu::NAME, fault);
        }
        last.bounds = Bounds::new(status.low, status.high);
        last.reach = (status.greatest_speed + SURPRISE) * lateness;
        // The clock may have gone back.
        let since = last.still_since.filter(|since| *since <= time).unwrap_or(time);
        last.still_since = (status.greatest_speed < REST_SPEED).then_some(since);
        if rules.is_lost(last.bounds) {
            *activity = Activity::Culled;
        } else if last.still_since.is_some() && time > since && rules.falls_asleep((time - since) as f32) {
            if meanwhile.reach(&sleeper(parts, &last)) {
                last.still_since = None;
            } else {
                *activity = Activity::Resting;
            }
        }
    }
}

/// Gives bodies that were reported, and those whose entities have moved, their bounds in the coordinates of their entities.
pub(crate) fn write_bounds(
    mut reported: Query<
        (&LastReport, &OnGpu, &Activity, &GlobalTransform, Option<&RopeSurface>, &mut Aabb),
        (With<GpuBody>, Or<(Changed<LastReport>, Changed<GlobalTransform>, Changed<RopeSurface>)>),
    >,
) {
    for (last, parts, activity, transform, rope, mut bounds) in &mut reported {
        let transform = parts.seen_from(*activity, transform);
        let Some(space) = EntitySpace::new(&transform) else {
            continue;
        };
        let radius = rope.map_or(0.0, |rope| rope.made_for.radius);
        let grown = |reach: f32| {
            let Bounds { low, high } = last.bounds.grown(reach);
            let centres = space.bounds(low - transform.translation(), high - transform.translation());
            Aabb { half_extents: centres.half_extents + radius, ..centres }
        };
        if !is_good(&bounds, &grown(last.reach)) {
            *bounds = grown(2.0 * last.reach);
        }
    }
}

/// Finds a body in a list that is ordered by ids. Tries `next` first, as bodies mostly come in this order.
fn place_of(statuses: &[(GpuBodyId, BodyStatus)], id: GpuBodyId, next: usize) -> Option<usize> {
    let is_next = statuses.get(next).is_some_and(|&(there, _)| there == id);
    if is_next { Some(next) } else { statuses.binary_search_by_key(&id, |(id, _)| *id).ok() }
}

/// True if `bounds` hold what is needed, and not much more. A change of them costs the renderer something.
fn is_good(bounds: &Aabb, needed: &Aabb) -> bool {
    let is_within = bounds.min().cmple(needed.min()).all() && bounds.max().cmpge(needed.max()).all();
    let most: Vec3A = needed.half_extents * 2.0;
    is_within && bounds.half_extents.cmple(most).all()
}
