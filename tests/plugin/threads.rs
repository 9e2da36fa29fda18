//! The same bits on any number of threads.
//!
//! Bevy's compute pool is made once for a process. So the test runs itself again as a child, once for each number
//! of threads, and compares what the children print.

use std::process::Command;

use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use bevy_drape::prelude::*;

use crate::common::*;

const THREADS: &str = "DRAPE_TEST_THREADS";
const NAME: &str = "threads::any_number_of_threads_gives_the_same_bits";

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    if let Ok(threads) = std::env::var(THREADS) {
        child(threads.parse().expect("a number"));
        return;
    }
    let hashes: Vec<String> = (1..=3).map(run_child).collect();
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "on 1, 2 and 3 threads: {hashes:?}");
}

fn run_child(threads: usize) -> String {
    let binary = std::env::current_exe().expect("this binary");
    let mut command = Command::new(binary);
    command.args(["--exact", NAME, "--nocapture"]).env(THREADS, threads.to_string());
    let output = command.output().expect("it runs");
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let hash = printed.lines().find_map(|line| line.split_once("hash: "));
    let Some((_, hash)) = hash else { panic!("the child failed: {printed}") };
    hash.to_string()
}

fn child(threads: usize) {
    let pool = ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads).build());
    assert_eq!(pool.thread_num(), threads);
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let mut bodies = Vec::new();
    for i in 0..24 {
        let at = Transform::from_xyz(3.0 * i as f32, 1.2, 0.0);
        // Islands of unequal work.
        let settings = SolverSettings { substeps: 2 + i % 7, ..default() };
        bodies.push(app.world_mut().spawn((curtain(), settings, at)).id());
        let ball = Projectile { velocity: Vec3::new(0.1 * i as f32, 1.0, 6.0), ..default() };
        let at = at.with_translation(at.translation - Vec3::Z);
        bodies.push(app.world_mut().spawn((ball, at)).id());
    }
    run(&mut app, 1.0);
    assert!(app.world().resource::<Hits>().0.len() >= 20);
    println!("hash: {:016x}", hash(&app, &bodies));
}
