//! A ground-truth trajectory by time: CSV without header, `seconds, x, y, heading`.

use anyhow::{Context as _, bail};
use posecut_geometry::{SE2, wrap_angle};

/// Poses in the plane in order of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track(Vec<(f64, [f64; 3])>);

impl Track {
    /// Reads a trajectory; times must increase.
    pub(super) fn read(file: &str, bytes: &[u8]) -> anyhow::Result<Self> {
        let mut rows: Vec<(f64, [f64; 3])> = Vec::new();
        for (line, text) in lines(file, bytes)? {
            let numbers: Option<Vec<f64>> = text
                .split(',')
                .map(|field| field.trim().parse().ok().filter(|number: &f64| number.is_finite()))
                .collect();
            let Some([time, x, y, heading]) = numbers.as_deref() else {
                bail!(
                    "{file}, line {line}: expected time, x, y, heading, found \"{text}\"; correct the line"
                );
            };
            if rows.last().is_some_and(|(before, _)| before >= time) {
                bail!(
                    "{file}, line {line}: the time {time} is not later than the one before; sort the file by time"
                );
            }
            rows.push((*time, [*x, *y, *heading]));
        }
        Ok(Self(rows))
    }

    /// The pose at a time, interpolated between the poses before and after; `None` outside the trajectory and within a silence.
    pub(super) fn at(&self, time: f64, longest_silence: f64) -> Option<SE2> {
        let after = self.0.partition_point(|(other, _)| *other <= time);
        let (before, after) = (self.0.get(after.checked_sub(1)?)?, self.0.get(after)?);
        let gap = after.0 - before.0;
        if gap > longest_silence {
            return None;
        }
        let share = (time - before.0) / gap;
        let [x0, y0, heading0] = before.1;
        let [x1, y1, heading1] = after.1;
        Some(SE2::new(
            x0 + share * (x1 - x0),
            y0 + share * (y1 - y0),
            heading0 + share * wrap_angle(heading1 - heading0),
        ))
    }
}

/// Reads times, one a line, seconds.
pub(super) fn times(file: &str, bytes: &[u8]) -> anyhow::Result<Vec<f64>> {
    lines(file, bytes)?
        .into_iter()
        .map(|(line, text)| {
            text.parse().ok().filter(|time: &f64| time.is_finite()).with_context(|| {
                format!("{file}, line {line}: \"{text}\" is not a time in seconds; correct the line")
            })
        })
        .collect()
}

fn lines<'a>(file: &str, bytes: &'a [u8]) -> anyhow::Result<Vec<(usize, &'a str)>> {
    let text = std::str::from_utf8(bytes)
        .with_context(|| format!("{file}: is not a text file; name a CSV file in UTF-8"))?;
    Ok(text
        .lines()
        .map(str::trim)
        .enumerate()
        .map(|(index, line)| (index + 1, line))
        .filter(|(_, line)| !line.is_empty())
        .collect())
}
