//! The tests of optimisation, in one program.

#[path = "../g2o/best_known.rs"]
mod best_known;
#[path = "../g2o/mod.rs"]
mod g2o;
#[path = "../growing/mod.rs"]
mod growing;
#[path = "../noisy_walk/mod.rs"]
mod noisy_walk;
#[path = "../replay/mod.rs"]
mod replay;

mod benchmark_graphs;
mod certificate;
mod false_closures;
mod held;
mod ill_conditioned;
mod ill_posed;
mod incremental;
mod incremental_benchmarks;
mod incremental_stage;
mod marginals;
mod metamorphic;
mod scale;
mod solutions;
mod stage;
