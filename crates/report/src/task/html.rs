//! `posecut-report html`.

use std::path::PathBuf;

use crate::figure::Frame;
use crate::figure::regret::regrets;
use crate::page::collect::{Selection, experiment};
use crate::page::document::{Parts, document};
use crate::page::maps::{self, LogMaps, MAP_STEP};
use crate::page::trust::html;
use crate::page::view::{ERROR_STEP, POSITION_STEP, Page};
use crate::page::{history, tables as page_tables};
use crate::published::Published;
use crate::regimes::Map;
use crate::results::{self, RunResult};
use crate::table;
use crate::trust::reliability::reliability;
use crate::trust::{Benchmark, Half, tables::tables};
use clap::Args;
use posecut_graph::InputDigest;
use posecut_stage::{Context, counted, info};

/// Options of `html`.
#[derive(Args)]
pub(crate) struct Html {
    /// Results of posecut-evaluate, or directories to search for *.result.json; graphs are expected in the same directories
    #[arg(required_unless_present_any = ["trust", "map"])]
    results: Vec<PathBuf>,

    /// Add published figures from this TOML file
    #[arg(long, value_name = "FILE")]
    published: Option<PathBuf>,

    /// Show these methods first, in this order
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,

    /// Add columns for these sessions, which have no data
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    missing: Vec<String>,

    /// Add the maps of a laser log, before and after rejection, from this folder of make map; may be repeated
    #[arg(long, value_name = "FOLDER")]
    map: Vec<PathBuf>,

    /// Add the map of regimes from this file of results, one per line; may be repeated
    #[arg(long, value_name = "FILE")]
    regimes: Vec<PathBuf>,

    /// Add the trust benchmark from this file of results, one per line; may be repeated
    #[arg(long, value_name = "FILE")]
    trust: Vec<PathBuf>,

    /// Add CPU times of the trust benchmark from this file, one per line; may be repeated
    #[arg(long, value_name = "FILE", requires = "trust")]
    trust_times: Vec<PathBuf>,

    /// Draw the graphs of this many seeds of each session; tables include all seeds
    #[arg(long, value_name = "N", default_value_t = 3)]
    graph_seeds: usize,

    /// Choose how coordinates are drawn
    #[arg(long, value_enum, default_value_t = Frame::Ned)]
    frame: Frame,

    /// Set the title of the page
    #[arg(long, value_name = "TEXT", default_value = "posecut report")]
    title: String,
}

impl Html {
    pub(crate) fn write(&self, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        let located = results::read_located(&self.results)?;
        let published =
            self.published.as_ref().map(|path| Published::read(path)).transpose()?.unwrap_or_default();
        let plain: Vec<RunResult> = located.iter().map(|located| located.result.clone()).collect();
        let experiment_tables = table::tables(&plain, &self.methods, &self.missing);
        let selection = Selection { seeds: self.graph_seeds, frame: self.frame };
        let experiments = experiment_tables
            .iter()
            .map(|table| experiment(table, &located, &published, selection, context))
            .collect::<anyhow::Result<Vec<_>>>()?;
        let graphs = context.inputs.len();
        let maps = self
            .map
            .iter()
            .map(|folder| maps::read(folder, context))
            .collect::<anyhow::Result<Vec<LogMaps>>>()?;
        let regimes = self.regimes(context)?;
        let trust = self.trust(context)?;
        let (right, up) = self.frame.directions();
        let map_table = maps::table(&maps);
        let page = Page {
            experiments,
            maps,
            regimes,
            trust: trust.as_ref().map(|benchmark| regrets(benchmark, Half::Test)),
            reliability: trust.as_ref().and_then(|benchmark| reliability(benchmark, Half::Test)),
            position_step: POSITION_STEP,
            map_step: MAP_STEP,
            error_step: ERROR_STEP,
            axes: [right, up],
        };
        let parts = Parts {
            title: self.title.clone(),
            tables: experiment_tables
                .iter()
                .map(|table| page_tables::experiment(table, &published))
                .collect(),
            published: published.source.clone(),
            missing: self.missing.clone(),
            maps: map_table,
            trust: trust.as_ref().map_or_else(String::new, |benchmark| html(&tables(benchmark, Half::Test))),
            history: history::history(&located, &context.inputs),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let text = document(&page, &parts)?;
        info!("{}, {}, {} kB", counted(located.len(), "result"), counted(graphs, "graph"), text.len() / 1000);
        context.statistics.note("results", located.len());
        context.statistics.note("graphs", graphs);
        context.statistics.note("maps", page.maps.len());
        context.statistics.note("bytes", text.len());
        Ok(text.into_bytes())
    }

    fn trust(&self, context: &mut Context) -> anyhow::Result<Option<Benchmark>> {
        if self.trust.is_empty() {
            return Ok(None);
        }
        let benchmark = super::trust::benchmark(&self.trust, &self.trust_times, context)?;
        super::trust::check_half(&benchmark, Half::Test)?;
        Ok(Some(benchmark))
    }

    fn regimes(&self, context: &mut Context) -> anyhow::Result<Option<Map>> {
        if self.regimes.is_empty() {
            return Ok(None);
        }
        let located = results::read_located(&self.regimes)?;
        let mut digests: Vec<InputDigest> = located
            .iter()
            .map(|located| InputDigest {
                name: format!("regimes: {}", located.path.file_name().unwrap_or_default().to_string_lossy()),
                sha256: located.sha256.clone(),
            })
            .collect();
        digests.dedup();
        context.inputs.extend(digests);
        let plain: Vec<RunResult> = located.into_iter().map(|located| located.result).collect();
        // The requested order applies to the table's methods only; the map has its own order.
        Map::new(&plain, &[]).map(Some)
    }
}
