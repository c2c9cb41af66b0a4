//! Compares the recommended method with the best other one, family by family.

use super::benchmark::Benchmark;
use super::joined::sentence;
use super::records::Half;
use super::summary::{Estimate, Summary, summary};
use super::tables::{NONE, Table, recall, with_head};
use crate::table::{grid, metres};

/// A table with a row for each family: the chosen method, the other method with the smallest mean RMSE, and the mean
/// over runs of the smallest RMSE of all methods. No method can reach the last without knowing the truth.
pub fn comparison(benchmark: &Benchmark, half: Half, chosen: usize) -> Table {
    let rows = benchmark.families_of(half).map(Some).chain([None]).map(|family| {
        let own = summary(benchmark, half, family, chosen);
        let others = (0..benchmark.methods.len()).filter(|&method| method != chosen);
        // The mean over only those runs that a method finished would not be comparable.
        let best = others
            .map(|method| (method, summary(benchmark, half, family, method)))
            .filter(|(_, other)| other.done() == other.runs)
            .min_by(|(_, one), (_, other)| mean(one).total_cmp(&mean(other)));
        let smallest: Vec<f64> = benchmark.of(half, family).filter_map(|run| run.best).collect();
        let smallest = smallest.iter().sum::<f64>() / smallest.len() as f64;
        let mut row = vec![family.unwrap_or("all").to_owned(), own.runs.to_string()];
        row.extend(figures(&own));
        match best {
            Some((method, other)) => {
                row.push(benchmark.methods[method].clone());
                row.extend(figures(&other));
            }
            None => row.extend([NONE; 4].map(str::to_owned)),
        }
        row.push(metres(smallest));
        row
    });
    let name = &benchmark.methods[chosen];
    let head = [
        "family",
        "runs",
        "RMSE mean, m",
        "with a false edge",
        "recall",
        "best other",
        "RMSE mean, m",
        "with a false edge",
        "recall",
        "best by the answer, m",
    ];
    Table {
        title: format!("{name} beside the best other method, {half} half"),
        note: format!(
            "The first figures are those of {name}. *Best other*: the method that finished all runs with the smallest mean RMSE. *Best by the answer*: the mean over runs of the smallest RMSE of any method, {name} among them; to choose it, one has to know the true map."
        ),
        cells: with_head(&head, rows),
    }
}

/// The columns of the comparison for a first page, with a note on how to read them. Markdown.
pub fn brief(benchmark: &Benchmark, half: Half, chosen: usize) -> String {
    let table = comparison(benchmark, half, chosen);
    let name = &benchmark.methods[chosen];
    let head = [
        "family of graphs",
        "runs",
        &format!("{name}: mean, m"),
        "runs with a false edge",
        "best other method",
        "mean, m",
        "runs with a false edge",
    ];
    let columns = [0, 1, 2, 3, 5, 6, 7];
    let rows = table.cells.iter().skip(1).map(|row| columns.map(|column| row[column].clone()).to_vec());
    let mut text = format!(
        "Mean RMSE against the optimum of the correct edges, and runs in which an incorrect edge is kept, of `{name}` and of the best of {} other methods for each family, on the {half} half of the [trust benchmark](docs/trust.md):\n\n",
        benchmark.methods.len() - 1
    );
    grid(&mut text, &with_head(&head, rows));
    if let Some(said) = sentence(benchmark, half, chosen) {
        text.push_str(&said);
        text.push('\n');
    }
    text
}

fn mean(own: &Summary) -> f64 {
    own.mean.map_or(f64::INFINITY, |mean| mean.value)
}

fn figures(own: &Summary) -> [String; 3] {
    let recall = own.recall.map(|own| recall(Estimate { interval: None, ..own }));
    [
        own.mean.map_or_else(|| NONE.to_owned(), |mean| metres(mean.value)),
        own.with_false.to_string(),
        recall.unwrap_or_else(|| NONE.to_owned()),
    ]
}
