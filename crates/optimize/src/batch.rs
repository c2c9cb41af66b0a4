//! Batch optimisation: from a checked graph to its minimum.
//!
//! [`solve`] takes one connected part after the other and chooses the start. [`levenberg_marquardt`] makes Gauss-Newton
//! steps, damped after one fails (Madsen, Nielsen, Tingleff, "Methods for non-linear least squares problems", 2004, section
//! 3.2); [`dogleg`] is Powell's (ibid., section 3.3), [`simplified_newton`] steps with an older factor (Deuflhard, "Newton
//! methods for nonlinear problems", 2004, section 2.1.2), and [`graduated`] makes the cost less convex round by round (Yang,
//! Antonante, Tzoumas, Carlone, IEEE RA-L 5(2), 2020, equations 12 and 14).
//!
//! Depends on [`model`](crate::model), `normal_equations` and [`initialisation`](crate::initialisation), and on
//! [`certificate`](crate::certificate) where [`certify`](solve::certify) asks for one.

pub(crate) mod dogleg;
pub(crate) mod graduated;
pub(crate) mod levenberg_marquardt;
pub(crate) mod options;
pub(crate) mod outcome;
pub(crate) mod phases;
pub(crate) mod simplified_newton;
pub(crate) mod solution;
pub(crate) mod solve;
