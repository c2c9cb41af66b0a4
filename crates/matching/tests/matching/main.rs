//! Tests of matching on scans of simulated rooms.

mod correlative;
mod icp;
mod rooms;
