//! Regret of every run: one dot a run, by family (panels) and method (lanes).

use std::collections::BTreeMap;

use serde::Serialize;

use super::plotting::{Dot, Lane, LanePanel, Lanes};
use super::regimes::round_up;
use crate::trust::summary::summary;
use crate::trust::tables::whole;
use crate::trust::{Benchmark, Half};

/// Up to this regret, in metres, the axis is nearly linear, so that 0 is on it.
pub const LINEAR: f64 = 0.1;

/// Number of steps of the axis, each about as wide as a dot. Dots in the same step are drawn side by side.
const STEPS: f64 = 80.0;

/// The most dots side by side across a lane; further ones coincide.
const LEVELS: usize = 5;

/// The data of the page and the figure, with all positions on one axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Regrets {
    /// The half.
    pub half: String,
    /// Methods, from top to bottom.
    pub methods: Vec<String>,
    /// Metres at the right end of the axis.
    pub top: f64,
    /// Families that have runs.
    pub families: Vec<Family>,
}

/// One family.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Family {
    /// Its name.
    pub name: String,
    /// In the order of the methods.
    pub methods: Vec<Method>,
}

/// One method on a family.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Method {
    /// For each finished run, in the order of runs, its regret in metres and its number of false edges in use.
    pub regrets: Vec<(f64, usize)>,
    /// The mean regret, metres.
    pub mean: Option<f64>,
    /// Runs within the bound.
    pub within: usize,
    /// Runs that the method did not finish, or that have no record of it.
    pub unfinished: usize,
}

/// Collects the regrets of a half, with the methods sorted by their share of runs within the bound.
pub fn regrets(benchmark: &Benchmark, half: Half) -> Regrets {
    let ranking = benchmark.ranking(half);
    let method = |family: &str, method: usize| {
        let own = summary(benchmark, half, Some(family), method);
        let regrets = benchmark
            .of(half, Some(family))
            .filter_map(|run| Some((run.regret(method)?, run.outcome(method)?.false_kept)))
            .collect();
        Method {
            regrets,
            mean: own.regret.map(|mean| mean.value),
            within: own.within,
            unfinished: own.failed + own.missing,
        }
    };
    let families: Vec<Family> = benchmark
        .families_of(half)
        .map(|family| Family {
            name: family.to_owned(),
            methods: ranking.iter().map(|&place| method(family, place)).collect(),
        })
        .collect();
    let all = families.iter().flat_map(|family| &family.methods).flat_map(|method| &method.regrets);
    let largest = all.map(|(regret, _)| *regret).fold(0.0, f64::max);
    Regrets {
        half: half.to_string(),
        methods: ranking.iter().map(|&place| benchmark.methods[place].clone()).collect(),
        top: round_up(largest.max(10.0 * LINEAR)),
        families,
    }
}

/// The position of a regret on the axis, 0 to 1: log(1 + r / 0.1), linear near 0 and logarithmic far above 0.1 m.
pub fn position(regret: f64, top: f64) -> f64 {
    (regret / LINEAR).ln_1p() / (top / LINEAR).ln_1p()
}

/// Builds the figure.
pub fn figure(regrets: &Regrets) -> Lanes {
    let mut ticks = vec![(0.0, "0".to_owned())];
    let mut tick = LINEAR;
    while tick <= regrets.top * (1.0 + 1e-9) {
        ticks.push((position(tick, regrets.top), crate::regimes::table::short(tick)));
        tick *= 10.0;
    }
    let panels = regrets.families.iter().map(|family| LanePanel {
        title: family.name.clone(),
        lanes: family.methods.iter().map(|method| lane(method, regrets.top)).collect(),
    });
    Lanes {
        title: format!("Regret of every run, {} half", regrets.half),
        axis: "Regret (m): RMSE less that of the best method on the same run; linear up to about 0.1 m, logarithmic above"
            .to_owned(),
        labels: regrets.methods.clone(),
        ticks,
        legend: [
            "one run, no false edge kept".to_owned(),
            "one run, a false edge kept".to_owned(),
            "mean of the finished runs".to_owned(),
            format!("share of all runs within {}", crate::trust::benchmark::BOUND),
            "runs without a result: failed or missing".to_owned(),
        ],
        panels: panels.collect(),
    }
}

fn lane(method: &Method, top: f64) -> Lane {
    let runs = method.regrets.len() + method.unfinished;
    Lane {
        dots: spread(method, top),
        bar: method.mean.map(|mean| position(mean, top)),
        text: whole(method.within as f64 / runs.max(1) as f64),
        crossed: method.unfinished,
    }
}

/// Spreads dots that would coincide across the lane: 0, +, -, ++, --. If there are more than five, the others are not
/// drawn.
fn spread(method: &Method, top: f64) -> Vec<Dot> {
    let mut taken: BTreeMap<i64, usize> = BTreeMap::new();
    // Marked dots first, so that each gets a level of its own.
    let mut regrets = method.regrets.clone();
    regrets.sort_by(|one, other| (other.1 > 0).cmp(&(one.1 > 0)).then_with(|| one.0.total_cmp(&other.0)));
    let mut dots: Vec<Dot> = regrets
        .into_iter()
        .filter_map(|(regret, false_kept)| {
            let along = position(regret, top);
            let level = taken.entry((along * STEPS).round() as i64).or_default();
            let here = *level;
            *level += 1;
            let step = here.div_ceil(2) as f64 / (LEVELS / 2) as f64;
            let across = if here % 2 == 1 { -step } else { step };
            (here < LEVELS).then_some(Dot { along, across, marked: false_kept > 0 })
        })
        .collect();
    dots.sort_by_key(|dot| dot.marked);
    dots
}
