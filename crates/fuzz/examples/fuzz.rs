//! Fuzzes all or some targets for a given time. Findings are written to a folder and named by target, seed and number.
//!
//! An input that ends the process (stack, memory) leaves no finding. Run the same seed again with `--trace`: the last file
//! `TARGET.current` is that input.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use clap::Parser;
use posecut_fuzz::{Campaign, TARGETS, Target};

#[derive(Parser)]
#[command(about = "Give hostile input to every reader and stage")]
struct Arguments {
    /// Names of the targets [default: all]
    targets: Vec<String>,

    /// Stop after this many seconds in total
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,

    /// Try this many inputs on a target before the next target
    #[arg(long, default_value_t = 3_000)]
    inputs: u64,

    /// Set the seed of the first round; each further round adds 1
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Write findings to this folder
    #[arg(long, default_value = "target/fuzz")]
    findings: PathBuf,

    /// Stop with a finding if one input takes more than this many seconds
    #[arg(long, default_value_t = 20.0)]
    slowest: f64,

    /// Write each input to a file before trying it
    #[arg(long)]
    trace: bool,
}

/// The name and the content of the current input, for the watchdog.
type Current = Arc<Mutex<Option<(String, Vec<u8>)>>>;

/// The interval at which the watchdog looks.
const LOOK: Duration = Duration::from_millis(500);

fn main() -> anyhow::Result<ExitCode> {
    let arguments = Arguments::parse();
    let targets: Vec<&'static Target> = TARGETS
        .iter()
        .filter(|target| {
            arguments.targets.is_empty() || arguments.targets.iter().any(|name| name == target.name)
        })
        .collect();
    anyhow::ensure!(
        !targets.is_empty(),
        "no target has one of these names; the README of the crate lists them"
    );
    std::fs::create_dir_all(&arguments.findings).context("the folder of findings cannot be created")?;
    // A panic is a finding and is reported once, without the default message.
    std::panic::set_hook(Box::new(|_| {}));
    let current = Current::default();
    watch(current.clone(), Duration::from_secs_f64(arguments.slowest), arguments.findings.clone());
    let started = Instant::now();
    let mut tried = vec![0_u64; targets.len()];
    let mut known = BTreeSet::new();
    let mut seed = arguments.seed;
    'all: loop {
        for (place, target) in targets.iter().enumerate() {
            let mut campaign = Campaign::new(target, seed);
            for number in 0..arguments.inputs {
                if started.elapsed().as_secs_f64() > arguments.seconds {
                    break 'all;
                }
                let input = campaign.input();
                if arguments.trace {
                    std::fs::write(arguments.findings.join(format!("{}.current", target.name)), &input)?;
                }
                *current.lock().unwrap_or_else(PoisonError::into_inner) =
                    Some((format!("{}-{seed}-{number}", target.name), input.clone()));
                let result = campaign.step(input);
                *current.lock().unwrap_or_else(PoisonError::into_inner) = None;
                tried[place] += 1;
                if let Err(finding) = result {
                    let name = format!("{}-{seed}-{number}", target.name);
                    let kind = format!(
                        "{}: {}",
                        target.name,
                        finding.message.split(['`', ':']).next().unwrap_or_default()
                    );
                    if known.insert(kind) {
                        say(&format!("finding {name}: {}", finding.message));
                        std::fs::write(arguments.findings.join(&name), &finding.input)?;
                    }
                }
            }
        }
        say(&format!("round with seed {seed} done after {:.0} s", started.elapsed().as_secs_f64()));
        seed += 1;
    }
    for (target, tried) in targets.iter().zip(&tried) {
        say(&format!("{:12} {tried:>10} inputs", target.name));
    }
    say(&format!(
        "{} inputs, {:.0} s, {} kinds of findings",
        tried.iter().sum::<u64>(),
        started.elapsed().as_secs_f64(),
        known.len()
    ));
    Ok(ExitCode::from(u8::from(!known.is_empty())))
}

#[expect(clippy::print_stdout, reason = "this is what the program says")]
fn say(text: &str) {
    println!("{text}");
}

/// Ends the process on an input that takes too long: a hang is a finding like any other.
///
/// The time is counted in looks, not on a clock: a process that is stopped and continued must not count as a hang.
fn watch(current: Current, slowest: Duration, findings: PathBuf) {
    std::thread::spawn(move || {
        let (mut at, mut waited) = (String::new(), Duration::ZERO);
        loop {
            std::thread::sleep(LOOK);
            let guard = current.lock().unwrap_or_else(PoisonError::into_inner);
            let Some((name, input)) = guard.as_ref() else { continue };
            if *name != at {
                (at, waited) = (name.clone(), Duration::ZERO);
            }
            waited += LOOK;
            if waited > slowest {
                say(&format!("finding {name}: not finished after {:.0} s", waited.as_secs_f64()));
                drop(std::fs::write(findings.join(name), input));
                std::process::abort();
            }
        }
    });
}
