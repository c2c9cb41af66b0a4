//! Descent from a start: the steps that minimise a cost over poses, for one connected component.
//!
//! [`levenberg_marquardt`] takes Gauss-Newton steps, damped after one fails (Madsen, Nielsen, Tingleff, "Methods for
//! non-linear least squares problems", 2004, section 3.2), with [`damping`] by Nielsen's rule. [`dogleg`] is Powell's (ibid.,
//! section 3.3). [`simplified_newton`] takes steps with an older factor (Deuflhard, "Newton methods for nonlinear problems",
//! 2004, section 2.1.2), [`conjugate_step`] others with it by conjugate gradients. [`acceleration`] corrects a step that fails
//! to second order (Transtrum, Sethna, 2012). [`pace`] tells when [`newton`]'s steps are worth their time. All use the operations of [`workspace`] and end with an [`outcome`].
//!
//! Depends on [`model`](crate::model) and `normal_equations`.

mod acceleration;
mod conjugate_step;
mod contest;
mod damping;
mod dogleg;
mod levenberg_marquardt;
mod newton;
pub(crate) mod outcome;
mod pace;
pub(crate) mod phases;
mod simplified_newton;
mod stiff_tree;
pub(crate) mod truncation;
pub(crate) mod workspace;

use crate::model::lanes::LaneGroup;
use crate::model::term::Term;
use crate::options::{Method, Options};
use damping::LARGEST_DAMPING;
use outcome::Outcome;
use workspace::Workspace;

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises the cost of the edges over all poses that are not held.
    pub(crate) fn minimise<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        match options.method {
            Method::Dogleg => self.minimise_by_dogleg(edges, poses, options),
            Method::LevenbergMarquardt => self.minimise_damped(edges, poses, options, LARGEST_DAMPING),
            Method::GaussNewton => self.minimise_damped(edges, poses, options, 0.0),
        }
    }
}
