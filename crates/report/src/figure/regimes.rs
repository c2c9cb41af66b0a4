//! The map of regimes as heat maps and curves.

use super::plotting::{Grid, GridCell, Ramp};
use super::ramp::{BETTER, VIRIDIS, WORSE, along};
use super::{Axes, Panel, Polyline, colours};
use crate::regimes::table::{percent, short, signed};
use crate::regimes::{Cell, Comparison, Map, Verdict};
use crate::table::metres;

/// The label of the columns: a ratio, so that it means the same for every session.
const AXIS: &str = "claimed odometry covariance / (0.1 m, 0.0167 rad)^2 per step";

/// RMSE below this is drawn at this value, metres.
pub const FLOOR: f64 = 0.1;

/// The quantity of a heat map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Mean RMSE on a logarithmic scale.
    Rmse,
    /// Mean precision of edges.
    Precision,
    /// Mean recall of edges.
    Recall,
}

/// One heat map a method, and their ramp.
pub fn heat_maps(map: &Map, session: &str, kind: &str, quantity: Quantity) -> (Vec<Grid>, Ramp) {
    let top = map.maps.iter().flat_map(|own| own.cells.iter().flatten()).map(|cell| cell.mean);
    let top = round_up(top.fold(FLOOR * 10.0, f64::max));
    let share = |value: f64| (value.max(FLOOR) / FLOOR).log10() / (top / FLOOR).log10();
    let draw = |cell: &Cell| {
        let (position, text) = match quantity {
            Quantity::Rmse => (share(cell.mean), brief(cell.mean)),
            Quantity::Precision => inverted(cell.precision)?,
            Quantity::Recall => inverted(cell.recall)?,
        };
        let (colour, dark) = along(&VIRIDIS, position);
        Some(GridCell { colour, dark, text, dot: false })
    };
    let grids = map
        .methods
        .iter()
        .filter_map(|method| map.of(session, kind, method))
        .map(|own| {
            let cells = own.cells.iter().map(|cell| cell.as_ref().and_then(draw)).collect();
            grid(map, own.method.clone(), String::new(), cells)
        })
        .collect();
    let (title, ticks) = match quantity {
        Quantity::Rmse => ("mean RMSE over seeds (m)", powers(top, share)),
        Quantity::Precision => ("mean precision of edges", shares()),
        Quantity::Recall => ("mean recall of edges", shares()),
    };
    let reversed = quantity != Quantity::Rmse;
    let colour = |at: f64| along(&VIRIDIS, if reversed { 1.0 - at } else { at }).0;
    (grids, ramp(title, colour, ticks))
}

/// One heat map a comparison, and their ramp: the mean paired difference, with a dot if a test finds it significant.
pub fn differences(map: &Map, session: &str, kind: &str) -> (Vec<Grid>, Ramp) {
    let widest = map.comparisons.iter().flat_map(|own| own.cells.iter().flatten());
    let limit = round_up(widest.map(|effect| effect.difference.abs()).fold(1.0, f64::max));
    let bend = |value: f64| (1.0 + value.abs() / FLOOR).log10() / (1.0 + limit / FLOOR).log10();
    let grids = map
        .compared(session, kind)
        .map(|own| {
            let cells = own
                .cells
                .iter()
                .map(|effect| {
                    effect.map(|effect| {
                        let stops = if effect.difference < 0.0 { &BETTER } else { &WORSE };
                        let (colour, dark) = along(stops, bend(effect.difference));
                        let dot = effect.verdict != Verdict::Neutral;
                        GridCell { colour, dark, text: brief_signed(effect.difference), dot }
                    })
                })
                .collect();
            grid(map, format!("{} against {}", own.with, own.without), counts(own), cells)
        })
        .collect();
    let middle = |value: f64| 0.5 + 0.5 * value.signum() * bend(value);
    let ticks = [-limit, -1.0, 1.0, limit].map(|value| {
        let text = if value < 0.0 { format!("−{}", short(-value)) } else { format!("+{}", short(value)) };
        (middle(value), text)
    });
    let colour = |at: f64| along(if at < 0.5 { &BETTER } else { &WORSE }, (2.0 * at - 1.0).abs()).0;
    let mut ticks = ticks.to_vec();
    ticks.insert(2, (0.5, "0".to_owned()));
    (grids, ramp("difference of RMSE (m); dot: significant", colour, ticks))
}

/// Mean RMSE with its interval: one panel over the share of false edges at one scale, one over the scale at one share.
pub fn curves(map: &Map, session: &str, kind: &str, scale: usize, rate: usize) -> [Panel; 2] {
    let columns = map.scales.len();
    let panel = |title: String, right: &str, values: &[f64], index: &dyn Fn(usize) -> usize| {
        let mut others = 0;
        let lines = map
            .methods
            .iter()
            .filter_map(|method| map.of(session, kind, method))
            .map(|own| {
                let known: Vec<(f64, Cell)> = values
                    .iter()
                    .enumerate()
                    .filter_map(|(place, value)| Some((*value, own.cells[index(place)]?)))
                    .collect();
                let (colour, dash) = colours::method(&own.method, others);
                others += usize::from(colours::method(&own.method, others + 1).0 != colour);
                Polyline {
                    points: known.iter().map(|(value, cell)| (*value, cell.mean.max(FLOOR))).collect(),
                    colour,
                    width: 2.0,
                    dash,
                    band: known.iter().map(|(_, cell)| (cell.low.max(FLOOR), cell.high.max(FLOOR))).collect(),
                    legend: Some(own.method.clone()),
                }
            })
            .collect();
        Panel {
            title,
            axes: Axes {
                right: right.to_owned(),
                up: "mean RMSE (m)".to_owned(),
                equal: false,
                logarithmic_right: true,
                logarithmic_up: true,
            },
            lines,
            marks: Vec::new(),
        }
    };
    let rates: Vec<f64> = map.rates.iter().map(|rate| (rate * 100.0).max(0.01)).collect();
    [
        panel(
            format!("{session}, {kind}: covariance scale {}", short(map.scales[scale])),
            "share of false edges (%)",
            &rates,
            &|place: usize| place * columns + scale,
        ),
        panel(
            format!("{session}, {kind}: {} false edges", percent(map.rates[rate])),
            AXIS,
            &map.scales,
            &|place: usize| rate * columns + place,
        ),
    ]
}

/// The index of the value nearest to the wanted one, by their ratio.
pub fn nearest(values: &[f64], wanted: f64) -> usize {
    let distance = |value: f64| (value.max(1e-9) / wanted).ln().abs();
    let places = 0..values.len();
    places.min_by(|&one, &other| distance(values[one]).total_cmp(&distance(values[other]))).unwrap_or(0)
}

fn grid(map: &Map, title: String, note: String, cells: Vec<Option<GridCell>>) -> Grid {
    Grid {
        title,
        note,
        columns: map.scales.iter().map(|scale| format!("× {}", short(*scale))).collect(),
        rows: map.rates.iter().map(|rate| percent(*rate)).collect(),
        right: AXIS.to_owned(),
        up: "share of false edges".to_owned(),
        cells,
    }
}

fn ramp(title: &str, colour: impl Fn(f64) -> String, ticks: Vec<(f64, String)>) -> Ramp {
    const STEPS: usize = 60;
    Ramp {
        title: title.to_owned(),
        colours: (0..STEPS).map(|step| colour(step as f64 / (STEPS - 1) as f64)).collect(),
        ticks,
    }
}

fn counts(comparison: &Comparison) -> String {
    let count =
        |verdict| comparison.cells.iter().flatten().filter(|effect| effect.verdict == verdict).count();
    format!(
        "helps in {}, neutral in {}, hurts in {}",
        count(Verdict::Helps),
        count(Verdict::Neutral),
        count(Verdict::Hurts)
    )
}

/// A number of metres, without decimals from 100 on.
fn brief(value: f64) -> String {
    if value < 100.0 { metres(value) } else { format!("{value:.0}") }
}

fn brief_signed(value: f64) -> String {
    match value {
        _ if value.abs() < 100.0 => signed(value),
        _ if value < 0.0 => format!("−{:.0}", -value),
        _ => format!("+{value:.0}"),
    }
}

fn inverted(value: Option<f64>) -> Option<(f64, String)> {
    value.map(|value| (1.0 - value, format!("{value:.2}")))
}

fn shares() -> Vec<(f64, String)> {
    [0.0, 0.5, 1.0].map(|share| (share, short(share))).to_vec()
}

fn powers(top: f64, share: impl Fn(f64) -> f64) -> Vec<(f64, String)> {
    let mut ticks = vec![(0.0, format!("≤ {}", short(FLOOR)))];
    let mut power = FLOOR * 10.0;
    while power <= top * 1.001 {
        ticks.push((share(power), short(power)));
        power *= 10.0;
    }
    ticks
}

/// Rounds up to 1, 2 or 5 times a power of ten.
pub(crate) fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|&candidate| candidate >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_rounded_up_and_nearest_ones_found_by_ratio() {
        assert_eq!([0.3, 1.0, 4.1, 5.1, 246.0].map(round_up), [0.5, 1.0, 5.0, 10.0, 500.0]);
        assert_eq!(nearest(&[0.3, 1.0, 10.0], 3.0), 1);
        assert_eq!(brief(99.96), "100.0");
        assert_eq!([-157.6, 2.0, 230.4].map(brief_signed), ["−158", "+2.00", "+230"]);
    }
}
