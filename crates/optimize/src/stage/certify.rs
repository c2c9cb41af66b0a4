//! What the stage says about certificates.

use posecut_stage::{Statistics, counted, info, warn};

use crate::{Certificate, ComponentReport};

/// Notes the verdict on the whole graph and the figures of its least certain part. A part without edges, a lone node, is
/// global as it stands.
pub(super) fn note(certificates: &[Certificate], parts: &[ComponentReport], statistics: &mut Statistics) {
    let constrained = parts.iter().filter(|part| part.held > 1).count();
    if constrained > 0 {
        warn!(
            "the certificate does not apply to {} with more than one fixed node: it is about edges alone",
            counted(constrained, "part")
        );
    }
    let global = certificates.iter().all(|certificate| certificate.global);
    let verdict = if global { "global" } else { "not certified" };
    statistics.note("certificate", verdict);
    statistics.note("certified_parts", certificates.iter().filter(|certificate| certificate.global).count());
    statistics.note("chordal_cost", certificates.iter().map(|certificate| certificate.cost).sum::<f64>());
    statistics.note(
        "chordal_lower_bound",
        certificates.iter().map(|certificate| certificate.lower_bound).sum::<f64>(),
    );
    let margin = |certificate: &&Certificate| certificate.eigenvalue + certificate.tolerance;
    let worst = certificates.iter().min_by(|a, b| margin(a).total_cmp(&margin(b)));
    statistics.note("certificate_eigenvalue", worst.map(|certificate| certificate.eigenvalue));
    statistics.note("certificate_tolerance", worst.map(|certificate| certificate.tolerance));
    info!("{verdict}: the chordal cost after refinement, against its dual bound");
}
