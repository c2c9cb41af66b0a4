//! The tests of incremental optimisation, in one program.

#[path = "../../../optimize/tests/g2o/best_known.rs"]
mod best_known;
#[path = "../../../optimize/tests/changes/mod.rs"]
mod changes;
#[path = "../../../optimize/tests/g2o/mod.rs"]
mod g2o;
#[path = "../growing/mod.rs"]
mod growing;
#[path = "../../../optimize/tests/noisy_walk/mod.rs"]
mod noisy_walk;
#[path = "../replay/mod.rs"]
mod replay;

mod canonical;
mod held;
mod ill_conditioned;
mod incremental;
mod incremental_benchmarks;
mod lag;
mod lag_stage;
mod lagged;
mod marginalise;
mod metamorphic;
mod scale;
mod stage;
