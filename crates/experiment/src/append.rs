//! Files to which lines are appended.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use anyhow::Context as _;
use posecut_stage::close;
use serde::Serialize;

/// Appends a line of JSON. On failure the file is cut back, so that the next line does not follow half a line.
pub(crate) fn append(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be written", path.display());
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    let mut file = File::options().create(true).append(true).open(path).with_context(place)?;
    let length = file.metadata().with_context(place)?.len();
    if let Err(error) = file.write_all(&line) {
        // The writing error is reported; a further error here would add nothing.
        let _ = file.set_len(length);
        return Err(error).with_context(place);
    }
    close(file).with_context(place)
}
