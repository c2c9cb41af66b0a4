//! Lower bounds: packings of conflicted cycles and odd wheels, and the linear program that is dual to packing.
//!
//! An edge is paid `y` if it attracts, and `1 - y` if it repels. The cycle relaxation minimises `c^+ y + |c^-| (1 - y)`
//! subject to
//!
//! - cycle inequalities (Chopra, Rao 1993): `y(P) + (1 - y_f) >= 1` for each repulsive edge `f` and each attractive path
//!   `P` between its ends. Other cycles do not change the optimum (Lange, Karrenbauer, Andres, ICML 2018);
//!   [`cycle_separation`] finds violated ones by shortest paths.
//! - odd wheel inequalities (Chopra, Rao 1993): a closed walk with an odd number `k` of repulsive edges and its spokes
//!   are paid `(k + 1) / 2` or more. [`conflict`] proves it; [`odd_wheel_separation`] finds violated ones by
//!   shortest walks of odd parity (after Deza, Groetschel, Laurent 1992).
//! - 2-partition inequalities (Groetschel, Wakabayashi 1990) of two sets of nodes that attract each other and repel inside:
//!   [`conflict`] proves them, [`parts_separation`] finds violated ones greedily.
//!
//! [`dual_simplex`] solves small programs again and again, as branch and cut adds inequalities ([`cut`]; [`hard_cycles`] finds
//! cycles where edges are fixed) and fixes edges. [`interior_point`] solves large ones (Mehrotra, SIAM J. Optimization 2(4),
//! 1992). Every dual point packs these conflicts into the capacities `|c|`, and therefore is a lower bound. [`packing`] also
//! builds a packing greedily (Lange, Karrenbauer, Andres, ICML 2018, algorithm 1), and [`rerouting`] improves one towards a
//! proof that a given multicut is optimal, by negotiated congestion ([`negotiation`]); [`spreading`] finds such packings in dense graphs, and
//! [`windows`] improves a packing part by part.
//!
//! Depends on [`graph`](crate::graph).

pub(crate) mod clique_matrix;
pub(crate) mod conflict;
pub(crate) mod cut;
pub(crate) mod cycle_separation;
pub(crate) mod dual_simplex;
pub(crate) mod hard_cycles;
pub(crate) mod interior_point;
pub(crate) mod landmark_distances;
pub(crate) mod negotiation;
pub(crate) mod odd_wheel_separation;
pub(crate) mod packing;
pub(crate) mod parts_separation;
pub(crate) mod relaxation;
pub(crate) mod rerouting;
pub(crate) mod spreading;
pub(crate) mod windows;
