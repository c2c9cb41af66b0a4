//! The certificates in the stage's statistics.

use posecut_stage::{Context, Doubt, counted, info};

use crate::{Certificate, ComponentReport};

/// Notes the verdict on the whole graph and the figures of its least certain component. A component without edges, a single
/// node, counts as global.
pub(super) fn note(certificates: &[Certificate], parts: &[ComponentReport], context: &mut Context) {
    let constrained = parts.iter().filter(|part| part.held > 1).count();
    let global = certificates.iter().all(|certificate| certificate.global);
    let verdict = if global { "global" } else { "not certified" };
    let certified = certificates.iter().filter(|certificate| certificate.global).count();
    if !global {
        let remedy = if constrained > 0 {
            format!(
                "it does not apply to {} with more than one fixed node, because it covers edges only; certify without fixed nodes",
                counted(constrained, "component")
            )
        } else {
            "a lower minimum may exist, so start elsewhere (--initialisation) and check the landmark edges"
                .to_owned()
        };
        context.doubt(
            Doubt::NotCertified,
            format!(
                "the certificate of a global minimum holds for {certified} of {}: {remedy}",
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
    info!("certificate of the chordal cost after refinement: {verdict}");
}
