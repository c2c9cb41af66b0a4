//! Verification, with its defaults, and PCM, with its defaults and with `--chance`, on random scenarios of two sessions.
//!
//! `cargo bench -p posecut-verify -- /1000/` runs one size. The two large sizes take minutes each, and need
//! `POSECUT_BENCH_LARGE` in the environment; `cargo xtask measure verify` measures whole processes.

#![allow(clippy::unwrap_used, reason = "a bench may panic")]

use std::time::Duration;

use clap::Parser as _;
use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use posecut_geometry::SE2;
use posecut_graph::PoseGraph;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_stage::{CommonArguments, Context, GraphStage, Identity};

/// Numbers of candidates. The third is that of five whole NCLT sessions, a tenth of them false.
const SIZES: [usize; 4] = [1000, 5000, 41_142, 100_000];

/// Larger sizes need `POSECUT_BENCH_LARGE`.
const LARGEST: usize = 5000;

#[derive(clap::Parser)]
struct Line<O: clap::Args> {
    #[command(flatten)]
    options: O,
    #[command(flatten)]
    common: CommonArguments,
}

/// Runs a stage on a graph in memory, as its program does between reading and writing.
fn judge<S: GraphStage>(graph: &mut PoseGraph, options: &[&str]) {
    let line = Line::<S>::parse_from(["stage"].iter().chain(options));
    let identity =
        Identity { name: S::NAME, version: "0", about: S::ABOUT, place: S::PLACE, examples: S::EXAMPLES };
    line.options.run(graph, &mut Context::new(identity, line.common)).unwrap();
}

fn bench(criterion: &mut Criterion, graph: &PoseGraph, name: &str, (method, judge): (&str, Method)) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    group.bench_function(BenchmarkId::from_parameter(method), |bencher| {
        bencher.iter_batched(
            || graph.clone(),
            |mut graph| {
                judge(&mut graph);
                graph
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

/// Judges the landmark edges of a graph.
type Method<'a> = &'a dyn Fn(&mut PoseGraph);

fn benches(criterion: &mut Criterion) {
    let large = std::env::var_os("POSECUT_BENCH_LARGE").is_some();
    for candidates in SIZES.into_iter().filter(|&size| large || size <= LARGEST) {
        for (kind, falsehood) in [("uniform", Falsehood::Uniform), ("grouped", Falsehood::Grouped)] {
            let graph = Scenario { candidates, outliers: 0.3, falsehood, seed: 1 }.draw::<SE2, 3>();
            let methods: [(&str, Method); 3] = [
                ("verify", &|graph| judge::<posecut_verify::Options>(graph, &[])),
                ("pcm", &|graph| judge::<posecut_pcm::stage::StageOptions>(graph, &[])),
                ("pcm --chance 3", &|graph| {
                    judge::<posecut_pcm::stage::StageOptions>(graph, &["--chance", "3"]);
                }),
            ];
            for method in methods {
                bench(criterion, &graph, &format!("{kind}/{candidates}"), method);
            }
        }
    }
}

criterion_group!(speed, benches);
criterion_main!(speed);
