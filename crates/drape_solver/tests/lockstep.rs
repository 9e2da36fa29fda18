//! Two sides that exchange inputs step the same world with the same bits, and find the first that differs.

#[path = "../examples/lockstep/game.rs"]
mod game;
#[path = "../examples/lockstep/peer.rs"]
mod peer;

use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

use drape_solver::glam::Vec3;
use game::{Game, Input};
use peer::{Difference, play};

/// Plays both sides over a local socket, and returns what each finds, and the hash of the first.
fn both(steps: u32, after_step: impl FnMut(&mut Game, u32)) -> ([Option<Difference>; 2], u64) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut other = TcpStream::connect(listener.local_addr().expect("bound")).expect("a host");
    let (mut link, _) = listener.accept().expect("a guest");
    for end in [&link, &other] {
        end.set_nodelay(true).expect("connected");
        end.set_read_timeout(Some(Duration::from_secs(60))).expect("not zero");
    }
    let guest = thread::spawn(move || {
        let mut game = Game::new().expect("valid");
        play(&mut other, &mut game, 1, steps, |_, _| ()).expect("good steps")
    });
    let mut game = Game::new().expect("valid");
    let found = play(&mut link, &mut game, 0, steps, after_step).expect("good steps");
    ([found, guest.join().expect("no panic")], game.hash())
}

/// Asserts that both sides have found a difference after this step, in this body and particle.
fn assert_both_find(
    found: [Option<Difference>; 2],
    expected: (u32, &'static str, Option<usize>),
) -> [Difference; 2] {
    found.map(|difference| {
        let difference = difference.expect("one side found nothing");
        assert_eq!((difference.step, difference.body, difference.particle), expected);
        difference
    })
}

#[test]
fn two_sides_are_equal_in_each_of_a_thousand_steps() {
    let (found, hash) = both(1000, |_, _| ());
    assert_eq!(found, [None, None]);
    let mut alone = Game::new().expect("valid");
    for step in 0..1000 {
        alone.step([0, 1].map(|player| Input::of(player, step))).expect("a good step");
    }
    assert_eq!(hash, alone.hash());
    assert_ne!(hash, Game::new().expect("valid").hash());
}

#[test]
fn one_bit_is_found_in_its_step_and_named() {
    let (found, _) = both(600, |game, step| {
        if step == 321 {
            game.disturb(123);
        }
    });
    let [host, guest] = assert_both_find(found, (321, "curtain", Some(123)));
    let mut places = guest.places;
    places.reverse();
    assert_eq!(host.places, places);
    assert_eq!(host.places[0].y, host.places[1].y.next_up());
}

#[test]
fn a_ball_that_only_moves_otherwise_is_named() {
    let (found, _) = both(100, |game, step| {
        if step == 50 {
            let ball = game.world.ball_mut(game.balls[1]).expect("in the world");
            ball.set_velocity(ball.velocity() + 1e-3 * Vec3::X);
        }
    });
    assert_both_find(found, (50, "second ball", None));
}

/// A move that only one side made is found in its step, though the sphere touches nothing yet.
#[test]
fn a_move_that_got_lost_is_found_in_its_step() {
    let (found, _) = both(100, |game, step| {
        if step == 4 {
            game.drive(1, [0, 1, 0]);
        }
    });
    assert_both_find(found, (4, "second sphere", Some(0)));
}
