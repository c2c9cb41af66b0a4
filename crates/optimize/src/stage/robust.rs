//! Robust kernels of the stage: options, weights on the edges, figures.

use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, Statistics, counted};
use serde::{Serialize, Serializer};

use crate::{Edge, EdgeKind, Graduated, Kernel, Prior};

/// The cost that graduated non-convexity ends with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Graduation {
    /// Truncated least squares: each edge is fully used or ignored
    #[value(alias = "tls")]
    TruncatedLeastSquares,
    /// Geman-McClure
    GemanMcclure,
}

/// Robust kernels by kind of edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct KernelOptions {
    /// Put a robust kernel on odometry edges: huber, cauchy, geman-mcclure or dcs, with an optional width in standard
    /// deviations after a colon (for dcs phi, a squared residual).
    ///
    /// For example, `--kernel-odometry cauchy:2.4`.
    #[arg(long, value_name = "NAME[:WIDTH]", help_heading = "Robust kernels")]
    #[serde(serialize_with = "kernel_word")]
    pub kernel_odometry: Option<Kernel>,

    /// Put a robust kernel on landmark edges, named as for `--kernel-odometry`
    #[arg(long, value_name = "NAME[:WIDTH]", help_heading = "Robust kernels")]
    #[serde(serialize_with = "kernel_word")]
    pub kernel_landmark: Option<Kernel>,
}

impl KernelOptions {
    /// The kernel of edges of a kind.
    pub fn of(&self, kind: EdgeKind) -> Option<Kernel> {
        match kind {
            EdgeKind::Odometry => self.kernel_odometry,
            EdgeKind::Landmark => self.kernel_landmark,
        }
    }
}

/// What tempers the influence of outliers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct RobustOptions {
    /// Robust kernels.
    #[command(flatten)]
    #[serde(flatten)]
    pub kernels: KernelOptions,

    /// Put a robust kernel on priors, named as for `--kernel-odometry` [default: that of landmark edges]
    #[arg(long, value_name = "NAME[:WIDTH]", help_heading = "Robust kernels")]
    #[serde(serialize_with = "kernel_word", skip_serializing_if = "Option::is_none")]
    pub kernel_prior: Option<Kernel>,

    /// Reduce the weights of false landmark edges and priors by graduated non-convexity, which needs no good start; write COST after an equals sign [default with --gnc alone: truncated-least-squares]
    #[arg(
        long,
        value_enum,
        value_name = "COST",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "truncated-least-squares",
        conflicts_with_all = ["kernel_landmark", "kernel_prior"],
        help_heading = "Robust kernels"
    )]
    pub gnc: Option<Graduation>,

    /// Set the largest residual of a correct landmark edge or prior for `--gnc`, standard deviations [default: the 0.99 quantile, 3.368 in the plane and 4.100 in space]
    #[arg(long, value_name = "WIDTH", requires = "gnc", help_heading = "Robust kernels")]
    pub gnc_width: Option<f64>,

    /// Reject landmark edges and priors whose final weight is below this; 0.5 is usual.
    ///
    /// Without this option, they are weighted but not rejected.
    #[arg(long, value_name = "WEIGHT", help_heading = "Robust kernels")]
    pub reject_below: Option<f64>,
}

#[allow(clippy::ref_option, reason = "serde hands a field over as it stands")]
fn kernel_word<S: Serializer>(kernel: &Option<Kernel>, serializer: S) -> Result<S::Ok, S::Error> {
    kernel.map(|kernel| kernel.to_string()).serialize(serializer)
}

/// How many records a kernel weighed, and with what result.
#[derive(Default)]
struct Counts {
    below_half: usize,
    weighed: usize,
    rejected: usize,
}

fn check_weight(weight: f64, name: impl Fn() -> String) -> anyhow::Result<()> {
    anyhow::ensure!(
        weight.is_finite(),
        "{}: the weight of its residual is not a number; give its measurement and information finite, moderate values",
        name()
    );
    Ok(())
}

impl RobustOptions {
    /// The graduation for residuals with so many components.
    pub(super) fn graduated(&self, degrees_of_freedom: usize) -> anyhow::Result<Option<Graduated>> {
        // Roots of the 0.99 quantiles of chi-square with 3 and 6 degrees of freedom, 11.3449 and 16.8119.
        let quantile = if degrees_of_freedom == 3 { 3.368_2 } else { 4.100_2 };
        let width = self.gnc_width.unwrap_or(quantile);
        anyhow::ensure!(
            width > 0.0 && width.is_finite(),
            "--gnc-width is {width}, but must be a positive number of standard deviations"
        );
        if let Some(weight) = self.reject_below {
            anyhow::ensure!(
                weight > 0.0 && weight <= 1.0,
                "--reject-below is {weight}, but must be above 0 and at most 1"
            );
            anyhow::ensure!(
                self.gnc.is_some() || self.of_priors().is_some(),
                "--reject-below needs the weights of landmark edges, which only --gnc or --kernel-landmark give; add one of them"
            );
        }
        Ok(self.gnc.map(|gnc| match gnc {
            Graduation::TruncatedLeastSquares => Graduated::TruncatedLeastSquares(width),
            Graduation::GemanMcclure => Graduated::GemanMcClure(width),
        }))
    }

    /// The kernel of priors: their own, or that of landmark edges.
    fn of_priors(&self) -> Option<Kernel> {
        self.kernel_prior.or(self.kernels.kernel_landmark)
    }

    /// Sets the kernels of edges and priors.
    pub(super) fn set_kernels<G, const DOF: usize>(
        &self,
        edges: &mut [Edge<G, DOF>],
        priors: &mut [Prior<G, DOF>],
    ) {
        for edge in edges {
            edge.kernel = self.kernels.of(edge.kind);
        }
        for prior in priors {
            prior.kernel = self.of_priors();
        }
    }

    /// Writes the weight of every edge and prior with a kernel to its field `weight`, and marks landmark edges and priors of too
    /// low a weight as rejected. Weights come with the indices of their records in the graph.
    pub(super) fn write_weights(
        &self,
        graph: &mut PoseGraph,
        edges: (&[usize], &[f64]),
        priors: (&[usize], &[f64]),
        context: &mut Context,
    ) -> anyhow::Result<()> {
        let mut counts = Counts::default();
        let (places, weights) = edges;
        for (&place, &weight) in places.iter().zip(weights) {
            let edge = &mut graph.edges[place];
            let landmark = edge.kind == posecut_graph::EdgeKind::Landmark;
            let under_kernel = if landmark {
                self.kernels.kernel_landmark.is_some() || self.gnc.is_some()
            } else {
                self.kernels.kernel_odometry.is_some()
            };
            if under_kernel {
                check_weight(weight, || edge.name())?;
                counts.below_half += usize::from(weight < 0.5);
                edge.extra.insert("weight".to_owned(), weight.into());
                counts.weighed += usize::from(landmark);
                if landmark && self.reject_below.is_some_and(|bound| weight < bound) {
                    edge.reject("optimize");
                    counts.rejected += 1;
                }
            }
        }
        self.write_prior_weights(graph, priors, context)?;
        if let Some(bound) =
            self.reject_below.filter(|_| counts.weighed > 0 && counts.rejected == counts.weighed)
        {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept: all weights are below {bound}; check the units of the information, or use a wider kernel",
                    counted(counts.weighed, "landmark edge")
                ),
            );
        }
        let statistics = &mut context.statistics;
        if *self != Self::default() {
            statistics.note("edges_below_half_weight", counts.below_half);
        }
        if self.reject_below.is_some() {
            statistics.note("rejected", counts.rejected);
        }
        Ok(())
    }

    fn write_prior_weights(
        &self,
        graph: &mut PoseGraph,
        (places, weights): (&[usize], &[f64]),
        context: &mut Context,
    ) -> anyhow::Result<()> {
        if places.is_empty() || (self.of_priors().is_none() && self.gnc.is_none()) {
            return Ok(());
        }
        let mut counts = Counts { weighed: places.len(), ..Counts::default() };
        for (&place, &weight) in places.iter().zip(weights) {
            let prior = &mut graph.priors[place];
            check_weight(weight, || prior.name())?;
            counts.below_half += usize::from(weight < 0.5);
            prior.extra.insert("weight".to_owned(), weight.into());
            if self.reject_below.is_some_and(|bound| weight < bound) {
                prior.reject("optimize");
                counts.rejected += 1;
            }
        }
        if let Some(bound) = self.reject_below.filter(|_| counts.rejected == counts.weighed) {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept: all weights are below {bound}, so nothing fixes the frame of the map; check their frame and the \
                     units of their information, or use a wider kernel",
                    counted(counts.weighed, "prior")
                ),
            );
        }
        context.statistics.note("priors_below_half_weight", counts.below_half);
        if self.reject_below.is_some() {
            context.statistics.note("priors_rejected", counts.rejected);
        }
        Ok(())
    }

    /// Notes which kernels were used.
    pub(super) fn note(&self, graduated: Option<Graduated>, statistics: &mut Statistics) {
        if *self == Self::default() {
            return;
        }
        let landmark = graduated.map(Graduated::kernel).or(self.kernels.kernel_landmark);
        statistics.note("kernel_odometry", self.kernels.kernel_odometry.map(|kernel| kernel.to_string()));
        statistics.note("kernel_landmark", landmark.map(|kernel| kernel.to_string()));
        if self.kernel_prior.is_some() {
            statistics.note("kernel_prior", self.kernel_prior.map(|kernel| kernel.to_string()));
        }
        statistics.note("graduated_non_convexity", self.gnc);
    }
}
