//! Reports the results of the stage.

use posecut_stage::{Context, Doubt, counted, info, warn};

use crate::Rejection;
use crate::calibration::{Ended, FEWEST, NoScales, ScaleEstimate};

/// Reports the results of PCM, and raises doubts if they may be wrong.
pub(crate) struct Summary<'a>(pub(crate) &'a Rejection);

impl Summary<'_> {
    fn scheme(&self) -> &'static str {
        match self.0.judged.groups_by_cells {
            0 => "exact",
            all if all == self.0.groups => "cells",
            _ => "mixed",
        }
    }

    /// Reports what was kept, raises doubts, and notes the figures.
    pub(crate) fn note(&self, context: &mut Context) {
        let exact = self.0.judged.groups_by_cells == 0;
        let optimal = exact && self.0.judged.clique_size == self.0.judged.clique_upper_bound;
        let kept = self.0.judged.kept;
        let grown = if self.0.judged.grown > 0 {
            format!(", {} of them grown", self.0.judged.grown)
        } else {
            String::new()
        };
        let by_chance = if self.0.judged.by_chance > 0 {
            format!(", {} rejected as chance agreement", self.0.judged.by_chance)
        } else {
            String::new()
        };
        info!(
            "{kept} of {} kept{grown}{by_chance}, {}{}{}",
            counted(self.0.judged.candidates, "landmark edge"),
            counted(self.0.groups, "group"),
            if optimal && kept > 0 { ", proved largest" } else { "" },
            if exact { "" } else { ", by cells" }
        );
        self.doubt(exact, context);
        if self.0.unmeasured > 0 {
            warn!(
                "{} without a measurement: neither tested nor rejected",
                counted(self.0.unmeasured, "landmark edge")
            );
        }
        self.note_figures(exact, optimal, context);
    }

    fn note_figures(&self, exact: bool, optimal: bool, context: &mut Context) {
        let statistics = &mut context.statistics;
        statistics.note("scheme", self.scheme());
        statistics.note("candidates", self.0.judged.candidates);
        statistics.note("groups", self.0.groups);
        statistics.note("groups_by_cells", self.0.judged.groups_by_cells);
        statistics.note("lone_candidates", self.0.judged.lone_candidates);
        statistics.note("unmeasured", self.0.unmeasured);
        statistics.note("rejected_before", self.0.rejected_before);
        statistics.note("against_odometry", self.0.judged.against_odometry);
        statistics.note("pairs", self.0.judged.counts.pairs);
        statistics.note("pairs_skipped_by_rotation", self.0.judged.counts.skipped_by_rotation);
        statistics.note("pairs_skipped_by_translation", self.0.judged.counts.skipped_by_translation);
        statistics.note("consistent_pairs", self.0.judged.counts.consistent);
        statistics.note("indefinite_pairs", self.0.judged.counts.indefinite);
        if !exact {
            statistics.note("cells", self.0.judged.cells);
            statistics.note("hypotheses", self.0.judged.hypotheses);
            statistics.note("hypotheses_left_out", self.0.judged.hypotheses_left_out);
        }
        statistics.note("clique_size", self.0.judged.clique_size);
        statistics.note("clique_upper_bound", self.0.judged.clique_upper_bound);
        statistics.note("optimal", optimal);
        statistics.note("grown", self.0.judged.grown);
        statistics.note("agree_by_chance", self.0.judged.by_chance);
        statistics.note("rejected", self.0.judged.candidates - self.0.judged.kept);
        statistics.note("branch_and_bound_nodes", self.0.judged.work);
        self.note_scale(context);
        let statistics = &mut context.statistics;
        statistics.note("seconds_scale", self.0.calibration.seconds);
        statistics.note("seconds_pairs", self.0.judged.seconds_pairs);
        statistics.note("seconds_clique", self.0.judged.seconds_clique);
        statistics.note("seconds_growth", self.0.judged.seconds_growth);
    }

    fn note_scale(&self, context: &mut Context) {
        let statistics = &mut context.statistics;
        if let Some(Err(NoScales::NoEvidence(nats))) = self.0.calibration.scale {
            statistics.note("scale_evidence", nats);
        }
        if let Some(Err(NoScales::AtBound(ended))) = self.0.calibration.scale {
            statistics.note("scale_ended", ended.name());
        }
        if let Some(Ok(estimate)) = self.0.calibration.scale {
            statistics.note("scale_odometry", estimate.scales.odometry);
            statistics.note("scale_landmark", estimate.scales.landmark);
            statistics.note("scale_correct", estimate.correct);
            statistics.note("scale_loops", estimate.loops);
            statistics.note("scale_edges", estimate.edges);
            statistics.note("scale_evidence", estimate.evidence);
            statistics.note("scale_ended", estimate.ended.map_or("converged", Ended::name));
        }
    }
}

impl Summary<'_> {
    /// Raises the doubts about the cliques and the scales. Without candidates there is nothing to doubt.
    fn doubt(&self, exact: bool, context: &mut Context) {
        if self.0.judged.candidates == 0 {
            return;
        }
        let searched = self.0.judged.searched;
        if searched.size < searched.upper_bound {
            context.doubt(
                Doubt::SearchLimit,
                format!(
                    "the search stopped without a proof: the cliques have {} {}, and at most {} are possible; raise --work-limit or --time-limit",
                    searched.size,
                    if exact { "edges" } else { "edges or hypotheses" },
                    searched.upper_bound
                ),
            );
        }
        if self.0.judged.hypotheses_left_out > 0 {
            context.doubt(
                Doubt::SearchLimit,
                format!(
                    "the search by cells left out {} of {} hypotheses; enlarge --cell-size, or use --scheme exact",
                    self.0.judged.hypotheses_left_out,
                    self.0.judged.hypotheses + self.0.judged.hypotheses_left_out
                ),
            );
        }
        if self.0.judged.kept == 0 {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept; check the units of the information, the covariances (--scale auto) and whether there is overlap",
                    counted(self.0.judged.candidates, "landmark edge")
                ),
            );
        }
        self.doubt_scale(context);
    }

    fn doubt_scale(&self, context: &mut Context) {
        let message = match self.0.calibration.scale {
            Some(Err(NoScales::FewEdges(edges))) => format!(
                "no covariance scale is estimated: this needs at least {FEWEST} landmark edges that close loops, and the graph has {edges}; \
                 the covariances are used unchanged, so check them or give --scale"
            ),
            Some(Err(NoScales::NoEvidence(nats))) => format!(
                "no covariance scale is estimated: the landmark edges fit each other no better than edges with shuffled ends \
                 ({nats:.1} nats), so perhaps all are false; the covariances are used unchanged, so check them or give --scale"
            ),
            Some(Err(NoScales::AtBound(ended))) => format!(
                "no covariance scale is estimated: the fit stopped {}; the covariances are used unchanged, so check the unit of the information or give --scale",
                ended.explanation()
            ),
            Some(Ok(ScaleEstimate { ended: Some(ended), scales, .. })) => format!(
                "the fit of the covariance scales stopped {}: odometry {:.3e}, landmark edges {:.3e}; check the covariances, or give --scale",
                ended.explanation(),
                scales.odometry,
                scales.landmark
            ),
            _ => return,
        };
        context.doubt(Doubt::CalibrationOnPrior, message);
    }
}
