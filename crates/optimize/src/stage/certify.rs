//! The certificates in the stage's statistics.

use posecut_stage::{Context, Doubt, counted, info};

use crate::{
    Certificate, ComponentReport, Initialisation, Options, PoseGroup, Problem, Solution, certify_and_refine,
    optimize,
};

/// Costs that differ by a smaller share are equal.
const SAME_COST: f64 = 1e-9;

/// The certificates, and what a descent from the poses they are for has found.
pub(super) struct Certified {
    certificates: Vec<Certificate>,
    /// The cost at the end of that descent, if there are no held nodes.
    descended: Option<f64>,
    /// The cost of the solution before.
    before: f64,
}

/// Certifies SE-Sync's cost next to the solution. Then descends from the poses certified, and takes the result if it costs less
/// than the solution: with much noise in the rotations, the two costs have their minima in different basins.
pub(super) fn certify_or_improve<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    solution: &mut Solution<G>,
    options: &Options,
) -> Certified {
    let before = solution.cost;
    let (certificates, refined) = certify_and_refine(problem, &solution.poses);
    if !problem.held().is_empty() || !problem.priors().is_empty() {
        return Certified { certificates, descended: None, before };
    }
    let options = Options { initialisation: Initialisation::Given, ..*options };
    let descended = optimize(&Problem::from_checked(refined, problem.edges().to_vec(), Vec::new()), &options);
    let cost = Some(descended.cost);
    if descended.cost < before * (1.0 - SAME_COST) {
        *solution = descended;
    }
    Certified { certificates, descended: cost, before }
}

/// Notes the verdict on the whole graph and the figures of its least certain component. A component without edges, a single
/// node, counts as global.
pub(super) fn note(certified: &Certified, parts: &[ComponentReport], context: &mut Context) {
    let Certified { certificates, descended, before } = certified;
    if let Some(descended) = descended.filter(|descended| *descended < before * (1.0 - SAME_COST)) {
        info!("a descent from the minimum of SE-Sync's cost lowers the cost from {before} to {descended}");
    }
    let constrained = parts.iter().filter(|part| part.held > 1).count();
    let with_priors = parts.iter().filter(|part| part.priors > 0).count();
    // The certificate speaks for the solution only if the descent from the poses it is for does not end above it.
    let elsewhere = descended.is_some_and(|descended| descended > before * (1.0 + SAME_COST));
    let global = !elsewhere && certificates.iter().all(|certificate| certificate.global);
    let verdict = if global { "global" } else { "not certified" };
    let certified = certificates.iter().filter(|certificate| certificate.global).count();
    if !global {
        let remedy = if elsewhere {
            "the minimum of SE-Sync's cost lies in another basin, where the cost of this solution is higher, so the certificate says \
             nothing about this solution"
                .to_owned()
        } else if constrained > 0 {
            format!(
                "it does not apply to {} with more than one fixed node, because it covers edges only; certify without fixed nodes",
                counted(constrained, "component")
            )
        } else if with_priors > 0 {
            format!(
                "it does not apply to {} with priors, because it covers edges only; certify without priors",
                counted(with_priors, "component")
            )
        } else {
            "a lower minimum may exist, so start elsewhere (--initialisation) and check the landmark edges"
                .to_owned()
        };
        context.doubt(
            Doubt::NotCertified,
            format!(
                "the certificate of a global minimum of SE-Sync's cost holds for {certified} of {}: {remedy}",
                counted(certificates.len(), "component")
            ),
        );
    }
    let statistics = &mut context.statistics;
    statistics.note("certificate", verdict);
    statistics.note("certified_parts", certified);
    statistics.note("chordal_cost", certificates.iter().map(|certificate| certificate.cost).sum::<f64>());
    statistics.note(
        "chordal_lower_bound",
        certificates.iter().map(|certificate| certificate.lower_bound).sum::<f64>(),
    );
    let margin = |certificate: &&Certificate| certificate.eigenvalue + certificate.tolerance;
    let worst = certificates.iter().min_by(|a, b| margin(a).total_cmp(&margin(b)));
    statistics.note("certificate_eigenvalue", worst.map(|certificate| certificate.eigenvalue));
    statistics.note("certificate_tolerance", worst.map(|certificate| certificate.tolerance));
    info!("certificate of SE-Sync's cost next to the solution: {verdict}");
}
