//! One side of the exchange. A message for each step holds the hash after the last step and the input of the next.

use std::error::Error;
use std::fmt;
use std::io::{self, Read, Write};

use drape_solver::glam::Vec3;

use crate::game::{Game, Input};

/// The first step after which two machines differ, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Number of the step, from 1; 0 if they differ before the first.
    pub step: u32,
    /// The body, ball or sphere.
    pub body: &'static str,
    /// Its first particle in another place; none if all places are equal, and motions or masses are not.
    pub particle: Option<usize>,
    /// Its places in metres here and there.
    pub places: [Vec3; 2],
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { step, body, particle, places: [own, others] } = self;
        write!(f, "different after step {step}: {body}, ")?;
        match particle {
            Some(particle) => write!(f, "particle {particle}, at {own} here and {others} there"),
            None => write!(f, "in its motion or mass only"),
        }
    }
}

/// Plays `steps` steps as `player` with the other one at the end of `link`. Calls `after_step` with the number of each step.
/// Stops at the first difference.
pub fn play(
    link: &mut (impl Read + Write),
    game: &mut Game,
    player: usize,
    steps: u32,
    mut after_step: impl FnMut(&mut Game, u32),
) -> Result<Option<Difference>, Box<dyn Error>> {
    // One message more than steps, for the last hash.
    for step in 0..=steps {
        let own = (game.hash(), Input::of(player, step));
        let others = exchange_messages(link, own)?;
        if own.0 != others.0 {
            return Ok(Some(find_difference(link, game, step)?));
        }
        if step < steps {
            let mut inputs = [own.1, others.1];
            if player == 1 {
                inputs.swap(0, 1);
            }
            game.step(inputs)?;
            after_step(game, step + 1);
        }
    }
    Ok(None)
}

fn exchange_messages(
    link: &mut (impl Read + Write),
    (hash, input): (u64, Input),
) -> io::Result<(u64, Input)> {
    const HASH: usize = size_of::<u64>();
    let message = [&hash.to_le_bytes()[..], &input.to_bytes()].concat();
    let message = exchange(link, &message)?;
    let (mut hash, mut input) = ([0; HASH], [0; Input::BYTES]);
    hash.copy_from_slice(&message[..HASH]);
    input.copy_from_slice(&message[HASH..]);
    Ok((u64::from_le_bytes(hash), Input::from_bytes(input)))
}

/// Finds the first body that differs, and its first particle, together with the other side.
fn find_difference(
    link: &mut (impl Read + Write),
    game: &Game,
    step: u32,
) -> Result<Difference, Box<dyn Error>> {
    let (names, hashes): (Vec<_>, Vec<_>) = game.hashes().unzip();
    let hashes: Vec<[u8; 8]> = hashes.into_iter().map(u64::to_le_bytes).collect();
    let others = exchange(link, hashes.as_flattened())?;
    let (others, _) = others.as_chunks();
    let member = hashes.iter().zip(others).position(|(a, b)| a != b);
    let member = member.ok_or("the hash of the world differs, but that of no member")?;
    let own = game.places(member);
    let bytes: Vec<u8> =
        own.iter().flat_map(Vec3::to_array).flat_map(|x| x.to_bits().to_le_bytes()).collect();
    let others = exchange(link, &bytes)?;
    let number = |bytes: &[u8; 4]| f32::from_bits(u32::from_le_bytes(*bytes));
    let numbers: Vec<f32> = others.as_chunks().0.iter().map(number).collect();
    let others: Vec<Vec3> = numbers.as_chunks().0.iter().copied().map(Vec3::from_array).collect();
    let bits = |place: Vec3| place.to_array().map(f32::to_bits);
    let particle = own.iter().zip(&others).position(|(&a, &b)| bits(a) != bits(b));
    let at = particle.unwrap_or_default();
    Ok(Difference { step, body: names[member], particle, places: [own[at], others[at]] })
}

/// Sends a message and receives one of the same length. Both sides send first: a message must fit into the buffers of the link,
/// as a few thousand bytes do.
fn exchange(link: &mut (impl Read + Write), message: &[u8]) -> io::Result<Vec<u8>> {
    link.write_all(message)?;
    link.flush()?;
    let mut received = vec![0; message.len()];
    link.read_exact(&mut received)?;
    Ok(received)
}
