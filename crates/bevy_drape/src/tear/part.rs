//! Parts a body, and makes entities of its pieces.

use std::sync::Arc;

use bevy::ecs::entity::{EntityClonerBuilder, OptOut};
use bevy::prelude::*;
use drape_solver::world::extent::Extent;
use drape_solver::{Body, Piece, Topology, Torn, TornStick};

use crate::attach::animated_pose::{AnimatedPose, WholePose};
use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::grab::Grab;
use crate::body::activity::Activity;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::particles::{Particles, Sticks};
use crate::body::tearable::{Tearable, TornMesh, Untearable};
use crate::body::torn_from::TornFrom;
use crate::build::cloth::Cloth;
use crate::build::rope::Rope;
use crate::build::soft_ball::SoftBall;
use crate::refusal::Refusals;
use crate::rig::components::Rig;
use crate::tear::messages::{BodySplit, StickTorn};

pub(crate) type TornQuery<'w, 's> = Query<
    'w,
    's,
    (Entity, &'static mut Particles, &'static mut Sticks, &'static mut BodyState, Option<&'static Tearable>),
    (Without<Rig>, Without<Untearable>),
>;

/// Everything that is needed to part bodies.
#[derive(bevy::ecs::system::SystemParam)]
pub(crate) struct Tearing<'w, 's> {
    pub commands: Commands<'w, 's>,
    order: ResMut<'w, CreationOrder>,
    pub refusals: ResMut<'w, Refusals>,
    torn_meshes: Query<'w, 's, &'static TornMesh>,
    grabs: Query<'w, 's, &'static Grab>,
    attached: Query<'w, 's, (&'static mut Attachment, &'static mut AttachmentState)>,
    posed: Query<'w, 's, &'static mut AnimatedPose>,
    torn: MessageWriter<'w, StickTorn>,
    split: MessageWriter<'w, BodySplit>,
    /// Splits that observers have not been told of yet.
    pub splits: Local<'s, Vec<BodySplit>>,
}

impl Tearing<'_, '_> {
    /// Triggers observers of the splits, last of all, since they may despawn the bodies.
    pub fn trigger_splits(&mut self) {
        for split in self.splits.drain(..) {
            self.commands.trigger(split);
        }
    }

    /// Applies `part` to a body, and makes entities of the pieces that come off.
    pub fn part(
        &mut self,
        entity: Entity,
        bodies: &mut TornQuery,
        time: f64,
        is_cut: bool,
        part: impl FnOnce(&mut Body) -> Result<Option<Torn>, drape_solver::BuildError>,
    ) {
        let Ok((_, mut particles, mut sticks, mut state, tearable)) = bodies.get_mut(entity) else {
            return;
        };
        if !sticks.fit(&particles) {
            return;
        }
        let mut body = Body::new(
            core::mem::take(&mut particles.bypass_change_detection().0),
            sticks.0.clone(),
            state.settings,
        );
        let outcome = part(&mut body);
        let torn = match outcome {
            Ok(torn) => torn,
            Err(error) => {
                self.refusals.entity(entity, "Tearable", error);
                None
            }
        };
        let Some(Torn { origins, sticks: torn_sticks, edges, pieces }) = torn else {
            particles.bypass_change_detection().0 = body.particles;
            return;
        };
        if state.order == 0 {
            // Cut before its first step.
            state.order = self.order.next();
        }
        let was = state.torn_from.take().unwrap_or_else(|| TornFrom::of_whole(state.order, &sticks.0));
        if Arc::ptr_eq(&was.whole.topology, &sticks.0)
            && let Ok(posed) = self.posed.get(entity)
        {
            self.commands.entity(entity).insert(WholePose(posed.clone()));
        }
        let was = was.torn_along(&edges);
        state.torn_from = Some(was.torn(&origins));
        for TornStick { position, length, rest_length, .. } in torn_sticks {
            self.torn.write(StickTorn { body: entity, position, length, rest_length, is_cut, time });
        }
        let least = tearable.copied().unwrap_or_default().least_particles as usize;
        for Piece { body: piece, origins } in pieces {
            let spawned = (piece.particles.len() >= least)
                .then(|| self.spawn(entity, &state, was.torn(&origins), piece, &origins));
            let split = BodySplit { body: entity, piece: spawned, origins, time };
            self.split.write(split.clone());
            self.splits.push(split);
        }
        let own = real_origins(&body.topology, &origins);
        if let Ok(grab) = self.grabs.get(entity) {
            let held = grab.on(&own);
            match held {
                Some(held) => drop(self.commands.entity(entity).insert(held)),
                None => drop(self.commands.entity(entity).remove::<Grab>()),
            }
        }
        if let Ok((mut attachment, mut held)) = self.attached.get_mut(entity) {
            *held = held.torn(state.order, &own);
            attachment.clone_from(&held.made_of);
        }
        if let Ok(mut posed) = self.posed.get_mut(entity) {
            *posed = posed.torn(&origins);
        }
        let mesh = self.torn_mesh(entity, &origins);
        self.commands.entity(entity).insert(mesh);
        state.context = body.context;
        state.scratch = default();
        state.pins = pins_after(&state, &own);
        state.extent = Extent::of(&body.particles, &body.topology);
        particles.0 = body.particles;
        sticks.0 = body.topology;
    }

    /// Spawns the entity of a piece that has come off another.
    fn spawn(
        &mut self,
        from: Entity,
        state: &BodyState,
        torn_from: TornFrom,
        piece: Body,
        origins: &[u32],
    ) -> Entity {
        let mesh = self.torn_mesh(from, origins);
        let own = real_origins(&piece.topology, origins);
        let state = BodyState {
            order: self.order.next(),
            anchor: state.anchor,
            pins: pins_after(state, &own),
            extent: Extent::of(&piece.particles, &piece.topology),
            settings: state.settings,
            layers: state.layers,
            torn_from: Some(torn_from),
            ..state_of_piece(state)
        };
        let held = self.attached.get(from).ok().map(|(_, held)| held.torn(state.order, &own));
        let posed = self.posed.get(from).ok().map(|posed| posed.torn(origins));
        let grab = self.grabs.get(from).ok().and_then(|grab| grab.on(&own));
        let own = (Particles(piece.particles), Sticks(piece.topology), Activity::Active, state, mesh);
        let mut commands = self.commands.entity(from);
        let mut spawned = commands.clone_and_spawn_with_opt_out(leave_out_body);
        spawned.insert(own);
        if let Some(posed) = posed {
            spawned.insert(posed);
        }
        if let Some(held) = held {
            spawned.insert((held.made_of.clone(), held));
        }
        if let Some(grab) = grab {
            spawned.insert(grab);
        }
        spawned.id()
    }

    /// Returns the origin of the vertices of a body's new mesh.
    fn torn_mesh(&self, entity: Entity, origins: &[u32]) -> TornMesh {
        match self.torn_meshes.get(entity) {
            // Torn again before the mesh of the last tear was made.
            Ok(TornMesh { source, origins: before }) => {
                let origins = origins.iter().filter_map(|&origin| before.get(origin as usize).copied());
                TornMesh { source: *source, origins: origins.collect() }
            }
            Err(_) => TornMesh { source: entity, origins: origins.to_vec() },
        }
    }
}

/// The state of a piece as far as it is that of the body from which it has come off.
pub(crate) fn state_of_piece(whole: &BodyState) -> BodyState {
    BodyState { rest: whole.rest, material: whole.material, ..BodyState::default() }
}

/// Leaves out of a clone what a piece has of its own, or not at all.
pub(crate) fn leave_out_body(cloner: &mut EntityClonerBuilder<OptOut>) {
    cloner.deny::<(Cloth, Rope, SoftBall, Grab, TornMesh, Particles, Sticks, Activity, BodyState)>();
    #[cfg(feature = "mesh")]
    cloner.deny::<(
        crate::render::from_mesh::cloth_mesh::ClothMesh,
        crate::render::from_mesh::source::MeshSource,
        crate::render::from_mesh::cloth_mesh::WeldedVertices,
        crate::render::surface::Surface,
        crate::render::rope_mesh::RopeSurface,
        Mesh3d,
        Mesh2d,
        bevy::camera::primitives::Aabb,
    )>();
}

/// Returns the origins of a torn body's particles, or of those of a piece; no particle for virtual ones, which nothing holds.
fn real_origins(topology: &Topology, origins: &[u32]) -> Vec<u32> {
    let mut own = origins.to_vec();
    let is_virtual = topology.virtual_particles();
    own.iter_mut().zip(is_virtual).filter(|(_, is_virtual)| *is_virtual).for_each(|(own, _)| *own = u32::MAX);
    own
}

/// Returns the pins of a torn body, or of a piece of it, whose particles have these origins.
fn pins_after(state: &BodyState, origins: &[u32]) -> Vec<(u32, Vec3)> {
    let place = |origin: u32| state.pins.iter().find(|&&(pin, _)| pin == origin).map(|&(_, place)| place);
    let origins = origins.iter().enumerate();
    origins.filter_map(|(index, &origin)| Some((index as u32, place(origin)?))).collect()
}
