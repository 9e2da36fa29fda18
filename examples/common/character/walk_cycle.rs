//! A character in a world, and its procedural animation of half a minute. It faces -Z.

use core::f32::consts::{FRAC_PI_2, PI, TAU};
use core::ops::Range;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::transform::MovedByFrame;

use crate::character::cape_mesh::{cape, cape_mesh};
use crate::character::skeleton::{
    ARMS, BONES, CHEST, HIPS, SHINS, SPINE, THIGHS, inverse_bind_poses, skinned,
};

/// Length of the animation in seconds.
pub const WALK: f32 = 30.0;

/// Length in seconds of the sprint that [`Character::sprint`] shows, with the fall at its end.
pub const SPRINT: f32 = 8.5;

/// A character in a world.
#[derive(Resource, Clone, Debug)]
pub struct Character {
    /// The parent of the joints and of the cape.
    pub root: Entity,
    /// Its joints, in the order of [`BONES`].
    pub joints: Vec<Entity>,
    /// The capsule of each.
    pub capsules: Vec<Entity>,
    /// The cape; a placeholder if it has none.
    pub cape: Entity,
    /// Position in metres.
    pub place: Vec3,
    /// Heading in radians about Y; 0 looks along -Z.
    pub heading: f32,
    /// Seconds since it began.
    pub time: f32,
    /// Phase of its step.
    phase: f32,
}

/// Spawns a character with a cape, which has `bundle` besides.
pub fn spawn(world: &mut World, bundle: impl Bundle) -> Character {
    let mut character = spawn_figure(world);
    let skinned = skinned(world, cape_mesh(), &character.joints, inverse_bind_poses());
    character.cape = world.spawn((skinned, cape(), ChildOf(character.root), bundle)).id();
    character
}

/// Spawns a character without a cape; its root is seen on its way between frames.
pub fn spawn_figure(world: &mut World) -> Character {
    let root = world.spawn((Transform::default(), Visibility::default(), MovedByFrame)).id();
    let mut joints = Vec::new();
    let mut capsules = Vec::new();
    for (name, parent, place, [radius, length], middle) in BONES {
        let parent = parent.map_or(root, |parent| joints[parent]);
        let place = Transform::from_translation(place.into());
        let joint = (Name::new(name), place, Visibility::default(), ChildOf(parent));
        let joint = world.spawn(joint).id();
        joints.push(joint);
        let obstacle = Obstacle::capsule(radius, length).with_friction(0.3);
        capsules
            .push(world.spawn((obstacle, Transform::from_translation(middle.into()), ChildOf(joint))).id());
    }
    Character { root, joints, capsules, ..Character::default() }
}

impl Default for Character {
    /// A character in no world, at the beginning.
    fn default() -> Self {
        Self {
            root: Entity::PLACEHOLDER,
            joints: Vec::new(),
            capsules: Vec::new(),
            cape: Entity::PLACEHOLDER,
            place: Vec3::ZERO,
            heading: 0.0,
            time: 0.0,
            phase: 0.0,
        }
    }
}

/// The gait at a time: speed in m/s, turning in rad/s, and height above the ground in metres.
fn gait(time: f32) -> (f32, f32, f32) {
    let turn = |start: f32, length: f32, angle: f32| {
        if (start..start + length).contains(&time) { angle / length } else { 0.0 }
    };
    let jump = |start: f32| {
        let t = time - start;
        if (0.0..0.7).contains(&t) { 4.9 * 0.7 * t - 4.9 * t * t } else { 0.0 }
    };
    let speed = match time {
        t if t < 1.0 => 0.0,
        t if t < 9.0 => 1.5,
        t if t < 10.0 => 1.5 + 3.5 * (t - 9.0),
        t if t < 18.0 => 5.0,
        t if t < 19.0 => 5.0 - 5.0 * (t - 18.0),
        t if t < 22.0 => 0.0,
        t if t < 28.0 => 3.0,
        t if t < 28.5 => 3.0 - 6.0 * (t - 28.0),
        _ => 0.0,
    };
    // A slow curve while it walks, an about-turn in 0.4 s when it stands, runs, and runs back.
    let turning = turn(4.0, 4.0, PI) + turn(20.0, 0.4, PI) + turn(13.0, 0.4, PI) + turn(25.0, 0.4, -PI);
    (speed, turning, jump(11.0) + jump(15.0) + jump(20.8) + jump(23.5))
}

/// Strides, of both legs, in a second at a speed in m/s.
pub fn pace(speed: f32) -> f32 {
    (0.7 + 0.3 * speed).min(1.6)
}

impl Character {
    /// Advances to `time` in small steps, so that the way is the same at any frame rate.
    pub fn advance(&mut self, time: f32) {
        const STRIDE: f32 = 1.0 / 480.0;
        while self.time + STRIDE <= time + 1e-5 {
            let (speed, turning, _) = gait(self.time);
            self.heading += turning * STRIDE;
            self.place +=
                Vec3::new(-libm::sinf(self.heading), 0.0, -libm::cosf(self.heading)) * (speed * STRIDE);
            self.phase += STRIDE * pace(speed) * f32::from(speed > 0.0);
            self.time += STRIDE;
        }
    }

    /// The pose of the root and of all joints.
    pub fn pose(&self) -> (Transform, Vec<Transform>) {
        let (speed, _, height) = gait(self.time);
        let place = self.place + Vec3::Y * height;
        let root = Transform::from_translation(place).with_rotation(Quat::from_rotation_y(self.heading));
        let swing = libm::sinf(TAU * self.phase);
        let reach = (0.3 + 0.09 * speed).min(0.75) * (speed / 1.5).min(1.0);
        let bent = (0.03 * speed).min(0.15);
        let mut joints: Vec<Transform> =
            BONES.iter().map(|(_, _, place, ..)| Transform::from_translation((*place).into())).collect();
        joints[HIPS].translation.y += 0.03 * libm::cosf(2.0 * TAU * self.phase) * reach;
        joints[SPINE].rotation = Quat::from_rotation_x(-bent);
        joints[CHEST].rotation = Quat::from_rotation_y(0.15 * swing * reach);
        for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
            let tucked = if height > 0.0 { 0.4 } else { 0.0 };
            joints[THIGHS[side]].rotation = Quat::from_rotation_x(sign * swing * reach + tucked);
            let knee = (0.2 + 0.5 * sign * libm::cosf(TAU * self.phase)).max(0.0) * reach + 2.0 * tucked;
            joints[SHINS[side]].rotation = Quat::from_rotation_x(-knee);
            joints[ARMS[side]].rotation =
                Quat::from_rotation_z(-0.15 * sign) * Quat::from_rotation_x(-sign * swing * reach * 0.8);
        }
        (root, joints)
    }

    /// The pose at `time` of another way: a sprint with a leap and an about-turn, a stop, and a fall on its face.
    pub fn sprint(&mut self, time: f32) -> (Transform, Vec<Transform>) {
        // Of the long way: the first part ends, and the second begins, in the same run.
        const FIRST: Range<f32> = 9.0..13.8;
        const SECOND: Range<f32> = 17.3..18.9;
        const STOP: f32 = FIRST.end - FIRST.start + SECOND.end - SECOND.start;
        self.advance(FIRST.end.min(FIRST.start + time));
        if self.time + 1e-2 > FIRST.end {
            self.time = self.time.max(SECOND.start);
            self.advance(SECOND.end - STOP + time.min(STOP));
        }
        let (mut root, mut joints) = self.pose();
        // A pole that tips over goes slowly at first. Its thickness and its clothes keep it above the ground.
        let fallen = ((time - STOP) / 0.9).clamp(0.0, 1.0).powi(3);
        root.rotation *= Quat::from_rotation_x(-FRAC_PI_2 * fallen);
        root.translation.y += 0.18 * fallen;
        for arm in ARMS {
            joints[arm].rotation *= Quat::from_rotation_x(2.2 * fallen);
        }
        (root, joints)
    }

    /// Goes back to the beginning.
    pub fn rewind(&mut self) {
        let Self { root, joints, capsules, cape, .. } = core::mem::take(self);
        *self = Self { root, joints, capsules, cape, ..Self::default() };
    }

    /// Shows the pose.
    pub fn write(&self, world: &mut World) {
        let (root, joints) = self.pose();
        self.show(world, root, &joints);
    }

    /// Shows a pose of the root and of all joints.
    pub fn show(&self, world: &mut World, root: Transform, joints: &[Transform]) {
        for (entity, pose) in self.joints.iter().zip(joints).chain([(&self.root, &root)]) {
            if let Some(mut transform) = world.get_mut::<Transform>(*entity) {
                *transform = *pose;
            }
        }
    }
}
