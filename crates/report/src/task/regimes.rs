//! `posecut-report regimes`.

use std::path::{Path, PathBuf};

use crate::figure::plotting::{charts, grids};
use crate::figure::regimes::{Quantity, curves, differences, heat_maps, nearest};
use crate::regimes::document::sections;
use crate::regimes::{Map, table};
use crate::results;
use crate::splice::splice;
use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use posecut_stage::{CommonArguments, write_atomically};

use super::figures::extension;

/// Options of `regimes`.
#[derive(Args)]
pub(crate) struct Regimes {
    /// Results over regimes, one per line, with labels `covariance_scale`, `incorrect_rate`, `session`, `seed`, `method`
    #[arg(required = true)]
    results: Vec<PathBuf>,

    /// Choose what the figure shows
    #[arg(long, value_enum, default_value_t = Show::Rmse, conflicts_with = "table")]
    show: Show,

    /// Write a table instead of a figure
    #[arg(long, value_enum)]
    table: Option<Format>,

    /// Write all tables between the markers of this document (docs/results/regimes.md) instead
    #[arg(long, value_name = "FILE", conflicts_with_all = ["show", "table", "sessions", "kinds"])]
    document: Option<PathBuf>,

    /// Show these sessions [default: all in a table, the first in a figure].
    ///
    /// `all sessions` is the mean over the sessions. A figure shows only the first of the named sessions.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    sessions: Vec<String>,

    /// Show these kinds of false edges [default: all in a table, the first in a figure]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    kinds: Vec<String>,

    /// Show these methods first, in this order
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,

    /// Draw the curves over false edges at the covariance scale nearest to this
    #[arg(long, value_name = "SCALE", default_value_t = 3.0)]
    scale: f64,

    /// Draw the curves over the covariance scale at the false-edge rate nearest to this
    #[arg(long, value_name = "RATE", default_value_t = 0.1)]
    rate: f64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Show {
    /// Heat maps of the mean RMSE, one per method
    Rmse,
    /// Heat maps of the mean precision of edges
    Precision,
    /// Heat maps of the mean recall of edges
    Recall,
    /// Heat maps of what the graph cut changes
    Differences,
    /// Curves over rate and scale, with 95 % intervals
    Curves,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// For readers and documents
    Markdown,
    /// One row per cell
    Csv,
}

impl Regimes {
    pub(crate) fn write(&self, common: &CommonArguments) -> anyhow::Result<Vec<u8>> {
        let map = Map::new(&results::read_all(&self.results)?, &self.methods)?;
        if let Some(document) = &self.document {
            return Self::splice(document, &map);
        }
        let sessions = chosen(&self.sessions, &map.sessions, "session")?;
        let kinds = chosen(&self.kinds, &map.kinds, "kind of false edges")?;
        if let Some(format) = self.table {
            return match format {
                Format::Markdown => Ok(table::markdown(&map, &sessions, &kinds).into_bytes()),
                Format::Csv => table::csv(&map, &sessions, &kinds),
            };
        }
        let (session, kind) = (&sessions[0], &kinds[0]);
        let extension = extension(common)?;
        let quantity = match self.show {
            Show::Rmse => Quantity::Rmse,
            Show::Precision => Quantity::Precision,
            Show::Recall => Quantity::Recall,
            Show::Differences => {
                let (panels, ramp) = differences(&map, session, kind);
                let title = format!("What the graph cut changes: {session}, {kind} false edges");
                return grids(&title, &panels, &ramp, 3)?.write(&extension);
            }
            Show::Curves => {
                let (rates, scales) = map.swept(session, kind);
                let near = |places: &[usize], values: &[f64], wanted: f64| {
                    let values: Vec<f64> = places.iter().map(|&place| values[place]).collect();
                    places.get(nearest(&values, wanted)).copied().unwrap_or(0)
                };
                let scale = near(&scales, &map.scales, self.scale);
                let rate = near(&rates, &map.rates, self.rate);
                return charts(&curves(&map, session, kind, scale, rate), 2)?.write(&extension);
            }
        };
        let (panels, ramp) = heat_maps(&map, session, kind, quantity);
        let columns = if panels.len() == 4 { 2 } else { 3 };
        grids(&format!("{session}, {kind} false edges"), &panels, &ramp, columns)?.write(&extension)
    }
}

impl Regimes {
    /// Writes all tables into the document, and returns no bytes because no other output remains.
    fn splice(document: &Path, map: &Map) -> anyhow::Result<Vec<u8>> {
        let place = || format!("{}: cannot be used", document.display());
        let mut text = std::fs::read_to_string(document).with_context(place)?;
        for (name, table) in sections(map) {
            text = splice(&text, name, &table).with_context(place)?;
        }
        write_atomically(document, |writer| Ok(writer.write_all(text.as_bytes())?))?;
        Ok(Vec::new())
    }
}

/// The requested names, or all if none is requested.
fn chosen(asked: &[String], known: &[String], what: &str) -> anyhow::Result<Vec<String>> {
    if let Some(name) = asked.iter().find(|name| !known.contains(name)) {
        bail!("there is no {what} named {name} in the results; there is {}", known.join(", "));
    }
    Ok(if asked.is_empty() { known.to_vec() } else { asked.to_vec() })
}
