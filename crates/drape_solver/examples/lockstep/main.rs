//! Two processes step the same world in lockstep: they exchange what their players do, compare hashes in each step, and name the
//! particle that differs first.
//!
//! `cargo run --release -p drape_solver --example lockstep` plays against a second process of itself over a local socket (on Unix);
//! `lockstep --steps 10000 --disturb 500 -- COMMAND ..` against that command, which may be of another machine's instructions, and
//! changes the last bit of one particle after step 500.

mod game;
mod peer;

use std::error::Error;
use std::io::{self, Read, Write};
use std::process::ExitCode;

use crate::game::Game;
use crate::peer::play;

/// The particle of the curtain that `--disturb` changes.
const DISTURBED: usize = 100;

fn main() -> ExitCode {
    let arguments = Arguments::parse(std::env::args().skip(1));
    let outcome = arguments.and_then(|arguments| arguments.run());
    outcome.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::from(2)
    })
}

struct Arguments {
    steps: u32,
    disturb: Option<u32>,
    is_guest: bool,
    /// The command that starts the guest.
    guest: Vec<String>,
}

impl Arguments {
    fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut arguments = Self { steps: 10_000, disturb: None, is_guest: false, guest: Vec::new() };
        while let Some(word) = words.next() {
            match word.as_str() {
                "--steps" => arguments.steps = words.next().ok_or("--steps needs a number")?.parse()?,
                "--disturb" => {
                    arguments.disturb = Some(words.next().ok_or("--disturb needs a number")?.parse()?);
                }
                "--guest" => arguments.is_guest = true,
                "--" => arguments.guest = words.by_ref().collect(),
                _ => return Err(format!("unknown argument {word}").into()),
            }
        }
        if arguments.disturb.is_some_and(|step| step == 0 || step > arguments.steps) {
            return Err("--disturb needs one of the steps, from 1".into());
        }
        Ok(arguments)
    }

    fn run(&self) -> Result<ExitCode, Box<dyn Error>> {
        if self.is_guest { self.play_guest() } else { self.play_host() }
    }

    /// The second player, who speaks through standard input and output.
    fn play_guest(&self) -> Result<ExitCode, Box<dyn Error>> {
        let mut game = Game::new()?;
        _ = play(&mut StandardStreams, &mut game, 1, self.steps, |_, _| ())?;
        Ok(ExitCode::SUCCESS)
    }

    /// The first player, who starts the second one.
    #[cfg(unix)]
    fn play_host(&self) -> Result<ExitCode, Box<dyn Error>> {
        use std::os::fd::OwnedFd;
        use std::os::unix::net::UnixStream;
        use std::process::{Command, Stdio};

        let own = std::env::current_exe()?.display().to_string();
        let (program, words) =
            self.guest.split_first().map_or((own, &[][..]), |(first, words)| (first.clone(), words));
        let (mut link, other) = UnixStream::pair()?;
        let mut guest = Command::new(program)
            .args(words)
            .args(["--guest", "--steps", &self.steps.to_string()])
            .stdin(Stdio::from(OwnedFd::from(other.try_clone()?)))
            .stdout(Stdio::from(OwnedFd::from(other)))
            .spawn()?;
        let mut game = Game::new()?;
        let played = play(&mut link, &mut game, 0, self.steps, |game, step| {
            if self.disturb == Some(step) {
                game.disturb(DISTURBED);
            }
        });
        drop(link);
        let status = guest.wait()?;
        if !status.success() {
            return Err(format!("the guest ended with {status}").into());
        }
        let Some(difference) = played? else {
            println!("{} steps, equal in each: {:016x}", self.steps, game.hash());
            return Ok(ExitCode::SUCCESS);
        };
        println!("{difference}");
        Ok(ExitCode::FAILURE)
    }

    #[cfg(not(unix))]
    fn play_host(&self) -> Result<ExitCode, Box<dyn Error>> {
        _ = (&self.guest, self.disturb, DISTURBED, Game::disturb);
        Err("a host needs Unix sockets".into())
    }
}

/// Standard input and output as one link.
struct StandardStreams;

impl Read for StandardStreams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        io::stdin().read(buffer)
    }
}

impl Write for StandardStreams {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        io::stdout().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stdout().flush()
    }
}
