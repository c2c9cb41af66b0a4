//! Writing a file so that it appears completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use flate2::{Compression, GzBuilder};
use tempfile::TempPath;

use crate::closing::{close, close_standard_output};
use crate::{Target, interrupt, standard_output};

/// Writes to a target. A file is written under a temporary name beside its path and renamed at the end; standard output and
/// devices are written directly.
pub fn write_output(
    target: &Target,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    match target {
        Target::Standard => {
            let place = "standard output: cannot be written";
            standard_output::check().context(place)?;
            let mut writer = BufWriter::new(io::stdout().lock());
            write(&mut writer).context(place)?;
            writer.flush().and_then(|()| close_standard_output()).context(place)
        }
        Target::File(path) => write_atomically(path, write),
    }
}

/// Writes a file, compressed if its name ends in `.gz`. On any failure an old file does not change, and no new file remains.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be written, and no partial output remains", path.display());
    // Follow a link, so that it keeps its target. Write to a device or pipe directly: a file cannot replace it.
    let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&real).is_ok_and(|metadata| !metadata.is_file()) {
        let device = || format!("{}: cannot be written", path.display());
        let file = File::options().write(true).open(&real).with_context(device)?;
        return fill(file, false, write).and_then(|file| Ok(close(file)?)).with_context(device);
    }
    let folder = match real.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    if !folder.is_dir() {
        bail!("{}: the folder {} does not exist; create it first", path.display(), folder.display());
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".posecut-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let (guard, temporary) = interrupt::create(|| builder.tempfile_in(&folder)).with_context(place)?;
    let compress = path.extension().is_some_and(|extension| extension == "gz");
    let (file, temporary) = fill(temporary, compress, write).with_context(place)?.into_parts();
    close(file).with_context(place)?;
    take_name(temporary, &real).with_context(place)?;
    drop(guard);
    Ok(())
}

/// Renames a temporary file to its final name.
fn take_name(temporary: TempPath, name: &Path) -> io::Result<()> {
    // Rename by the standard library, because tests can make its calls fail.
    #[cfg(unix)]
    {
        let mut temporary = temporary;
        fs::rename(&temporary, name)?;
        temporary.disable_cleanup(true);
        Ok(())
    }
    #[cfg(not(unix))]
    temporary.persist(name).map_err(|error| error.error)
}

fn fill<W: Write>(
    file: W,
    compress: bool,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<W> {
    let mut writer = BufWriter::with_capacity(1 << 17, file);
    if compress {
        // Keep name and time out of the gzip header, so that the same content gives the same bytes.
        let mut encoder = GzBuilder::new().write(writer, Compression::default());
        write(&mut encoder)?;
        writer = encoder.finish()?;
    } else {
        write(&mut writer)?;
    }
    writer.flush()?;
    writer.into_inner().map_err(|error| error.into_error().into())
}
