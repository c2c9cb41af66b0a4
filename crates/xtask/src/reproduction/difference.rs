//! RMSE of one table minus that of another, run by run.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::Deserialize;

use crate::markdown;

#[derive(Deserialize)]
struct Row {
    pipeline: String,
    method: String,
    session: String,
    seed: String,
    rmse_m: f64,
}

type Key = (String, String, String, String);

fn runs(path: &Path) -> anyhow::Result<Vec<(Key, f64)>> {
    let place = || format!("{}: cannot be used", path.display());
    let mut table = csv::Reader::from_path(path).with_context(place)?;
    let run = |row: Result<Row, csv::Error>| {
        let row = row.with_context(place)?;
        Ok(((row.pipeline, row.method, row.session, row.seed), row.rmse_m))
    };
    table.deserialize().map(run).collect()
}

pub(super) fn table(first: &Path, second: &Path) -> anyhow::Result<String> {
    let before = runs(first)?;
    let after: HashMap<Key, f64> = runs(second)?.into_iter().collect();
    if before.len() != after.len() || before.iter().any(|(run, _)| !after.contains_key(run)) {
        bail!(
            "{} and {} contain different runs; compute both with the same sessions, seeds and methods",
            first.display(),
            second.display()
        );
    }
    let methods: BTreeSet<(&str, &str)> = before.iter().map(|(run, _)| (&*run.0, &*run.1)).collect();
    let row = |(pipeline, method): &(&str, &str)| {
        let own = before.iter().filter(|(run, _)| run.0 == *pipeline && run.1 == *method);
        let changes: Vec<f64> = own.map(|(run, rmse)| after[run] - rmse).collect();
        let largest = changes
            .iter()
            .fold(0.0_f64, |most, change| if change.abs() > most.abs() { *change } else { most });
        let mean = changes.iter().sum::<f64>() / changes.len() as f64;
        vec![
            format!("{pipeline}, {method}"),
            changes.len().to_string(),
            format!("{mean:+.4}"),
            format!("{largest:+.4}"),
        ]
    };
    let head = markdown::cells(&["regime, method", "runs", "mean difference (m)", "largest difference (m)"]);
    Ok(markdown::table(&head, 1, &methods.iter().map(row).collect::<Vec<_>>()).join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_compared_one_by_one() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, rows: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, format!("pipeline,method,session,seed,rmse_m\n{rows}")).unwrap();
            path
        };
        let first = write("first", "paper,pcm,a,1,1.0\npaper,pcm,a,2,2.0\ncalibrated,none,a,1,3.0\n");
        let second = write("second", "paper,pcm,a,2,1.5\npaper,pcm,a,1,1.1\ncalibrated,none,a,1,3.0\n");
        let text = table(&first, &second).unwrap();
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(
            rows,
            ["| calibrated, none | 1 | +0.0000 | +0.0000 |", "| paper, pcm | 2 | -0.2000 | -0.5000 |"]
        );
        let other = write("other", "paper,pcm,b,1,1.0\n");
        assert!(table(&first, &other).unwrap_err().to_string().contains("different runs"));
    }
}
