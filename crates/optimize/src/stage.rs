//! Optimisation as a stage: writes the optimised poses of a pose graph.
//!
//! Options, warnings and statistics; `marginals` writes covariances, `robust` writes weights of edges. Depends on the theory,
//! and on [`pose_graph`](crate::pose_graph), which reads the graph.

mod certify;
mod doubts;
mod figures;
mod marginals;
mod robust;
mod unusable;

use std::time::Instant;

use posecut_graph::{PoseGraph, for_dimension};
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info, warn};
use serde::Serialize;

pub use doubts::doubt_disconnected;
pub use figures::significant;
pub use marginals::MarginalsOf;
pub use robust::{Graduation, KernelOptions, RobustOptions};
pub use unusable::refuse_unless_finite;

use crate::pose_graph::{Measured, edges, fixed_nodes, priors};
use crate::{Initialisation, Method, Options, Phases, PoseGroup, Problem, Solution, optimize};

/// Where to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Whichever of the following costs least
    Best,
    /// The poses in the file
    Given,
    /// Odometry, with its chains joined by landmark edges
    SpanningTree,
    /// Rotations by the chordal relaxation, then translations
    Chordal,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum StepMethod {
    /// Gauss-Newton steps, damped after one fails
    LevenbergMarquardt,
    /// Gauss-Newton steps; stops at the first that fails
    GaussNewton,
    /// Powell's dogleg within a trust region
    Dogleg,
}

/// The options of the optimisation stage.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct StageOptions {
    /// Choose the poses to start from
    #[arg(long, value_enum, default_value_t = Start::Best)]
    pub initialisation: Start,

    /// Choose how steps are computed
    #[arg(long, value_enum, default_value_t = StepMethod::LevenbergMarquardt)]
    pub method: StepMethod,

    /// Try at most this many steps per component
    #[arg(long, value_name = "N", default_value_t = Options::default().max_iterations)]
    pub max_iterations: usize,

    /// Stop when a full step would lower the cost by less than this share of it
    #[arg(long, value_name = "SHARE", default_value_t = Options::default().cost_tolerance)]
    pub cost_tolerance: f64,

    /// Stop when no component of a full step exceeds this (shares of the median measured distance, radians)
    #[arg(long, value_name = "SIZE", default_value_t = Options::default().step_tolerance)]
    pub step_tolerance: f64,

    /// Stop when no cosine of the angle between the residuals and one of their derivatives exceeds this
    #[arg(long, value_name = "COSINE", default_value_t = Options::default().gradient_tolerance)]
    pub gradient_tolerance: f64,

    /// Report in the statistics whether SE-Sync's cost is provably minimal next to the solution, by its dual certificate, which
    /// does not cover priors, and descend from there, too
    #[arg(long, conflicts_with_all = ["kernel_odometry", "kernel_landmark", "kernel_prior", "gnc"])]
    pub certify: bool,

    /// Write marginal covariances at the solution
    #[arg(long, value_enum, value_name = "OF")]
    pub marginals: Option<MarginalsOf>,

    /// Robust kernels.
    #[command(flatten)]
    pub robust: RobustOptions,
}

impl StageOptions {
    fn library_options(&self, degrees_of_freedom: usize) -> anyhow::Result<Options> {
        for (name, value) in [
            ("--cost-tolerance", self.cost_tolerance),
            ("--step-tolerance", self.step_tolerance),
            ("--gradient-tolerance", self.gradient_tolerance),
        ] {
            anyhow::ensure!(
                value >= 0.0 && value.is_finite(),
                "{name} is {value}, but must be zero or a positive number"
            );
        }
        let initialisation = match self.initialisation {
            Start::Best => Initialisation::Best,
            Start::Given => Initialisation::Given,
            Start::SpanningTree => Initialisation::SpanningTree,
            Start::Chordal => Initialisation::Chordal,
        };
        let method = match self.method {
            StepMethod::LevenbergMarquardt => Method::LevenbergMarquardt,
            StepMethod::GaussNewton => Method::GaussNewton,
            StepMethod::Dogleg => Method::Dogleg,
        };
        Ok(Options {
            initialisation,
            method,
            max_iterations: self.max_iterations,
            cost_tolerance: self.cost_tolerance,
            step_tolerance: self.step_tolerance,
            gradient_tolerance: self.gradient_tolerance,
            graduated: self.robust.graduated(degrees_of_freedom)?,
        })
    }
}

impl GraphStage for StageOptions {
    const NAME: &'static str = "optimize";
    const ABOUT: &'static str = "Optimise the poses of a pose graph over the edges in use";
    const PLACE: Place = Place(Phase::Optimisation, 10);
    const DOUBTS: &'static [Doubt] = &[
        Doubt::NotConverged,
        Doubt::NonFiniteCost,
        Doubt::Undetermined,
        Doubt::NotCertified,
        Doubt::NothingKept,
        Doubt::PartsNotConnected,
    ];
    const EXAMPLES: Examples = Examples(&[
        ("Optimise a g2o file", "posecut convert graph.g2o | posecut optimize | posecut convert -o map.g2o"),
        (
            "Reject landmark edges by graduated non-convexity",
            "posecut optimize graph.jsonl --gnc --reject-below 0.5 -o map.jsonl",
        ),
        (
            "Write the marginal covariances of the poses",
            "posecut optimize graph.jsonl --marginals poses -o map.jsonl",
        ),
    ]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        for_dimension!(graph.header.dimension, |G, DOF| run::<G, DOF>(self, graph, context))
    }
}

fn run<G: PoseGroup<DOF>, const DOF: usize>(
    options: &StageOptions,
    graph: &mut PoseGraph,
    context: &mut Context,
) -> anyhow::Result<()> {
    let library_options = options.library_options(DOF)?;
    let Measured { mut edges, places, unmeasured } = edges::<G, DOF>(graph)?;
    let (mut priors, prior_places) = priors::<G, DOF>(graph)?;
    options.robust.set_kernels(&mut edges, &mut priors);
    let poses = graph.poses::<G, DOF>()?;
    let fixed = fixed_nodes(graph)?;
    context.statistics.note("fixed", fixed.len());
    let problem = Problem::new(poses, edges)?.hold(fixed)?.with_priors(priors)?;
    let semidefinite = problem.semidefinite();
    if let [first, ..] = semidefinite {
        info!(
            "{} (smallest eigenvalue within 1e-9 of the largest; first: {})",
            match semidefinite.len() {
                1 => "1 information matrix is numerically singular and is used unchanged".to_owned(),
                count =>
                    format!("{count} information matrices are numerically singular and are used unchanged"),
            },
            graph.edges[places[*first]].name()
        );
    }
    context.statistics.note("semidefinite_information", semidefinite.len());
    let start = Instant::now();
    let mut solution = optimize(&problem, &library_options);
    let certified =
        options.certify.then(|| certify::certify_or_improve(&problem, &mut solution, &library_options));
    context.statistics.note("optimize_seconds", start.elapsed().as_secs_f64());
    let name = |edge: usize| graph.edges[places[edge]].name();
    unusable::refuse_infinite_priors(&problem, &solution, |prior| graph.priors[prior_places[prior]].name())?;
    refuse_unless_finite(solution.cost, problem.edges(), name)?;
    for (node, pose) in graph.nodes.iter_mut().zip(&solution.poses) {
        node.pose = Some(pose.components());
    }
    tell(&solution, unmeasured);
    doubts::of_solution(graph, &solution, context);
    note(&solution, problem.edges().len(), unmeasured, context);
    if let Some(certified) = certified {
        certify::note(&certified, &solution.components, context);
    }
    if let Some(of) = options.marginals {
        marginals::write(of, &problem, &solution, graph, &mut context.statistics);
    }
    let (edge_weights, prior_weights) = (&solution.weights, &solution.prior_weights);
    options.robust.write_weights(graph, (&places, edge_weights), (&prior_places, prior_weights), context)?;
    options.robust.note(library_options.graduated, &mut context.statistics);
    Ok(())
}

fn tell<G>(solution: &Solution<G>, unmeasured: usize) {
    info!(
        "cost {} after {}, {}{}",
        significant(solution.cost),
        counted(solution.iterations, "iteration"),
        counted(solution.components.len(), "component"),
        if solution.converged { "" } else { ", did not converge" }
    );
    let fixed: usize = solution.components.iter().map(|report| report.held).sum();
    if fixed > 0 {
        info!("{} fixed", counted(fixed, "node"));
    }
    let anchored = solution.components.iter().filter(|report| report.priors > 0).count();
    if anchored > 0 {
        info!("{} of {}", counted(solution.prior_weights.len(), "prior"), counted(anchored, "component"));
    }
    warn_of_unmeasured(unmeasured);
}

/// Warns of edges without a measurement, which are not used.
pub fn warn_of_unmeasured(unmeasured: usize) {
    if unmeasured > 0 {
        warn!("{} in use without a measurement: ignored in the optimisation", counted(unmeasured, "edge"));
    }
}

fn note<G>(solution: &Solution<G>, edges: usize, unmeasured: usize, context: &mut Context) {
    let statistics = &mut context.statistics;
    statistics.note("edges", edges);
    statistics.note("unmeasured", unmeasured);
    if !solution.prior_weights.is_empty() {
        statistics.note("priors", solution.prior_weights.len());
    }
    statistics.note("chi_square_given", solution.chi_square_given);
    statistics.note("chi_square_initial", solution.chi_square_initial);
    statistics.note("chi_square", solution.chi_square);
    statistics.note("cost", solution.cost);
    statistics.note("iterations", solution.iterations);
    statistics.note(
        "factorizations",
        solution.components.iter().map(|report| report.factorizations).sum::<usize>(),
    );
    statistics.note("converged", solution.converged);
    statistics.note("components", solution.components.len());
    let largest = solution.components.iter().max_by_key(|report| report.nodes);
    statistics.note("start", largest.map(|report| report.start.name()));
    statistics.note("termination", largest.map(|report| report.termination.name()));
    // The values of the convergence tests, and their tolerances.
    statistics.note("last_promised_share", largest.map(|report| report.last_promise / report.cost));
    statistics.note("last_step", largest.map(|report| report.last_step));
    statistics.note("gradient", largest.map(|report| report.gradient));
    statistics
        .note("factor_blocks", solution.components.iter().map(|report| report.factor_blocks).sum::<usize>());
    statistics.note("factor_flops", solution.components.iter().map(|report| report.flops).sum::<f64>());
    let mut phases = Phases::default();
    for report in &solution.components {
        phases += report.phases;
    }
    statistics.note("analysis_seconds", phases.analysis);
    statistics.note("start_seconds", phases.start);
    statistics.note("linearisation_seconds", phases.linearisation);
    statistics.note("factorisation_seconds", phases.factorisation);
    statistics.note("substitution_seconds", phases.substitution);
}
