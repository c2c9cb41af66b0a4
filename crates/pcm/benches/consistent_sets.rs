//! Pairs and cliques of random scenarios.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use posecut_geometry::{SE2, SE3};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::clique::{Limits, maximum_clique};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::{Gate, Spatial, Test};

fn scenario(candidates: usize, outliers: f64, falsehood: Falsehood) -> Scenario {
    Scenario { candidates, outliers, falsehood, seed: 1 }
}

fn run<G: Spatial<DOF>, const DOF: usize>(criterion: &mut Criterion, name: &str, scenario: &Scenario) {
    let graph = scenario.draw::<G, DOF>();
    let chains = Chains::<G, DOF>::of(&graph).expect("a drawn scenario has invertible information matrices");
    let grouped = group(&graph, &chains).expect("a drawn scenario has invertible information matrices");
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let gate = Gate::new(Test::Mahalanobis, 0.99, DOF).expect("0.99 is a probability");
    let label = format!("{}, {:.0} %", scenario.candidates, 100.0 * scenario.outliers);
    let mut bench = criterion.benchmark_group(name);
    bench.sample_size(10);
    bench.bench_function(BenchmarkId::new("pairs", &label), |bencher| bencher.iter(|| pairs.graph(gate)));
    let (consistency, _) = pairs.graph(gate);
    bench.bench_function(BenchmarkId::new("clique", &label), |bencher| {
        bencher.iter(|| maximum_clique(&consistency, Limits::NONE));
    });
    bench.finish();
}

fn benches(criterion: &mut Criterion) {
    for outliers in [0.1, 0.5, 0.9] {
        run::<SE2, 3>(criterion, "plane, uniform", &scenario(1000, outliers, Falsehood::Uniform));
        run::<SE2, 3>(criterion, "plane, grouped", &scenario(1000, outliers, Falsehood::Grouped));
        run::<SE3, 6>(criterion, "space, uniform", &scenario(1000, outliers, Falsehood::Uniform));
    }
}

criterion_group!(consistent_sets, benches);
criterion_main!(consistent_sets);
