//! Writing so that a file appears whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use flate2::{Compression, GzBuilder};
use tempfile::TempPath;

use crate::closing::{close, close_standard_output};
use crate::{Target, interrupt, standard_output};

/// Writes to a target: a file through a temporary neighbour that takes its name at the end, standard output
/// or a device directly.
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

/// Writes a file; a name ending in `.gz` is compressed. On any failure the old file, if there was one,
/// stays as it was and no new one is left.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be written, and nothing was left there", path.display());
    // A link keeps pointing where it pointed; a device or pipe cannot be replaced by a file.
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
        bail!(
            "{}: there is no folder {} to write it in; make the folder first",
            path.display(),
            folder.display()
        );
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

/// Gives a temporary file its name.
fn take_name(temporary: TempPath, name: &Path) -> io::Result<()> {
    // By the standard library, whose calls tests can make fail.
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
        // No name and no time in the gzip header: the same content gives the same bytes.
        let mut encoder = GzBuilder::new().write(writer, Compression::default());
        write(&mut encoder)?;
        writer = encoder.finish()?;
    } else {
        write(&mut writer)?;
    }
    writer.flush()?;
    writer.into_inner().map_err(|error| error.into_error().into())
}
