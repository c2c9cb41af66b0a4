//! Graphs with false loop closures: the error of kernels and graduation, compared with the graph without false closures.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use crate::g2o;
use posecut_geometry::SE2;
use posecut_optimize::{Edge, EdgeKind, Graduated, Kernel, Options, Problem, optimize};

/// Poses, edges, and which edges are correct; `None` without data.
type Labelled = (Vec<SE2>, Vec<Edge<SE2, 3>>, Vec<bool>);

fn corrupted(name: &str) -> Option<Labelled> {
    let folder = g2o::shared_data().map(|path| path.join("false_closures/corrupted"));
    let read = |ending: &str| std::fs::read_to_string(folder.as_ref()?.join(format!("{name}{ending}"))).ok();
    let (Some(graph), Some(labels)) = (read(".g2o"), read(".labels.csv")) else {
        println!("skipped: no data: false_closures/corrupted/{name}");
        return None;
    };
    let (poses, mut edges) = g2o::planar(&graph);
    let mut correct = Vec::new();
    for (edge, line) in edges.iter_mut().zip(labels.lines().skip(1)) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!((fields[0].parse(), fields[1].parse()), (Ok(edge.from), Ok(edge.to)), "{name}");
        edge.kind = if fields[2] == "odom" { EdgeKind::Odometry } else { EdgeKind::Landmark };
        correct.push(fields[3] == "1");
    }
    assert_eq!(edges.len(), correct.len(), "{name}");
    Some((poses, edges, correct))
}

/// Root mean square of the distances of positions, metres; the first pose is common.
fn rmse(poses: &[SE2], reference: &[SE2]) -> f64 {
    let squares = poses.iter().zip(reference).map(|(a, b)| (a.translation - b.translation).norm_squared());
    (squares.sum::<f64>() / poses.len() as f64).sqrt()
}

const KERNELS: [&str; 4] = ["huber", "cauchy", "geman-mcclure", "dcs"];

/// What remains of the false edges of a graph: errors against the solution of the correct edges alone, metres.
struct Remains {
    plain: f64,
    /// With each of [`KERNELS`].
    kernels: [f64; 4],
    truncated: f64,
    geman_mcclure: f64,
    /// Edges that truncated least squares takes for what they are not.
    misjudged: usize,
}

/// `None` without data.
fn remains(name: &str) -> Option<Remains> {
    let (poses, edges, correct) = corrupted(name)?;
    let clean: Vec<_> =
        edges.iter().zip(&correct).filter(|&(_, &correct)| correct).map(|(edge, _)| *edge).collect();
    let reference = optimize(&Problem::new(poses.clone(), clean).unwrap(), &Options::default()).poses;
    let solve = |kernel: Option<Kernel>, graduated: Option<Graduated>| {
        let mut edges = edges.clone();
        for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
            edge.kernel = kernel;
        }
        let options = Options { graduated, ..Options::default() };
        optimize(&Problem::new(poses.clone(), edges).unwrap(), &options)
    };
    let truncated = solve(None, Some(Graduated::TruncatedLeastSquares(3.368)));
    let geman_mcclure = solve(None, Some(Graduated::GemanMcClure(3.368)));
    Some(Remains {
        plain: rmse(&solve(None, None).poses, &reference),
        kernels: KERNELS.map(|word| rmse(&solve(Some(word.parse().unwrap()), None).poses, &reference)),
        truncated: rmse(&truncated.poses, &reference),
        geman_mcclure: rmse(&geman_mcclure.poses, &reference),
        misjudged: truncated.weights.iter().zip(&correct).filter(|&(&w, &c)| (w > 0.5) != c).count(),
    })
}

fn print_row(name: &str, remains: &Remains) {
    let Remains { plain, kernels, truncated, geman_mcclure, .. } = remains;
    let cells = [&[*plain][..], kernels, &[*truncated, *geman_mcclure]].concat();
    let cells: Vec<String> = cells.iter().map(|cell| format!("{cell:.3}")).collect();
    println!("| {} | {} |", name.replace('_', " "), cells.join(" | "));
}

#[test]
fn graduation_finds_the_graph_without_false_closures() {
    // With the other nine graphs it takes minutes; the README has the results of all.
    for name in ["csail_random_10", "csail_random_50", "csail_grouped_50"] {
        let Some(remains) = remains(name) else { return };
        print_row(name, &remains);
        assert!(remains.truncated < 0.01 * remains.plain && remains.misjudged == 0, "{name}");
    }
}

/// The README names the command that runs this.
#[test]
#[ignore = "takes two minutes; prints the table of the README"]
fn table_of_false_closures() {
    println!("| graph | plain | {} | --gnc | --gnc=geman-mcclure |", KERNELS.join(" | "));
    println!("|---|{}", "---:|".repeat(3 + KERNELS.len()));
    for graph in ["csail", "intel"] {
        for kind in ["random", "grouped"] {
            for percent in [10, 50, 90] {
                let name = format!("{graph}_{kind}_{percent}");
                let Some(remains) = remains(&name) else { return };
                print_row(&name, &remains);
            }
        }
    }
}
