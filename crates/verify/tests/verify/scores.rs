//! Scores of a front end.

use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_verify::verdict::{Finding, Verdict};
use posecut_verify::{Ingredient, verify, verify_by};
use rand::RngExt as _;

fn drawn() -> PoseGraph {
    let mut graph =
        Scenario { candidates: 200, outliers: 0.5, falsehood: Falsehood::Uniform, seed: 3 }.draw::<SE2, 3>();
    // Odometry that is poor beyond the first nodes leaves many edges there undecided.
    let sigma = [0.5, 0.5, 0.06];
    let mut random = posecut_stage::random(3, "poor odometry");
    for edge in graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Odometry && edge.from % 200 >= 60)
    {
        let motion = SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap();
        let noise = sigma.map(|sigma: f64| sigma * 3.0_f64.sqrt() * random.random_range(-1.0..1.0));
        edge.measurement = Some(motion.compose(&SE2::exp(&noise.into())).components());
        let [x, y, heading] = sigma.map(|sigma| sigma.powi(-2));
        edge.information = Some(vec![x, 0.0, 0.0, y, 0.0, heading]);
    }
    graph
}

/// The graph with scores by number and truth.
fn scored(score: impl Fn(usize, bool) -> f64) -> PoseGraph {
    let mut graph = drawn();
    let landmarks = graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark);
    for (number, edge) in landmarks.enumerate() {
        edge.score = Some(score(number, edge.truth_correct() == Some(true)));
    }
    graph
}

fn judged(graph: &PoseGraph) -> Vec<Finding> {
    verify::<SE2, 3>(graph).unwrap().findings
}

/// A spread of numbers from 0 to 1 without a pattern.
fn spread(number: usize) -> f64 {
    (number as f64 * 0.618_033_988_749_895).fract()
}

#[test]
fn equal_scores_change_nothing() {
    assert_eq!(judged(&scored(|_, _| 0.7)), judged(&drawn()));
}

/// A recogniser's scale means nothing: only the order of scores counts.
#[test]
fn a_monotone_change_of_scale_changes_nothing() {
    let score = |number, correct| spread(number) + if correct { 0.6 } else { 0.0 };
    let stretched = |number, correct| 1000.0 * f64::powi(score(number, correct), 3) - 5.0;
    assert_eq!(judged(&scored(score)), judged(&scored(stretched)));
}

/// Without a score the undecided edges of this graph are as likely one as the other; with one, those of high score are likelier.
#[test]
fn what_scores_are_worth_is_learnt_from_the_graph() {
    // Every tenth score belongs to the other kind.
    let high = |number: usize, correct: bool| correct != number.is_multiple_of(10);
    let graph =
        scored(|number, correct| if high(number, correct) { 2.0 } else { 1.0 } + 0.1 * spread(number));
    let without = verify_by::<SE2, 3>(&graph, 0, &[Ingredient::Score]).unwrap().findings;
    assert_eq!(without, judged(&drawn()));
    let (mut raised, mut lowered) = (0, 0);
    for (with, without) in judged(&graph).iter().zip(&without) {
        let both = [with, without].iter().all(|own| own.verdict == Verdict::Undecided);
        if both && with.ratio.is_some() && with.ratio == without.ratio {
            let is_high = graph.edges[with.edge].score.unwrap() > 1.5;
            let change = with.probability - without.probability;
            assert!(if is_high { change >= 0.0 } else { change <= 0.0 }, "{with:?} {without:?}");
            raised += usize::from(change > 0.0);
            lowered += usize::from(change < 0.0);
        }
    }
    assert!(lowered > 0, "{raised} {lowered}");
}
