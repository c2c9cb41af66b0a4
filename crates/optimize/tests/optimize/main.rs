//! The tests of optimisation, in one program.

#[path = "../g2o/best_known.rs"]
mod best_known;
#[path = "../changes/mod.rs"]
mod changes;
#[path = "../g2o/mod.rs"]
mod g2o;
#[path = "../noisy_walk/mod.rs"]
mod noisy_walk;
#[path = "../worlds/mod.rs"]
mod worlds;

mod benchmark_graphs;
mod certificate;
mod false_closures;
mod graduation;
mod held;
mod ill_posed;
mod long_routes;
mod marginals;
mod metamorphic;
mod near_starts;
mod noisy_rotations;
mod priors;
mod scale;
mod several_projections;
mod slow_descents;
mod solutions;
mod stage;
