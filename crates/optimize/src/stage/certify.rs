//! What the stage says about certificates.

use posecut_stage::{Statistics, info};

use crate::Certificate;

/// Notes the verdict on the whole graph and the figures of its least certain part. A part without edges, a lone node, is
/// global as it stands.
pub(super) fn note(certificates: &[Certificate], statistics: &mut Statistics) {
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
