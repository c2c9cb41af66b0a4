//! Time series, read from NCLT's files and interpolated.

use std::io::{BufRead as _, BufReader};
use std::path::Path;

use anyhow::{Context as _, bail};

use super::plane::wrap;

const LONGEST_SILENCE: f64 = 5.0;

/// N columns of numbers over time in seconds. Columns of angles are interpolated as angles.
pub(super) struct Series<const N: usize> {
    pub(super) times: Vec<f64>,
    pub(super) rows: Vec<[f64; N]>,
    /// The column of angles, if there is one.
    angle: Option<usize>,
}

impl<const N: usize> Series<N> {
    /// Builds a series; `None` if it is too short.
    pub(super) fn new(rows: Vec<(f64, [f64; N])>, angle: Option<usize>) -> Option<Self> {
        let (times, rows): (Vec<f64>, Vec<[f64; N]>) = rows.into_iter().unzip();
        (times.len() > 1).then_some(Self { times, rows, angle })
    }

    pub(super) fn first(&self) -> f64 {
        self.times[0]
    }

    pub(super) fn last(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The columns at a time; `None` outside the series and inside a gap.
    pub(super) fn at(&self, time: f64) -> Option<[f64; N]> {
        let after = self.times.partition_point(|own| *own < time);
        let end = self.times.get(after)?;
        if *end == time {
            return Some(self.rows[after]);
        }
        let before = after.checked_sub(1)?;
        let start = self.times[before];
        if end - start > LONGEST_SILENCE {
            return None;
        }
        let share = (time - start) / (end - start);
        Some(std::array::from_fn(|column| {
            let change = self.rows[after][column] - self.rows[before][column];
            let change = if self.angle == Some(column) { wrap(change) } else { change };
            self.rows[before][column] + share * change
        }))
    }

    /// Pairs of neighbouring rows with their times, except those on both sides of a gap.
    pub(super) fn steps(&self) -> impl Iterator<Item = (f64, [f64; N], [f64; N])> {
        let pairs = self.times.windows(2).zip(self.rows.windows(2));
        let steps = pairs.map(|(times, rows)| (times[1] - times[0], rows[0], rows[1]));
        steps.filter(|(seconds, ..)| *seconds <= LONGEST_SILENCE)
    }
}

/// Times from the first to the last with a constant step.
pub(super) fn grid(first: f64, last: f64, step: f64) -> impl Iterator<Item = f64> {
    (0..=((last - first) / step) as usize).map(move |index| first + index as f64 * step)
}

/// Reads columns of one of NCLT's files, counted from 0; column 0 is the time in microseconds. `None` if there is no
/// such file.
pub(super) fn read<const N: usize>(
    path: &Path,
    columns: [usize; N],
    angle: Option<usize>,
) -> anyhow::Result<Option<Series<N>>> {
    if !path.is_file() {
        return Ok(None);
    }
    let place = || path.display().to_string();
    let mut file = BufReader::new(std::fs::File::open(path).with_context(place)?);
    let (mut rows, mut line, mut number) = (Vec::<(f64, [f64; N])>::new(), Vec::new(), 0);
    while file.read_until(b'\n', &mut line).with_context(place)? > 0 {
        number += 1;
        let text = String::from_utf8_lossy(&line).into_owned();
        line.clear();
        if text.trim().is_empty() || text.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let field = |column: usize| fields.get(column).and_then(|field| field.parse::<f64>().ok());
        let (time, values) = (field(0), columns.map(field));
        let Some(time) = time.filter(|_| values.iter().all(Option::is_some)) else {
            let most = columns.iter().max().copied().unwrap_or_default();
            bail!("{}, line {number}: expected at least {} numbers", path.display(), most + 1);
        };
        let (time, values) = (time * 1e-6, values.map(Option::unwrap_or_default));
        let advances = rows.last().is_none_or(|(before, _)| time > *before);
        if time.is_finite() && values.iter().all(|value| value.is_finite()) && advances {
            rows.push((time, values));
        }
    }
    Ok(Series::new(rows, angle))
}
