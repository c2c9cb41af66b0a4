//! Robust kernels of the stage: options, weights on the edges, figures.

use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, Statistics, counted};
use serde::{Serialize, Serializer};

use crate::{Edge, EdgeKind, Graduated, Kernel};

/// The cost that graduated non-convexity ends with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Graduation {
    /// Truncated least squares: an edge is in or out
    #[value(alias = "tls")]
    TruncatedLeastSquares,
    /// Geman-McClure
    GemanMcclure,
}

/// Robust kernels by kind of edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct KernelOptions {
    /// Kernel of odometry edges: huber, cauchy, geman-mcclure or dcs, and its width after a colon, in standard deviations
    /// (dcs: phi, a squared residual)
    #[arg(long, value_name = "NAME[:WIDTH]", help_heading = "Robust kernels")]
    #[serde(serialize_with = "kernel_word")]
    pub kernel_odometry: Option<Kernel>,

    /// Kernel of landmark edges, in the same words
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

    /// Graduate non-convexity over the landmark edges, which finds outliers without a good start; with an equals sign before the cost [default with --gnc alone: truncated-least-squares]
    #[arg(
        long,
        value_enum,
        value_name = "COST",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "truncated-least-squares",
        conflicts_with = "kernel_landmark",
        help_heading = "Robust kernels"
    )]
    pub gnc: Option<Graduation>,

    /// Largest residual of a correct landmark edge in standard deviations, for --gnc; default is the 0.99 quantile, 3.368 in
    /// the plane and 4.100 in space
    #[arg(long, value_name = "WIDTH", requires = "gnc", help_heading = "Robust kernels")]
    pub gnc_width: Option<f64>,

    /// Mark landmark edges whose weight ends below this as rejected; 0.5 is usual. Without it edges are only weighed
    #[arg(long, value_name = "WEIGHT", help_heading = "Robust kernels")]
    pub reject_below: Option<f64>,
}

#[allow(clippy::ref_option, reason = "serde hands a field over as it stands")]
fn kernel_word<S: Serializer>(kernel: &Option<Kernel>, serializer: S) -> Result<S::Ok, S::Error> {
    kernel.map(|kernel| kernel.to_string()).serialize(serializer)
}

impl RobustOptions {
    /// The graduation for residuals with so many components.
    pub(super) fn graduated(&self, degrees_of_freedom: usize) -> anyhow::Result<Option<Graduated>> {
        // Roots of the 0.99 quantiles of chi-square with 3 and 6 degrees of freedom, 11.3449 and 16.8119.
        let quantile = if degrees_of_freedom == 3 { 3.368_2 } else { 4.100_2 };
        let width = self.gnc_width.unwrap_or(quantile);
        anyhow::ensure!(
            width > 0.0 && width.is_finite(),
            "--gnc-width is {width}, and must be a positive number of standard deviations"
        );
        if let Some(weight) = self.reject_below {
            anyhow::ensure!(
                weight > 0.0 && weight <= 1.0,
                "--reject-below is {weight}, and must be above 0 and at most 1"
            );
            anyhow::ensure!(
                self.gnc.is_some() || self.kernels.kernel_landmark.is_some(),
                "--reject-below goes by the weights of landmark edges, which only --gnc or --kernel-landmark give; say one of them"
            );
        }
        Ok(self.gnc.map(|gnc| match gnc {
            Graduation::TruncatedLeastSquares => Graduated::TruncatedLeastSquares(width),
            Graduation::GemanMcclure => Graduated::GemanMcClure(width),
        }))
    }

    /// Sets the kernels of the edges.
    pub(super) fn set_kernels<G, const DOF: usize>(&self, edges: &mut [Edge<G, DOF>]) {
        for edge in edges {
            edge.kernel = self.kernels.of(edge.kind);
        }
    }

    /// Writes the weight of every edge with a kernel to its field `weight`, and marks landmark edges of too low a weight as
    /// rejected. `places` are the edges' indices in the graph.
    pub(super) fn write_weights(
        &self,
        graph: &mut PoseGraph,
        places: &[usize],
        weights: &[f64],
        context: &mut Context,
    ) -> anyhow::Result<()> {
        let (mut below_half, mut weighed, mut rejected) = (0_usize, 0_usize, 0_usize);
        for (&place, &weight) in places.iter().zip(weights) {
            let edge = &mut graph.edges[place];
            let under_kernel = match edge.kind {
                posecut_graph::EdgeKind::Odometry => self.kernels.kernel_odometry.is_some(),
                posecut_graph::EdgeKind::Landmark => {
                    self.kernels.kernel_landmark.is_some() || self.gnc.is_some()
                }
            };
            if under_kernel {
                anyhow::ensure!(
                    weight.is_finite(),
                    "{}: the weight of its residual is not a number; give its measurement and information finite, moderate values",
                    edge.name()
                );
                below_half += usize::from(weight < 0.5);
                edge.extra.insert("weight".to_owned(), weight.into());
                let landmark = edge.kind == posecut_graph::EdgeKind::Landmark;
                weighed += usize::from(landmark);
                if landmark && self.reject_below.is_some_and(|bound| weight < bound) {
                    edge.reject("optimize");
                    rejected += 1;
                }
            }
        }
        if let Some(bound) = self.reject_below.filter(|_| weighed > 0 && rejected == weighed) {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept: all weights are below {bound}; check the units of the information, or use a wider kernel",
                    counted(weighed, "landmark edge")
                ),
            );
        }
        let statistics = &mut context.statistics;
        if *self != Self::default() {
            statistics.note("edges_below_half_weight", below_half);
        }
        if self.reject_below.is_some() {
            statistics.note("rejected", rejected);
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
        statistics.note("graduated_non_convexity", self.gnc);
    }
}
