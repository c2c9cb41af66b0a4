//! Minimum-cost multicuts of plain signed graphs, and checks of certificates, as a program. The algorithms are in
//! `posecut-multicut`.

pub mod cli;
