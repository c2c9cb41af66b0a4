//! The registry of programs: those beside the running program, those built into it, and those on the PATH.
//!
//! A program beside this one, or built into it, describes itself (`--generate description`), so a new stage appears here once it
//! is built. A program elsewhere on the PATH may be anybody's. As with git and cargo, it is found by its name alone and never run
//! just to list it.

use std::collections::BTreeMap;
use std::env::consts::EXE_SUFFIX;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use crate::Description;

/// The prefix of program names.
const PREFIX: &str = "posecut-";

/// The names of the programs that are built into the running one.
static BUILT_IN: OnceLock<Vec<&'static str>> = OnceLock::new();

/// Declares the programs that the running one starts by `NAME` as its first argument. Only the first call has an effect.
pub fn set_built_in(names: Vec<&'static str>) {
    let _ = BUILT_IN.set(names);
}

/// A program that `posecut NAME` runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// The name without `posecut-`.
    pub name: String,
    /// The path of the program, or of the one that it is built into.
    pub path: PathBuf,
    /// Whether it is built into the program at the path, which then starts it by its name.
    pub built_in: bool,
}

/// Where programs are looked for. Nothing is listed until somebody asks for a list: `posecut NAME` looks for one file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Registry {
    beside: Option<PathBuf>,
    /// The running program and the names of those built into it.
    built_in: Option<(PathBuf, Vec<&'static str>)>,
    path: Vec<PathBuf>,
}

impl Registry {
    /// The programs in the folder of the running program, those built into it, and those on the PATH with other names.
    pub fn of_this_machine() -> Self {
        let running = std::env::current_exe().ok();
        let beside = running.as_deref().and_then(Path::parent);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let built_in = running.clone().zip(BUILT_IN.get().cloned());
        Self { built_in, ..Self::of(beside, std::env::split_paths(&path)) }
    }

    /// The programs of any folders. Of two programs with the same name, the first is taken, as in a shell.
    pub fn of(beside: Option<&Path>, path: impl Iterator<Item = PathBuf>) -> Self {
        Self { beside: beside.map(Path::to_owned), built_in: None, path: path.collect() }
    }

    /// A program by its name.
    pub fn get(&self, name: &str) -> Option<Program> {
        if !is_name(name) {
            return None;
        }
        let beside = self.beside.iter().find_map(|folder| program_in(folder, name));
        let built_in = || self.built_in().find(|program| program.name == name);
        beside.or_else(built_in).or_else(|| self.path.iter().find_map(|folder| program_in(folder, name)))
    }

    /// The programs beside this one and those built into it, in order of their names.
    pub fn beside(&self) -> Vec<Program> {
        let built_in = self.built_in().map(|program| (program.name.clone(), program));
        let beside = self.beside.iter().flat_map(|folder| programs_in(folder));
        built_in.chain(beside).collect::<BTreeMap<_, _>>().into_values().collect()
    }

    /// The programs on the PATH, in order of their names.
    pub fn elsewhere(&self) -> Vec<Program> {
        let mut found = BTreeMap::new();
        for (name, program) in self.path.iter().flat_map(|folder| programs_in(folder)) {
            found.entry(name).or_insert(program);
        }
        for program in self.beside() {
            found.remove(&program.name);
        }
        found.into_values().collect()
    }

    /// The known name that is most similar to this one, if any is similar enough.
    pub fn nearest(&self, name: &str) -> Option<String> {
        let likeness = |known: &String| strsim::jaro(name, known);
        let programs = self.beside().into_iter().chain(self.elsewhere()).map(|program| program.name);
        let known = programs.chain(["help", "version"].map(str::to_owned));
        known
            .filter(|known| likeness(known) > 0.7)
            .max_by(|one, other| likeness(one).total_cmp(&likeness(other)))
    }

    fn built_in(&self) -> impl Iterator<Item = Program> {
        self.built_in.iter().flat_map(|(path, names)| {
            names.iter().map(|name| Program { name: (*name).to_owned(), path: path.clone(), built_in: true })
        })
    }
}

impl Program {
    /// The command that runs the program, without arguments of its own.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        if self.built_in {
            command.arg(&self.name);
        }
        command
    }

    /// The program's description of itself; `None` if it gives none.
    pub fn description(&self) -> Option<Description> {
        serde_json::from_str(&self.answer(&["--generate", "description"])?).ok()
    }

    /// The first line of its `--version`; `None` if it has none.
    pub fn version(&self) -> Option<String> {
        self.answer(&["--version"])?.lines().next().map(str::to_owned)
    }

    fn answer(&self, arguments: &[&str]) -> Option<String> {
        let output = self.command().args(arguments).stdin(Stdio::null()).output().ok()?;
        if output.status.success() { String::from_utf8(output.stdout).ok() } else { None }
    }
}

/// The program of a name in a folder.
fn program_in(folder: &Path, name: &str) -> Option<Program> {
    let path = folder.join(format!("{PREFIX}{name}{EXE_SUFFIX}"));
    is_program(&path).then(|| Program { name: name.to_owned(), path, built_in: false })
}

/// The programs of a folder by name; none if it cannot be read.
fn programs_in(folder: &Path) -> Vec<(String, Program)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let programs = entries.filter_map(|entry| {
        let file = entry.file_name().into_string().ok()?;
        let name = file.strip_prefix(PREFIX)?.strip_suffix(EXE_SUFFIX)?;
        let program = is_name(name).then(|| program_in(folder, name))??;
        Some((name.to_owned(), program))
    });
    programs.collect()
}

/// Whether a file name can be that of a stage. Cargo leaves `posecut-pcm.d` beside `posecut-pcm`.
fn is_name(name: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    !name.is_empty() && name.bytes().all(plain)
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    path.metadata().is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    path.is_file()
}
