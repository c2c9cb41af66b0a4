//! The program as a user calls it, on graphs in g2o files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

mod bad_input;
mod methods;
mod newcomers;
mod outputs;
mod page;

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

/// Steps of one lap around a square.
const LAP: usize = 40;

/// Runs the program in a folder.
pub(crate) fn clean(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_posecut-clean")).current_dir(folder).args(arguments).output().unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Three laps around a square, with small errors that do not repeat. Every second pose closes the loop to the lap before, and these
/// pairs of poses are said to be one place although they are not.
pub(crate) fn laps(wrong: &[(usize, usize)]) -> String {
    let count = 3 * LAP;
    let error = |place: usize, size: f64| size * (1.7 * place as f64).sin();
    let mut text = String::new();
    for node in 0..count {
        let (x, y, heading) = on_square(node);
        writeln!(text, "VERTEX_SE2 {node} {x} {y} {heading}").unwrap();
    }
    for node in 1..count {
        let turn = if node % (LAP / 4) == 0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        let step = format!(
            "{} {} {}",
            1.0 + error(node, 0.02),
            error(node + 7, 0.02),
            turn + error(node + 3, 0.004)
        );
        writeln!(text, "EDGE_SE2 {} {node} {step} 1000 0 0 1000 0 40000", node - 1).unwrap();
    }
    for node in (LAP..count).step_by(2) {
        let (x, y) = (error(node + 11, 0.03), error(node + 13, 0.03));
        writeln!(text, "EDGE_SE2 {} {node} {x} {y} {} 1000 0 0 1000 0 10000", node - LAP, error(node, 0.005))
            .unwrap();
    }
    for (from, to) in wrong {
        writeln!(text, "EDGE_SE2 {from} {to} 0.1 0.1 0 1000 0 0 1000 0 10000").unwrap();
    }
    text
}

/// The true pose of a node: positions are those before the step, headings turn at the corners.
fn on_square(node: usize) -> (f64, f64, f64) {
    let side = LAP / 4;
    let (mut x, mut y, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
    for step in 1..=node % LAP {
        x += heading.cos();
        y += heading.sin();
        if step % side == 0 {
            heading += std::f64::consts::FRAC_PI_2;
        }
    }
    (x, y, heading)
}

/// The lines of a text that a condition keeps.
pub(crate) fn only(text: &str, keeps: impl Fn(&str) -> bool) -> String {
    text.split_inclusive('\n').filter(|line| keeps(line.trim_end())).collect()
}

/// Edges of a g2o file that are no odometry.
pub(crate) fn landmark_edges(text: &str) -> Vec<(usize, usize)> {
    let ends = |line: &str| {
        let mut words = line.strip_prefix("EDGE_SE2 ")?.split(' ').map(|word| word.parse().unwrap());
        Some((words.next()?, words.next()?))
    };
    let edges = text.lines().filter_map(ends);
    edges.filter(|(from, to): &(usize, usize)| *to != from + 1).collect()
}
