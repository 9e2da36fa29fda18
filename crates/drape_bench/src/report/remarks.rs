//! Remarks that compare lines of the table, printed below it.

use crate::report::outcome::Outcome;

/// All remarks on these lines.
pub fn remarks(outcomes: &[Outcome]) -> Vec<String> {
    outcomes.iter().enumerate().flat_map(|(i, outcome)| of_one(outcome, &outcomes[..i])).collect()
}

/// The remarks on a line, compared with those above it.
fn of_one(outcome: &Outcome, above: &[Outcome]) -> Vec<String> {
    let name = format!("{} {} {}", outcome.scene, outcome.n, outcome.solver);
    let mut remarks = Vec::new();
    let twin = |solver: &str, threads: Option<u32>| {
        let is_twin = |other: &&Outcome| {
            other.solver == solver
                && other.is_same_scene(outcome)
                && threads.is_none_or(|threads| threads == other.threads)
        };
        above.iter().find(is_twin)
    };
    if !outcome.is_repeatable {
        remarks.push(format!("{name}: runs ended with different positions"));
    }
    if let Some(other) = twin(outcome.solver, None)
        && other.threads != outcome.threads
    {
        let speed = other.ms_median / outcome.ms_median;
        let bits = if other.state_hash == outcome.state_hash { "the same bits" } else { "DIFFERENT BITS" };
        let (from, to) = (other.threads, outcome.threads);
        remarks.push(format!("{name}: {to} threads are {speed:.2} times as fast as {from}, with {bits}"));
    }
    if outcome.solver == "plugin"
        && let Some(bare) = twin("drape", Some(outcome.threads))
    {
        let cost = outcome.ms_median / bare.ms_median;
        let bits = if bare.state_hash == outcome.state_hash { "the same bits" } else { "DIFFERENT BITS" };
        remarks.push(format!("{name}: {cost:.3} times the time of the bare solver, with {bits}"));
    }
    if let Some(pass) = outcome.memory_pass {
        let (megabytes, pass) = (pass.bytes as f64 / 1e6, pass.time.as_secs_f64() * 1e3);
        let ratio = outcome.ms_median / pass;
        remarks.push(format!(
            "{name}: {ratio:.1} times one thread's pass that reads and writes {megabytes:.1} MB \
             (position, displacement, inverse mass) in {pass:.2} ms"
        ));
    }
    if outcome.scene == "asleep" {
        let (all, micros) = (outcome.n, outcome.ms_median * 1e3);
        remarks.push(format!("{name}: {micros:.1} microseconds a step for all {all} sheets at rest"));
    }
    remarks
}
