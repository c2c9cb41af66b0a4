//! Options of earlier versions that now belong to another program.

use anyhow::bail;

/// What is `posecut-partition` now. Hidden from help; either is an error that says so.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(crate) struct MovedOptions {
    #[arg(long, hide = true, value_name = "FORMAT")]
    format: Option<String>,

    #[arg(long, hide = true, value_name = "CERTIFICATE")]
    verify: Option<String>,
}

impl MovedOptions {
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        if let Some(certificate) = &self.verify {
            bail!(
                "--verify is no longer an option of posecut-multicut: a separate program checks certificates; run posecut-partition \
                 verify {certificate} INPUT, with --delta, --costs, --graph and --odometry-cost as before"
            );
        }
        if self.format.is_some() {
            bail!(
                "--format is no longer an option of posecut-multicut, which reads pose graphs; leave it out, or for a signed graph (mc) run \
                 posecut-partition solve INSTANCE"
            );
        }
        Ok(())
    }
}
