//! Shared code of the contract tests: finding the programs, running them, and a small session as their input.

pub mod registry;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A program of this workspace, built by `make test` before the tests run.
///
/// # Panics
/// If it has not been built.
pub fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    let folder =
        test.parent().and_then(Path::parent).expect("tests lie in target/PROFILE/deps, examples beside");
    let path = folder.join(format!("posecut-{name}{}", std::env::consts::EXE_SUFFIX));
    assert!(path.is_file(), "{} is not built; run the tests with `make test`", path.display());
    path
}

/// Whether to run the long forms of tests with many similar cases (`POSECUT_LONG_TESTS=1`). The short forms check the same, on a
/// part of the cases.
pub fn long_tests() -> bool {
    std::env::var_os("POSECUT_LONG_TESTS").is_some_and(|value| value == "1")
}

/// Runs a program with standard input.
///
/// # Panics
/// If it cannot be started.
pub fn run(name: &str, arguments: &[&str], input: &[u8]) -> Output {
    use std::io::Write as _;
    let mut child = Command::new(program(name))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("stdin is piped");
    let bytes = input.to_vec();
    // Ignore the error: a program may refuse its input early and close the pipe.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&bytes)));
    let output = child.wait_with_output().expect("the program ends");
    writer.join().expect("the writer ends");
    output
}

/// Runs a program that must succeed, and returns its standard output.
///
/// # Panics
/// If its exit status is not 0.
pub fn succeed(name: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(name, arguments, input);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "posecut-{name} {arguments:?}: {said}");
    output.stdout
}

/// A directory of small input files for programs.
pub struct Samples {
    folder: tempfile::TempDir,
}

impl Samples {
    /// The path of a sample, as text.
    ///
    /// # Panics
    /// If the path is not UTF-8.
    pub fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("temporary paths are UTF-8").to_owned()
    }

    /// The content of a sample.
    ///
    /// # Panics
    /// If there is none of that name.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("the sample exists")
    }
}

/// Makes a session of this length in metres (`2012-01-22/`), its graph (`session.jsonl`), and the same with landmark edges, three in ten
/// of them incorrect (`graph.jsonl`).
///
/// # Panics
/// If a program fails, or the path is not UTF-8.
pub fn session_with_landmarks(folder: &Path, length: &str, seed: &str) {
    let path = |name: &str| folder.join(name).to_str().expect("temporary paths are UTF-8").to_owned();
    let (session, single, graph) = (path("2012-01-22"), path("session.jsonl"), path("graph.jsonl"));
    succeed("simulate", &["--length", length, "--rate", "5", "-o", &session], b"");
    let sigmas = ["--sigma-translation", "0.1", "--sigma-rotation", "0.02"];
    succeed("ingest", &[&[session.as_str(), "-o", &single][..], &sigmas].concat(), b"");
    let wrong = ["--incorrect-rate", "0.3", "--seed", seed];
    let edges = [&[single.as_str(), "--radius", "8", "--heading", "60", "-o", &graph][..], &wrong];
    succeed("construct", &edges.concat(), b"");
}

/// The samples, made once by the programs themselves: `2012-01-22/` (a session), `session.jsonl`, `graph.jsonl`,
/// `optimized.jsonl`, `marginals.jsonl`, `robot.log` (a log with laser scans), `scans.jsonl` (its graph), `x.result.json`, `four.mc` (a signed graph) and `four.proof`. `paper.toml` and
/// `stages.toml` come from `pipelines/`.
///
/// # Panics
/// If a program fails.
pub fn samples() -> &'static Samples {
    static SAMPLES: OnceLock<Samples> = OnceLock::new();
    SAMPLES.get_or_init(|| {
        let samples = Samples { folder: tempfile::tempdir().expect("a temporary directory") };
        let path = |name: &str| samples.path(name);
        // A short session, and a seed with whose graph the optimisers need no search: the tests run each program hundreds of times.
        session_with_landmarks(samples.folder.path(), "200", "3");
        let (graph, optimized) = (path("graph.jsonl"), path("optimized.jsonl"));
        succeed("optimize", &[&graph, "-o", &optimized], b"");
        succeed("optimize", &[&graph, "--marginals", "landmark", "-o", &path("marginals.jsonl")], b"");
        succeed("evaluate", &[&optimized, "--label", "method=all", "-o", &path("x.result.json")], b"");
        let log = path("robot.log");
        succeed("simulate-log", &["--length", "8", "-o", &log], b"");
        succeed("ingest", &[&log, "-o", &path("scans.jsonl")], b"");
        let instance = path("four.mc");
        std::fs::write(&instance, "MULTICUT\n0 1 2\n2 3 2\n1 2 0.5\n0 3 -1\n")
            .expect("a sample can be written");
        succeed("partition", &["solve", &instance, "--certificate", &path("four.proof")], b"");
        for name in ["paper.toml", "stages.toml"] {
            std::fs::copy(workspace().join("pipelines").join(name), path(name))
                .expect("pipelines/ can be copied");
        }
        samples
    })
}
