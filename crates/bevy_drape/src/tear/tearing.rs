//! Tearing and cutting: cloth that gives way where it is pulled too hard, and blades that part it.
//!
//! A body with a [`Tearable`] tears where its sticks are stretched too far; any body is cut by a [`CutCloth`] message:
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn spawn(mut commands: Commands) {
//!     commands.spawn((Cloth::new(2.0, 1.5), Tearable::default()));
//! }
//!
//! fn slash(mut cuts: MessageWriter<CutCloth>) {
//!     let (hilt, tip) = (Vec3::new(-2.0, 0.0, 0.0), Vec3::new(-2.0, 0.0, 2.0));
//!     cuts.write(CutCloth::sweep([hilt, tip], [hilt + Vec3::X * 4.0, tip + Vec3::X * 4.0]));
//! }
//! ```
//!
//! The cloth opens along the edges of its faces: none is lost or divided, and texture coordinates stay where they were on
//! both sides. What comes off is an entity of its own: a clone of the one that it was part of, with the same material,
//! settings and components, but its own [`Particles`], [`Sticks`] and mesh, and no description such as
//! [`Cloth`]. The largest piece stays where it was. [`BodySplit`] tells of it; observe it to take off
//! the clone what it should not have.

use bevy::prelude::*;
use drape_solver::{Body, Piece, TearLimits, Torn, TornStick};

use crate::attach::animated_pose::AnimatedPose;
use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::grab::Grab;
use crate::body::activity::Activity;
use crate::body::particles::{BodyState, CreationOrder, Extent, Particles, Sticks};
use crate::build::cloth::Cloth;
use crate::build::rope::Rope;
use crate::build::soft_ball::SoftBall;
use crate::clock::DrapeClock;
use crate::pending_messages::Pending;
use crate::refusal::Refusals;
use crate::rig::components::Rig;
use crate::sleep::scene_manager::{grown, overlap};

/// Lets a body tear. Rigs, whose particles are entities, do not; solids are refused.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tearable {
    /// The strain of a structural stick beyond which it tears: 0.5, the default, means half as long again as at rest. Above
    /// 0. Rigid sticks stretch where more hangs on them than the substeps can carry.
    pub strain: f32,
    /// The most particles that are split in one step; 16 by default. How fast a tear runs.
    pub most_at_once: u32,
    /// Pieces of fewer particles vanish; 4 by default. Such a crumb is no cloth.
    pub least_particles: u32,
}

impl Default for Tearable {
    fn default() -> Self {
        let TearLimits { strain, most } = TearLimits::default();
        Self { strain, most_at_once: most, least_particles: 4 }
    }
}

/// Cuts what a blade passes through. Sent at any time; carried out at the start of the next step.
#[derive(Message, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct CutCloth {
    /// The triangles of the blade in the world, in metres.
    pub blade: Vec<[Vec3; 3]>,
    /// The only body that is cut; all by default.
    pub only: Option<Entity>,
}

impl CutCloth {
    /// What a straight edge cuts that moves from one place to another: a sword's hilt and tip, then and now.
    pub fn sweep([hilt, tip]: [Vec3; 2], [new_hilt, new_tip]: [Vec3; 2]) -> Self {
        Self { blade: vec![[hilt, tip, new_tip], [hilt, new_tip, new_hilt]], only: None }
    }

    /// What a blade cuts whose middle moves along `path`, and which reaches `depth` to both sides of it: both in the world, in metres.
    pub fn along(path: impl IntoIterator<Item = Vec3>, depth: Vec3) -> Self {
        let mut blade = Vec::new();
        let mut path = path.into_iter();
        let mut from = path.next();
        for to in path {
            if let Some(from) = from {
                blade.extend(Self::sweep([from - depth, from + depth], [to - depth, to + depth]).blade);
            }
            from = Some(to);
        }
        Self { blade, only: None }
    }

    /// What lies between two rays, up to `length` metres away: a stroke of the pointer across the screen.
    pub fn between(from: Ray3d, to: Ray3d, length: f32) -> Self {
        Self::sweep([from.origin, from.get_point(length)], [to.origin, to.get_point(length)])
    }

    /// A star of three slits of `radius` (metres) around `centre`, along `direction`: what a bullet leaves.
    pub fn star(centre: Vec3, direction: Dir3, radius: f32) -> Self {
        let (along, aside) = (direction * radius, direction.any_orthonormal_vector());
        let mut star = Self::default();
        for turn in 0..3_u8 {
            let turned = Quat::from_axis_angle(*direction, core::f32::consts::FRAC_PI_3 * f32::from(turn));
            let reach = turned * aside * radius;
            let slit = Self::sweep(
                [centre - reach - along, centre - reach + along],
                [centre + reach - along, centre + reach + along],
            );
            star.blade.extend(slit.blade);
        }
        star
    }

    /// Cuts this body only.
    pub fn only(mut self, body: Entity) -> Self {
        self.only = Some(body);
        self
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let corners = self.blade.as_flattened().iter();
        corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &c| (low.min(c), high.max(c)))
    }
}

/// Sent for each stick that a tear or a cut parts.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct StickTorn {
    /// The body.
    pub body: Entity,
    /// The middle of the stick when it gave way, in the world, in metres.
    pub position: Vec3,
    /// How long it was, in metres.
    pub length: f32,
    /// How long it is at rest, in metres.
    pub rest_length: f32,
    /// Whether it was cut; else it was stretched too far.
    pub is_cut: bool,
    /// Simulated time in seconds.
    pub time: f64,
}

/// Triggered on a body that a piece comes off, once for each piece; also sent as a message.
#[derive(EntityEvent, Message, Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BodySplit {
    /// The body that the piece was part of.
    #[event_target]
    pub body: Entity,
    /// The piece, a body of its own now. None if it was too small, and is gone.
    pub piece: Option<Entity>,
    /// For each particle of the piece the index that it had in the body.
    pub origins: Vec<u32>,
    /// Simulated time in seconds.
    pub time: f64,
}

/// On a body that neither tears nor is cut.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct Untearable;

/// How the vertices of a torn body's mesh follow from those of the mesh that it had. Taken off once the mesh is made.
#[derive(Component, Clone, Debug)]
pub(crate) struct TornMesh {
    /// The entity whose mesh it was.
    pub source: Entity,
    /// For each particle the vertex of that mesh.
    pub origins: Vec<u32>,
}

type TornQuery<'w, 's> = Query<
    'w,
    's,
    (Entity, &'static mut Particles, &'static mut Sticks, &'static mut BodyState, Option<&'static Tearable>),
    (Without<Rig>, Without<Untearable>),
>;

/// What tears are told to, and what pieces are made with.
#[derive(bevy::ecs::system::SystemParam)]
pub(crate) struct Tearing<'w, 's> {
    commands: Commands<'w, 's>,
    order: ResMut<'w, CreationOrder>,
    refusals: ResMut<'w, Refusals>,
    torn_meshes: Query<'w, 's, &'static TornMesh>,
    grabs: Query<'w, 's, &'static Grab>,
    attached: Query<'w, 's, (&'static mut Attachment, &'static mut AttachmentState)>,
    posed: Query<'w, 's, &'static mut AnimatedPose>,
    torn: MessageWriter<'w, StickTorn>,
    split: MessageWriter<'w, BodySplit>,
    /// What observers are still to be told.
    splits: Local<'s, Vec<BodySplit>>,
}

/// Makes the cuts that were asked for. Those after one by which something comes off are made once that is a body, so that they cut it too.
pub(crate) fn cut_bodies(
    mut cuts: ResMut<Pending<CutCloth>>,
    mut bodies: TornQuery,
    clock: Res<DrapeClock>,
    mut tearing: Tearing,
) {
    let mut made = 0;
    for cut in &cuts.waiting {
        made += 1;
        if !cut.blade.as_flattened().iter().all(|corner| corner.is_finite()) {
            tearing.refusals.resource("CutCloth", "a corner of its blade is not finite");
            continue;
        }
        let bounds = cut.bounds();
        let is_near = |entity: Entity, state: &BodyState| {
            cut.only.is_none_or(|only| only == entity)
                && !state.refused
                && overlap(bounds, grown(state.extent.bounds, state.settings.thickness))
        };
        // In order of creation, so that entity ids do not matter to the order of the pieces.
        let mut near: Vec<(u64, Entity)> =
            bodies.iter().filter(|body| is_near(body.0, body.3)).map(|body| (body.3.order, body.0)).collect();
        near.sort_unstable();
        for (_, entity) in near {
            tearing.part(entity, &mut bodies, clock.elapsed(), true, |body| body.cut(&cut.blade));
        }
        if !tearing.splits.is_empty() {
            break;
        }
    }
    cuts.waiting.drain(..made);
    tearing.tell_splits();
    if !cuts.waiting.is_empty() {
        tearing.commands.run_system_cached(cut_bodies);
    }
}

/// Tears what this step has stretched too far.
pub(crate) fn tear_bodies(
    mut bodies: TornQuery,
    // Apart from the bodies, so that only what may tear is looked at.
    tearable: Query<(Entity, Ref<Tearable>, &Activity), Without<Rig>>,
    clock: Res<DrapeClock>,
    whole: Query<(Entity, Ref<Tearable>, Ref<Untearable>)>,
    mut tearing: Tearing,
    mut awake: Local<Vec<(u64, Entity, TearLimits)>>,
) {
    awake.clear();
    for (entity, tearable, untearable) in &whole {
        if tearable.is_changed() || untearable.is_added() {
            tearing.refusals.entity(entity, "Tearable", "solids do not tear");
        }
    }
    for (entity, tearable, activity) in &tearable {
        let Ok((_, _, _, state, _)) = bodies.get(entity) else { continue };
        let Tearable { strain, most_at_once, .. } = *tearable;
        if tearable.is_changed() {
            tearing.refusals.forget_component(entity, "Tearable");
        }
        if !(strain > 0.0 && strain.is_finite()) {
            tearing.refusals.entity(
                entity,
                "Tearable",
                format_args!("strain must be finite and above zero, but is {strain}"),
            );
        } else if *activity == Activity::Active && !state.refused {
            awake.push((state.order, entity, TearLimits { strain, most: most_at_once }));
        }
    }
    awake.sort_unstable_by_key(|&(order, ..)| order);
    let now = clock.elapsed() + f64::from(clock.delta());
    for (_, entity, limits) in awake.drain(..) {
        tearing.part(entity, &mut bodies, now, false, |body| body.tear(&limits));
    }
    tearing.tell_splits();
}

impl Tearing<'_, '_> {
    /// Tells observers of the splits, after all that is done to the bodies: they may despawn them.
    fn tell_splits(&mut self) {
        for split in self.splits.drain(..) {
            self.commands.trigger(split);
        }
    }

    /// Does `part` to a body, and makes entities of what comes off.
    fn part(
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
        if particles.is_empty() || particles.len() != sticks.particle_count() {
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
        let Some(Torn { origins, sticks: torn_sticks, pieces }) = torn else {
            particles.bypass_change_detection().0 = body.particles;
            return;
        };
        for TornStick { position, length, rest_length, .. } in torn_sticks {
            self.torn.write(StickTorn { body: entity, position, length, rest_length, is_cut, time });
        }
        let least = tearable.copied().unwrap_or_default().least_particles as usize;
        for Piece { body: piece, origins } in pieces {
            let spawned =
                (piece.particles.len() >= least).then(|| self.spawn(entity, &state, piece, &origins));
            let split = BodySplit { body: entity, piece: spawned, origins, time };
            self.split.write(split.clone());
            self.splits.push(split);
        }
        if let Ok(grab) = self.grabs.get(entity) {
            let held = grab.on(&origins);
            match held {
                Some(held) => drop(self.commands.entity(entity).insert(held)),
                None => drop(self.commands.entity(entity).remove::<Grab>()),
            }
        }
        if let Ok((mut attachment, mut held)) = self.attached.get_mut(entity) {
            *held = held.torn(state.order, &origins);
            attachment.clone_from(&held.made_of);
        }
        if let Ok(mut posed) = self.posed.get_mut(entity) {
            *posed = posed.torn(&origins);
        }
        let mesh = self.torn_mesh(entity, &origins);
        self.commands.entity(entity).insert(mesh);
        state.context = body.context;
        state.pins = pins_after(&state, &origins);
        state.extent = Extent::of(&body.particles, &body.topology);
        particles.0 = body.particles;
        sticks.0 = body.topology;
    }

    /// The entity of a piece that has come off another.
    fn spawn(&mut self, from: Entity, state: &BodyState, piece: Body, origins: &[u32]) -> Entity {
        let mesh = self.torn_mesh(from, origins);
        let state = BodyState {
            order: self.order.next(),
            anchor: state.anchor,
            rest: state.rest,
            pins: pins_after(state, origins),
            extent: Extent::of(&piece.particles, &piece.topology),
            settings: state.settings,
            layers: state.layers,
            ..BodyState::default()
        };
        let held = self.attached.get(from).ok().map(|(_, held)| held.torn(state.order, origins));
        let posed = self.posed.get(from).ok().map(|posed| posed.torn(origins));
        let grab = self.grabs.get(from).ok().and_then(|grab| grab.on(origins));
        let own = (Particles(piece.particles), Sticks(piece.topology), Activity::Active, state, mesh);
        let mut commands = self.commands.entity(from);
        let mut spawned = commands.clone_and_spawn_with_opt_out(|cloner| {
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
        });
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

    /// Where the vertices of a body's new mesh come from.
    fn torn_mesh(&self, entity: Entity, origins: &[u32]) -> TornMesh {
        match self.torn_meshes.get(entity) {
            // Torn before the mesh of the last tear was made.
            Ok(TornMesh { source, origins: before }) => {
                let origins = origins.iter().filter_map(|&origin| before.get(origin as usize).copied());
                TornMesh { source: *source, origins: origins.collect() }
            }
            Err(_) => TornMesh { source: entity, origins: origins.to_vec() },
        }
    }
}

/// The pins of a body, or of a piece of it, whose particles have these origins.
fn pins_after(state: &BodyState, origins: &[u32]) -> Vec<(u32, Vec3)> {
    let place = |origin: u32| state.pins.iter().find(|&&(pin, _)| pin == origin).map(|&(_, place)| place);
    let origins = origins.iter().enumerate();
    origins.filter_map(|(index, &origin)| Some((index as u32, place(origin)?))).collect()
}
