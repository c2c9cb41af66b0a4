//! Islands as a stage: marks the landmark edges of islands that are too short.

use std::collections::BTreeSet;

use anyhow::ensure;
use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info};
use serde::Serialize;

use crate::{Match, clusters, matches};

/// The options of islands.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Join landmark edges into an island if they are at most this many frames apart at both ends
    #[arg(long, value_name = "FRAMES", default_value_t = 2)]
    pub gap: u64,

    /// Keep islands with at least this many different query frames
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub minimum_frames: usize,

    /// Keep islands whose edge scores sum to at least this; an edge without a score counts 1
    #[arg(long, value_name = "SCORE", default_value_t = 0.0)]
    pub minimum_score: f64,
}

impl GraphStage for Options {
    const NAME: &'static str = "islands";
    const ABOUT: &'static str = "Reject landmark edges that do not come in runs of consecutive frames";
    const PLACE: Place = Place(Phase::Judgement, 30);
    const DOUBTS: &'static [Doubt] = &[Doubt::NothingKept];
    const EXAMPLES: Examples = Examples(&[
        (
            "Reject edges, and optimise the poses",
            "posecut islands graph.jsonl | posecut optimize -o map.jsonl",
        ),
        (
            "Keep only runs of at least 10 frames",
            "posecut islands graph.jsonl --minimum-frames 10 -o islands.jsonl",
        ),
    ]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        ensure!(
            self.minimum_score.is_finite(),
            "--minimum-score is {}, but must be a finite number",
            self.minimum_score
        );
        let matches = matches(graph)?;
        let islands = clusters(&matches, self.gap);
        let (mut kept, mut rejected, mut longest) = (0, 0, 0);
        for island in &islands {
            let frames = query_frames(&matches, island);
            longest = longest.max(frames);
            let score: f64 =
                island.iter().map(|&member| graph.edges[matches[member].edge].score.unwrap_or(1.0)).sum();
            if frames >= self.minimum_frames && score >= self.minimum_score {
                kept += 1;
                continue;
            }
            rejected += island.len();
            for &member in island {
                graph.edges[matches[member].edge].reject(Self::NAME);
            }
        }
        info!(
            "{} of {} kept, in {} of {}",
            matches.len() - rejected,
            counted(matches.len(), "landmark edge"),
            kept,
            counted(islands.len(), "island")
        );
        if !matches.is_empty() && rejected == matches.len() {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept: the longest island has {}; lower --minimum-frames or --minimum-score, or raise --gap to the spacing of the candidates",
                    counted(matches.len(), "landmark edge"),
                    counted(longest, "frame")
                ),
            );
        }
        let statistics = &mut context.statistics;
        statistics.note("candidates", matches.len());
        statistics.note("islands", islands.len());
        statistics.note("islands_kept", kept);
        statistics.note("longest_island_frames", longest);
        statistics.note("rejected", rejected);
        Ok(())
    }
}

/// Different query frames of an island.
fn query_frames(matches: &[Match], island: &[usize]) -> usize {
    island.iter().map(|&member| matches[member].query).collect::<BTreeSet<_>>().len()
}
