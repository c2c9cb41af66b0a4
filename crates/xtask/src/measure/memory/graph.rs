//! Draws a graph of any size: two sessions with half of the nodes each, on the same route, with a landmark edge for
//! every tenth node, a fifth of them incorrect.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use crate::Verdict;
use crate::twister::Twister;

/// Draw the graph that `measure memory` gives to programs
#[derive(Args)]
pub(crate) struct Graph {
    nodes: u32,
    output: PathBuf,
}

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"odometry":{"information":[400,0,0,400,0,40000]},"landmark":{"information":[100,0,0,100,0,2500]}}}"#;

/// A pose: x, y and heading.
type Pose = [f64; 3];

impl Graph {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let place = || format!("{}: cannot be written", self.output.display());
        let mut file = BufWriter::new(std::fs::File::create(&self.output).with_context(place)?);
        draw(self.nodes, &mut file).and_then(|()| file.flush()).with_context(place)?;
        Ok(Verdict::Holds)
    }
}

/// The pose `b` in the frame of `a`.
fn between(a: Pose, b: Pose) -> Pose {
    let (sine, cosine) = (a[2].sin(), a[2].cos());
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    [cosine * x + sine * y, cosine * y - sine * x, wrapped(b[2] - a[2])]
}

fn moved(a: Pose, by: Pose) -> Pose {
    let (sine, cosine) = (a[2].sin(), a[2].cos());
    [a[0] + cosine * by[0] - sine * by[1], a[1] + sine * by[0] + cosine * by[1], wrapped(a[2] + by[2])]
}

fn wrapped(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

fn text(pose: Pose) -> String {
    format!("[{:.6},{:.6},{:.6}]", pose[0], pose[1], pose[2])
}

fn draw(nodes: u32, file: &mut impl Write) -> std::io::Result<()> {
    let mut draw = Twister::new(1);
    let noisy = |draw: &mut Twister, motion: Pose, sigmas: Pose| {
        [0, 1, 2].map(|axis| motion[axis] + draw.normal(sigmas[axis]))
    };
    let length = nodes / 2;
    let mut truth = vec![[0.0; 3]];
    for step in 0..length.saturating_sub(1) {
        let turn = 0.1 * (f64::from(step) / 40.0).sin() + 0.002;
        truth.push(moved(truth[step as usize], [1.0, 0.0, turn]));
    }
    writeln!(file, "{HEADER}")?;
    let mut edges = Vec::new();
    for (session, name) in [(0, 'a'), (1, 'b')] {
        let mut pose = [0.0; 3];
        for frame in 0..length {
            let id = session * length + frame;
            let own = truth[frame as usize];
            if frame > 0 {
                let motion = noisy(&mut draw, between(truth[frame as usize - 1], own), [0.05, 0.05, 0.005]);
                pose = moved(pose, motion);
                edges.push(format!(
                    r#"{{"kind":"odometry","id":{},"from":{},"to":{id},"measurement":{},"noise":"odometry"}}"#,
                    edges.len(),
                    id - 1,
                    text(motion)
                ));
            }
            writeln!(
                file,
                r#"{{"kind":"node","id":{id},"session":"{name}","frame":{frame},"pose":{},"truth":{{"pose":{}}}}}"#,
                text(pose),
                text(own)
            )?;
        }
    }
    for _ in 0..nodes / 10 {
        let (first, correct) = (draw.below(length), draw.random() > 0.2);
        let second = if correct {
            (first + draw.below(5)).saturating_sub(2).min(length - 1)
        } else {
            draw.below(length)
        };
        let motion = if correct { between(truth[first as usize], truth[second as usize]) } else { [0.0; 3] };
        let measured = noisy(&mut draw, motion, [0.1, 0.1, 0.02]);
        edges.push(format!(
            r#"{{"kind":"landmark","id":{},"from":{first},"to":{},"measurement":{},"noise":"landmark","truth":{{"correct":{correct}}}}}"#,
            edges.len(),
            length + second,
            text(measured)
        ));
    }
    edges.iter().try_for_each(|edge| writeln!(file, "{edge}"))
}
