//! The map of regimes: the results of methods by covariance scale and rate of false edges.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, bail};
use posecut_stage::random;
use serde::Serialize;

use super::runs::{Place, Run, SIMULATED, Seeds, UNIFORM, having, kind, number, session, strata};
use super::statistics::{adjusted, bootstrap_interval, mean_of_means, sign_flip_p};
use crate::results::RunResult;

/// An effect with an adjusted p-value below this is significant.
pub const SIGNIFICANCE: f64 = 0.05;

/// The name of the map over all sessions if all are real or all are simulated.
pub const ALL_SESSIONS: &str = "all sessions";

/// The names of the two maps over sessions if some are real and some are simulated.
pub const BY_SOURCE: [&str; 2] = ["real sessions", "simulated sessions"];

/// The seed of resampling. It is fixed, so that the same results give the same intervals.
const SEED: u64 = 1;

/// All cells of an experiment over regimes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Map {
    /// Sessions, sorted. If there are several, [`ALL_SESSIONS`] or [`BY_SOURCE`] come first: they cover the sessions
    /// that have results for the kind of false edges, in the cells that all of these have.
    pub sessions: Vec<String>,
    /// Kinds of false edges: first the uniform one, then the others, sorted.
    pub kinds: Vec<String>,
    /// Methods in the requested order.
    pub methods: Vec<String>,
    /// Scales of the covariance, ascending.
    pub scales: Vec<f64>,
    /// Shares of false edges among all landmark edges, ascending.
    pub rates: Vec<f64>,
    /// One entry for each session, kind and method.
    pub maps: Vec<MethodMap>,
    /// The effect of the graph cut, for each session, kind and method that has a counterpart without it.
    pub comparisons: Vec<Comparison>,
}

/// One method on one session and kind of false edges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodMap {
    /// The session.
    pub session: String,
    /// The kind of false edges.
    pub kind: String,
    /// The method.
    pub method: String,
    /// Cells row by row, one row a rate, one column a scale; `None` without a result.
    pub cells: Vec<Option<Cell>>,
}

/// Means over seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// Mean RMSE, metres.
    pub mean: f64,
    /// The lower end of the mean's 95 % interval, metres.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Number of runs.
    pub seeds: usize,
    /// Mean share of correct edges among those in use.
    pub precision: Option<f64>,
    /// Mean share of correct edges that are in use.
    pub recall: Option<f64>,
}

/// A method compared with the same method without the graph cut.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The session.
    pub session: String,
    /// The kind of false edges.
    pub kind: String,
    /// The method with the graph cut.
    pub with: String,
    /// The method without the graph cut.
    pub without: String,
    /// Cells in the order of [`MethodMap`].
    pub cells: Vec<Option<Effect>>,
}

/// The paired difference over seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// Mean of the RMSE with the graph cut minus the RMSE without it, metres: negative is better.
    pub difference: f64,
    /// The lower end of its 95 % interval, metres.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// The sign-flip test's p-value, adjusted over the cells of this comparison.
    pub p: f64,
    /// The conclusion.
    pub verdict: Verdict,
    /// Number of pairs.
    pub seeds: usize,
}

/// Whether the graph cut changes the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It lowers the error.
    Helps,
    /// The available seeds show no significant effect.
    Neutral,
    /// It raises the error.
    Hurts,
}

impl Verdict {
    /// The word in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Helps => "helps",
            Self::Neutral => "neutral",
            Self::Hurts => "hurts",
        }
    }
}

impl Map {
    /// Builds the map from results with the labels `covariance_scale`, `incorrect_rate`, `session`, `method` and `seed`
    /// (and `incorrect_kind`, by default `uniform`). The methods of `order` come first. The others follow: none,
    /// methods without the graph cut, the graph cut alone, methods with it.
    pub fn new(results: &[RunResult], order: &[String]) -> anyhow::Result<Self> {
        let axis = |name: &str| -> anyhow::Result<Vec<f64>> {
            let mut values =
                results.iter().map(|result| number(result, name)).collect::<anyhow::Result<Vec<f64>>>()?;
            values.sort_by(f64::total_cmp);
            values.dedup();
            Ok(values)
        };
        let (scales, rates) = (axis("covariance_scale")?, axis("incorrect_rate")?);
        if results.is_empty() {
            bail!(
                "there are no results for a map of regimes; name a file of results, one per line (make regimes writes one)"
            );
        }
        let mut runs: BTreeMap<Place, Seeds> = BTreeMap::new();
        for result in results {
            let at = |axis: &[f64], name: &str| -> anyhow::Result<usize> {
                let value = number(result, name)?;
                axis.iter().position(|known| *known == value).context("every value is on its axis")
            };
            let place = (
                session(result),
                kind(result),
                result.label("method"),
                at(&rates, "incorrect_rate")?,
                at(&scales, "covariance_scale")?,
            );
            let said = || {
                format!(
                    "{} on {}, covariance scale {}, rate {}",
                    place.2, place.0, scales[place.4], rates[place.3]
                )
            };
            let said = said();
            let run = Run {
                rmse: result.rmse,
                precision: result.edges.and_then(|edges| edges.precision()),
                recall: result.edges.and_then(|edges| edges.recall()),
            };
            let seed = result.label("seed");
            if runs.entry(place).or_default().insert(seed.clone(), run).is_some() {
                bail!("seed {seed} of {said} occurs twice; name the results of one experiment, each once");
            }
        }
        let distinct = |pick: fn(&Place) -> &String| -> Vec<String> {
            runs.keys().map(|place| pick(place).clone()).collect::<BTreeSet<_>>().into_iter().collect()
        };
        let found = distinct(|place| &place.2);
        let mut methods: Vec<String> =
            order.iter().filter(|method| found.contains(method)).cloned().collect();
        let mut others: Vec<String> = found.into_iter().filter(|method| !order.contains(method)).collect();
        others.sort_by_key(|method| rank(method));
        methods.extend(others);
        let mut kinds = distinct(|place| &place.1);
        kinds.sort_by_key(|kind| kind != UNIFORM);
        let mut map = Self {
            sessions: distinct(|place| &place.0),
            kinds,
            methods,
            scales,
            rates,
            maps: Vec::new(),
            comparisons: Vec::new(),
        };
        map.fill(&runs);
        Ok(map)
    }

    /// The index of a cell in a map's list.
    pub fn index(&self, rate: usize, scale: usize) -> usize {
        rate * self.scales.len() + scale
    }

    /// A method's map.
    pub fn of(&self, session: &str, kind: &str, method: &str) -> Option<&MethodMap> {
        self.maps.iter().find(|map| map.session == session && map.kind == kind && map.method == method)
    }

    /// The indices of the rates and scales with at least one result of a session and kind of false edges. Kinds other
    /// than the uniform one are swept at fewer points.
    pub fn swept(&self, session: &str, kind: &str) -> (Vec<usize>, Vec<usize>) {
        let own: Vec<&MethodMap> =
            self.maps.iter().filter(|map| map.session == session && map.kind == kind).collect();
        let known =
            |rate: usize, scale: usize| own.iter().any(|map| map.cells[self.index(rate, scale)].is_some());
        let (rates, scales) = (0..self.rates.len(), 0..self.scales.len());
        (
            rates.clone().filter(|&rate| scales.clone().any(|scale| known(rate, scale))).collect(),
            scales.clone().filter(|&scale| rates.clone().any(|rate| known(rate, scale))).collect(),
        )
    }

    /// Whether there is any result of a session with a kind of false edges.
    pub fn has(&self, session: &str, kind: &str) -> bool {
        !self.swept(session, kind).0.is_empty()
    }

    /// Single sessions, without the maps over several.
    pub fn singles(&self) -> impl Iterator<Item = &String> {
        let together = |name: &str| name == ALL_SESSIONS || BY_SOURCE.contains(&name);
        self.sessions.iter().filter(move |name| !together(name))
    }

    /// The comparisons on a session and kind of false edges.
    pub fn compared<'a>(
        &'a self,
        session: &'a str,
        kind: &'a str,
    ) -> impl Iterator<Item = &'a Comparison> + 'a {
        self.comparisons
            .iter()
            .filter(move |comparison| comparison.session == session && comparison.kind == kind)
    }

    fn fill(&mut self, runs: &BTreeMap<Place, Seeds>) {
        let groups = groups(&self.sessions);
        for (name, sessions) in &groups {
            for kind in &self.kinds {
                let members = &having(runs, sessions, kind);
                for method in &self.methods {
                    let cells = self
                        .cells(|rate, scale| Cell::of(&strata(runs, members, kind, method, rate, scale)?));
                    self.maps.push(MethodMap {
                        session: name.clone(),
                        kind: kind.clone(),
                        method: method.clone(),
                        cells,
                    });
                }
                for (with, without) in pairs(&self.methods) {
                    let effects = self.cells(|rate, scale| {
                        let one = strata(runs, members, kind, &with, rate, scale)?;
                        let other = strata(runs, members, kind, &without, rate, scale)?;
                        Effect::of(&one, &other)
                    });
                    self.comparisons.push(Comparison {
                        session: name.clone(),
                        kind: kind.clone(),
                        with,
                        without,
                        cells: judged(effects),
                    });
                }
            }
        }
        self.sessions = groups.into_iter().map(|(name, _)| name).collect();
    }

    fn cells<T>(&self, of: impl Fn(usize, usize) -> Option<T>) -> Vec<Option<T>> {
        (0..self.rates.len() * self.scales.len())
            .map(|index| of(index / self.scales.len(), index % self.scales.len()))
            .collect()
    }
}

/// The maps to build: each one's name and sessions.
fn groups(singles: &[String]) -> Vec<(String, Vec<String>)> {
    let (simulated, real): (Vec<String>, Vec<String>) =
        singles.iter().cloned().partition(|session| session.ends_with(SIMULATED));
    let names = if real.is_empty() || simulated.is_empty() { [ALL_SESSIONS; 2] } else { BY_SOURCE };
    let together = names.into_iter().zip([real, simulated]).filter(|(_, members)| members.len() > 1);
    let each = singles.iter().map(|session| (session.clone(), vec![session.clone()]));
    together.map(|(name, members)| (name.to_owned(), members)).chain(each).collect()
}

/// The rank of a method in the order of rows: a method follows those that it is compared with.
fn rank(method: &str) -> u8 {
    match method {
        "none" => 0,
        "gc" => 2,
        _ if method.ends_with("+gc") => 3,
        _ => 1,
    }
}

/// Methods with the graph cut and their counterparts: `gc` and `none`, `x+gc` and `x`.
fn pairs(methods: &[String]) -> Vec<(String, String)> {
    methods
        .iter()
        .filter_map(|method| {
            let without = if method == "gc" { "none" } else { method.strip_suffix("+gc")? };
            methods.iter().any(|known| known == without).then(|| (method.clone(), without.to_owned()))
        })
        .collect()
}

impl Cell {
    fn of(strata: &[&Seeds]) -> Option<Self> {
        let pick = |of: fn(&Run) -> Option<f64>| -> Vec<Vec<f64>> {
            strata.iter().map(|seeds| seeds.values().filter_map(of).collect()).collect()
        };
        let rmse = pick(|run| Some(run.rmse));
        let (low, high) = bootstrap_interval(&rmse, &mut random(SEED, "regimes"))?;
        Some(Self {
            mean: mean_of_means(&rmse)?,
            low,
            high,
            seeds: rmse.iter().map(Vec::len).sum(),
            precision: mean_of_means(&pick(|run| run.precision)),
            recall: mean_of_means(&pick(|run| run.recall)),
        })
    }
}

impl Effect {
    /// Uses the seeds that both have. The p-value is not yet adjusted.
    fn of(with: &[&Seeds], without: &[&Seeds]) -> Option<Self> {
        let differences: Vec<Vec<f64>> = with
            .iter()
            .zip(without)
            .map(|(with, without)| {
                with.iter().filter_map(|(seed, run)| Some(run.rmse - without.get(seed)?.rmse)).collect()
            })
            .collect();
        let (low, high) = bootstrap_interval(&differences, &mut random(SEED, "regimes"))?;
        Some(Self {
            difference: mean_of_means(&differences)?,
            low,
            high,
            p: sign_flip_p(&differences, &mut random(SEED, "regimes")),
            verdict: Verdict::Neutral,
            seeds: differences.iter().map(Vec::len).sum(),
        })
    }
}

fn judged(mut cells: Vec<Option<Effect>>) -> Vec<Option<Effect>> {
    let values: Vec<f64> = cells.iter().flatten().map(|effect| effect.p).collect();
    for (effect, p) in cells.iter_mut().flatten().zip(adjusted(&values)) {
        effect.p = p;
        effect.verdict = match effect.difference {
            _ if p > SIGNIFICANCE => Verdict::Neutral,
            difference if difference < 0.0 => Verdict::Helps,
            _ => Verdict::Hurts,
        };
    }
    cells
}
