//! Files that grow by a line at a time.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use anyhow::Context as _;
use posecut_stage::close;
use serde::Serialize;

/// Appends a line of JSON. Where that fails, no part of the line is left for the next one to follow on.
pub(crate) fn append(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be written", path.display());
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    let mut file = File::options().create(true).append(true).open(path).with_context(place)?;
    let length = file.metadata().with_context(place)?.len();
    if let Err(error) = file.write_all(&line) {
        // The error that is reported is the one that matters.
        let _ = file.set_len(length);
        return Err(error).with_context(place);
    }
    close(file).with_context(place)
}
