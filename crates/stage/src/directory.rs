//! Writing a directory so that it appears completely or not at all.

use std::fs;
use std::io;
use std::path::Path;

use anyhow::{Context as _, bail};

use crate::interrupt;

/// Fills a temporary directory beside `path` and renames it at the end. A directory that exists and is not empty is refused,
/// or replaced with `overwrite`; one with a file whose name is not `ours` is always refused.
/// Every error of `fill` is reported as a writing error, so check everything else before.
pub fn write_directory<T>(
    path: &Path,
    overwrite: bool,
    ours: impl Fn(&str) -> bool,
    fill: impl FnOnce(&Path) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let place = || format!("{}: cannot be written, and no partial output remains", path.display());
    let occupied = fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
    if path.is_file() || (occupied && !overwrite) {
        bail!("{}: already exists; name another directory, or use --overwrite", path.display());
    }
    if occupied && let Some(foreign) = foreign(path, ours).with_context(place)? {
        bail!(
            "{}: contains \"{foreign}\", which this program does not write, so it is not replaced; name another directory, or move \"{foreign}\" elsewhere",
            path.display()
        );
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).with_context(place)?;
    let neighbour = || tempfile::Builder::new().prefix(".posecut-").suffix(".tmp").tempdir_in(parent);
    let (guard, temporary) = interrupt::create(neighbour).with_context(place)?;
    let result = fill(temporary.path()).with_context(place)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        fs::set_permissions(temporary.path(), fs::Permissions::from_mode(0o755)).with_context(place)?;
    }
    // Rename the old directory before deleting it: a deletion takes time and would show half a directory meanwhile.
    let (aside_guard, aside) = interrupt::create(neighbour).with_context(place)?;
    interrupt::uninterrupted(|| {
        let old = aside.path().join("old");
        let stepped_aside = path.exists();
        if stepped_aside {
            fs::rename(path, &old)?;
        }
        fs::rename(temporary.path(), path).inspect_err(|_| {
            if stepped_aside {
                // The error of the first renaming is reported; one of undoing it is not.
                let _ = fs::rename(&old, path);
            }
        })
    })
    .with_context(place)?;
    // The directory has its final name now and is no longer temporary.
    let _ = temporary.keep();
    drop(guard);
    let leftover = aside.path().display().to_string();
    aside.close().with_context(|| {
        format!(
            "{}: is written, but the directory that it replaces cannot be deleted; delete {leftover}",
            path.display()
        )
    })?;
    drop(aside_guard);
    Ok(result)
}

/// The first name in a directory that is not `ours`.
fn foreign(path: &Path, ours: impl Fn(&str) -> bool) -> io::Result<Option<String>> {
    let mut names: Vec<String> = fs::read_dir(path)?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<io::Result<_>>()?;
    names.retain(|name| !ours(name));
    Ok(names.into_iter().min())
}
