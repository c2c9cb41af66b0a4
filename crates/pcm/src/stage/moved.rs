//! Options of earlier versions that belong to another program now.

use anyhow::bail;

/// Re-admission, which is `posecut-readmit` now. Hidden from help; any of them is an error that says so.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(super) struct MovedOptions {
    #[arg(long, hide = true)]
    readmit: bool,

    #[arg(long, hide = true, value_name = "P")]
    admit: Option<String>,

    #[arg(long, hide = true, value_name = "P")]
    drop: Option<String>,

    #[arg(long, hide = true)]
    apply_scale: bool,
}

impl MovedOptions {
    pub(super) fn check(&self) -> anyhow::Result<()> {
        for (option, given) in [
            ("--readmit", self.readmit),
            ("--admit", self.admit.is_some()),
            ("--drop", self.drop.is_some()),
            ("--apply-scale", self.apply_scale),
        ] {
            if given {
                bail!(
                    "{option} is no longer an option of posecut-pcm: re-admission is a separate program now; run posecut-readmit GRAPH \
                     with --admit, --drop, --scale, --chance and --apply-scale as before, without --readmit"
                );
            }
        }
        Ok(())
    }
}
