//! Rollback: two players push a curtain from both sides, and the second one's moves arrive eight frames late. Until then they are
//! guessed. A wrong guess takes the game back to its frame, and from there it comes forward again, all within one frame.
//!
//! `cargo run --release --example rollback --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use std::collections::VecDeque;

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::{Snapshot, SnapshotError};
use drape_examples::feature::{Feature, Paint, Verdict};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Two players and a curtain: the second one's moves arrive late, and change the past",
    controls: "",
    eye: Vec3::new(2.9, 1.9, 3.4),
    target: Vec3::new(0.0, 1.85, 0.0),
    picture_time: 5.5,
    build: |app| {
        app.insert_resource(Verdict(judge)).add_systems(Startup, setup).add_systems(FixedUpdate, play);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Frames that the second player's moves are on their way.
const LATE: usize = 8;

/// Taken back in time. The ground is not: it never changes.
#[derive(Component)]
struct RolledBack;

/// The sphere of the first or second player.
#[derive(Component)]
struct Player(usize);

/// Frames that may have to be played again.
#[derive(Resource, Default)]
struct History {
    /// The world before each of the last frames, and the moves that were played, or guessed.
    frames: VecDeque<(Snapshot, [Vec3; 2])>,
    frame: usize,
    wrong_guesses: usize,
}

/// The move of a player in a frame: to and fro, up and down.
fn moved(player: usize, frame: usize) -> Vec3 {
    let change = frame / [25, 35][player] + player;
    0.02 * [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y][change % 4]
}

fn setup(mut commands: Commands) {
    commands.init_resource::<History>();
    commands.spawn(Obstacle::ground());
    let red = Paint::rgb(0.75, 0.15, 0.15);
    commands.spawn((
        RolledBack,
        Cloth::new(2.4, 1.8).with_spacing(0.05),
        red,
        Transform::from_xyz(0.0, 2.1, 0.0),
    ));
    for (player, z, paint) in
        [(0, 0.3, Paint::rgb(0.93, 0.78, 0.25)), (1, -0.3, Paint::rgb(0.15, 0.30, 0.60))]
    {
        let place = Transform::from_xyz(-0.2, 0.9, z);
        commands.spawn((RolledBack, Player(player), Obstacle::sphere(0.3), paint, place));
    }
}

/// A frame of the game. The step of the cloth follows.
fn play(world: &mut World) {
    // A world that has taken no step cannot be restored.
    if world.resource::<DrapeClock>().steps() == 0 {
        return;
    }
    let Some(mut history) = world.remove_resource::<History>() else { return };
    if let Err(error) = history.listen(world) {
        error!("{error}");
    }
    // The second player goes on as last heard of.
    let heard = history.frame.saturating_sub(LATE);
    let moves = [moved(0, history.frame), moved(1, heard)];
    history.save_and_move(world, moves);
    history.frame += 1;
    world.insert_resource(history);
}

impl History {
    /// Hears of the second player's move [`LATE`] frames ago, and if that was guessed wrongly, plays all frames since again.
    fn listen(&mut self, world: &mut World) -> Result<(), SnapshotError> {
        let Some(then) = self.frame.checked_sub(LATE) else { return Ok(()) };
        let heard = moved(1, then);
        let Some((before, moves)) = self.frames.pop_front() else { return Ok(()) };
        if moves[1] == heard {
            return Ok(());
        }
        before.restore_of::<With<RolledBack>>(world)?;
        self.wrong_guesses += 1;
        let since = core::mem::take(&mut self.frames).into_iter().map(|(_, moves)| moves);
        for [first, _] in [moves].into_iter().chain(since) {
            self.save_and_move(world, [first, heard]);
            world.run_schedule(FixedPostUpdate);
        }
        // This one is known now.
        self.frames.pop_front();
        Ok(())
    }

    /// Keeps the world as it is before a frame, and moves the players.
    fn save_and_move(&mut self, world: &mut World, moves: [Vec3; 2]) {
        self.frames.push_back((Snapshot::take_of::<With<RolledBack>>(world), moves));
        for (player, mut place) in world.query::<(&Player, &mut Transform)>().iter_mut(world) {
            place.translation += moves[player.0];
        }
    }
}

fn judge(world: &mut World) -> Result<String, String> {
    let History { frame, wrong_guesses, .. } = world.resource();
    let again = wrong_guesses * LATE;
    let finding =
        format!("{wrong_guesses} wrong guesses in {frame} frames: {again} frames were played twice");
    if *wrong_guesses > 0 { Ok(finding) } else { Err(finding) }
}
