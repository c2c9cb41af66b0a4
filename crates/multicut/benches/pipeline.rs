//! Growth of the exact solver's time on graphs that resemble those of the pipeline.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use posecut_multicut::generate::{Family, generate};
use posecut_multicut::{Options, Solver, solve};

fn grow(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("segments");
    group.sample_size(10);
    for viewpoints in [1_000, 10_000, 100_000] {
        for incorrect in [0.1, 0.5, 0.9] {
            let graph = generate(Family::Segments, viewpoints, incorrect, 1).unwrap();
            group.throughput(Throughput::Elements(graph.edges().len() as u64));
            let name = format!("{incorrect} false");
            group.bench_with_input(BenchmarkId::new(name, viewpoints), &graph, |bencher, graph| {
                bencher.iter(|| solve(graph, &Options::default()));
            });
        }
    }
    group.finish();
}

fn heuristics(criterion: &mut Criterion) {
    let graph = generate(Family::Aliased, 10_000, 0.5, 1).unwrap();
    let mut group = criterion.benchmark_group("aliased");
    group.sample_size(10);
    for solver in [Solver::Gaec, Solver::Klj] {
        let options = Options { solver, ..Options::default() };
        group.bench_function(format!("{solver:?}"), |bencher| bencher.iter(|| solve(&graph, &options)));
    }
    group.finish();
}

criterion_group!(benches, grow, heuristics);
criterion_main!(benches);
