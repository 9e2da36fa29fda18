//! Two sides that exchange inputs step the same world with the same bits, and find the first that differs.

#[path = "../examples/lockstep/game.rs"]
mod game;
#[path = "../examples/lockstep/peer.rs"]
mod peer;

use std::net::{TcpListener, TcpStream};
use std::thread;

use game::{Game, Input};
use peer::{Difference, play};

/// Plays both sides over a local socket, and returns what each finds, and the hash of the first.
fn both(steps: u32, after_step: impl FnMut(&mut Game, u32)) -> ([Option<Difference>; 2], u64) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("bound");
    let guest = thread::spawn(move || {
        let mut link = TcpStream::connect(address).expect("a host");
        link.set_nodelay(true).expect("connected");
        let mut game = Game::new().expect("valid");
        play(&mut link, &mut game, 1, steps, |_, _| ()).expect("good steps")
    });
    let (mut link, _) = listener.accept().expect("a guest");
    link.set_nodelay(true).expect("connected");
    let mut game = Game::new().expect("valid");
    let found = play(&mut link, &mut game, 0, steps, after_step).expect("good steps");
    ([found, guest.join().expect("no panic")], game.hash())
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
    let [Some(host), Some(guest)] = found else { panic!("{found:?}") };
    for difference in [&host, &guest] {
        assert_eq!((difference.step, difference.body, difference.particle), (321, "curtain", Some(123)));
    }
    let mut places = guest.places;
    places.reverse();
    assert_eq!(host.places, places);
    assert_eq!(host.places[0].y, host.places[1].y.next_up());
}
