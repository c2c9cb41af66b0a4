//! The files that a command line names, to find outputs that would overwrite another of them.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{ArgMatches, Command};

/// The value name of options that take a file.
const FILE: &str = "FILE";

/// All files on a command line, each with the words by which messages refer to it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(String, PathBuf)>);

impl Given {
    /// The values of positional arguments and of options that take a `FILE`, including defaults. In a value `NAME=FILE`, the part
    /// after `=` counts too.
    pub(crate) fn of(command: &Command, matches: &ArgMatches) -> Self {
        let mut given = Self::default();
        given.collect(command, matches);
        given
    }

    fn collect(&mut self, command: &Command, matches: &ArgMatches) {
        for argument in command.get_arguments().filter(|argument| argument.get_action().takes_values()) {
            let Some(name) = argument.get_value_names().and_then(|names| names.first()) else { continue };
            // Skip other options: their numbers and words may look like file names.
            let what = match argument.get_long() {
                Some(long) if name == FILE => format!("for --{long}"),
                None => format!("as {name}"),
                Some(_) => continue,
            };
            let Ok(Some(values)) = matches.try_get_raw(argument.get_id().as_str()) else { continue };
            for value in values.filter(|value| *value != OsStr::new("-")) {
                let file = value.to_str().and_then(|value| value.split_once('=')).map(|(_, file)| file);
                let files = [Some(value), file.map(OsStr::new)].into_iter().flatten();
                self.0.extend(files.map(|path| (what.clone(), path.into())));
            }
        }
        if let Some((name, matches)) = matches.subcommand()
            && let Some(command) = command.find_subcommand(name)
        {
            self.collect(command, matches);
        }
    }

    /// The words for another argument that names the same file as `option`, if there is one.
    pub(crate) fn other(&self, option: &str, path: &Path) -> Option<&str> {
        let own = format!("for {option}");
        let named = self.0.iter().find(|(what, other)| *what != own && overwrites(path, other));
        let standard = [("as standard input", "/dev/stdin"), ("as standard output", "/dev/stdout")];
        named.map(|(what, _)| what.as_str()).or_else(|| {
            standard.into_iter().find(|(_, device)| overwrites(path, Path::new(device))).map(|(what, _)| what)
        })
    }
}

/// Whether writing to `path` replaces the content of `other`, because both are or become one file.
pub(crate) fn overwrites(path: &Path, other: &Path) -> bool {
    !is_device(other) && same_file(path, other)
}

/// Whether two paths lead to the same file, through links of any kind. If the file does not exist yet: whether they lead to the
/// same name in the same folder.
pub(crate) fn same_file(first: &Path, second: &Path) -> bool {
    if first == second {
        return true;
    }
    match (fs::metadata(first), fs::metadata(second)) {
        #[cfg(unix)]
        (Ok(first), Ok(second)) => {
            use std::os::unix::fs::MetadataExt as _;
            (first.dev(), first.ino()) == (second.dev(), second.ino())
        }
        _ => real(first).is_some_and(|first| Some(first) == real(second)),
    }
}

fn real(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::canonicalize(path).ok().or_else(|| Some(fs::canonicalize(folder).ok()?.join(path.file_name()?)))
}

fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file())
}
