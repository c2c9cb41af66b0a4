//! Hostile experiments: mutated declarations, folders with stale and foreign files. None may make the runner panic, write
//! outside its folders or print more than one sentence. The same seed gives the same experiments on every machine.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::workshop::Workshop;
use posecut_stage::rand::RngExt as _;
use posecut_stage::{ChaCha8Rng, random};

/// The number of experiments: some seconds in total.
const COUNT: u64 = 150;

/// A small valid declaration.
const SOUND: &str = r#"
sessions = ["one"]
simulated_sessions = ["one"]
seeds = 1
methods = ["pcm"]

[stages]
pcm = "--gate {gate}"

[method]
none = []
pcm = ["pcm"]
oracle = ["oracle"]

[parameters]
gate = 1

[[grid]]
gate = [1, 2]
"#;

/// Hostile values for a declaration.
const VALUES: &[&str] = &[
    "\"../../../escaped\"",
    "\"../../../../escaped\"",
    "\"/tmp/posecut-escaped\"",
    "\"..\"",
    "\".\"",
    "\"\"",
    "\"-rf\"",
    "\"a/b\"",
    "\"a b\"",
    "\"$(touch escaped)\"",
    "\"a\\nb\"",
    "\"\\u0000\"",
    "\"{gate}\"",
    "\"{\"",
    "\"}{\"",
    "\"[\"",
    "\"*\"",
    "\"one+one\"",
    "\"one+../x\"",
    "\"+\"",
    "\"éclair\"",
    "0",
    "-1",
    "1",
    "18446744073709551615",
    "9223372036854775807",
    "1e308",
    "nan",
    "inf",
    "true",
    "[]",
    "[[]]",
    "{}",
    "1979-05-27",
    "[\"one\", \"two\"]",
    "[\"../x\"]",
    "[\"pcm\", \"pcm\"]",
    "[\"none\", \"oracle\"]",
    "[1, 1]",
];

/// Keys at the head of a declaration.
const KEYS: &[&str] = &[
    "name",
    "base",
    "sessions",
    "simulated_sessions",
    "seeds",
    "methods",
    "reference",
    "keep",
    "source",
    "family",
    "halves",
    "cpu_limit",
    "graphs",
    "about",
    "unknown",
];

/// Tables at the end of a declaration.
const TABLES: &[&str] = &[
    "[[grid]]\n\"../x\" = [1]\n",
    "[[grid]]\ngate = VALUE\n",
    "[[grid]]\nmethods = VALUE\n",
    "[[grid]]\nsessions = VALUE\nseeds = VALUE\n",
    "[[grid]]\nexcept = VALUE\n",
    "[method.x]\n",
    "[derived]\nd = { of = \"gate\", factor = VALUE, power = VALUE }\n",
    "[derived]\nd = { of = VALUE }\n",
    "[halves]\ntuning = VALUE\ntest = VALUE\n",
    "[halves]\ntuning_seeds = VALUE\ntest_seeds = VALUE\ndependent = VALUE\n",
    "[[graphs]]\nfiles = VALUE\nname = VALUE\nlabel = \"{folder}\"\n",
    "[[graphs]]\nfiles = \"*.g2o\"\nname = VALUE\ncluster = VALUE\n",
    "[[drawn]]\nname = VALUE\noptions = VALUE\n",
];

/// Paths of a run's files.
const PLACES: &[&str] = &[
    "results",
    "results/trial-simulated",
    "results/trial-simulated/one",
    "results/trial-simulated/one/1",
    "results/trial-simulated/one/session.jsonl",
    "results/trial-simulated/one.tasks.jsonl",
    "results/trial-simulated/one.times.jsonl",
    "results/trial-simulated/one/1.tasks.jsonl",
    "results/trial-simulated/one/1.times.jsonl",
    "results/trial-simulated/one/1/gate=1/pcm.jsonl",
    "results/trial-simulated/one/1/gate=1/pcm.result.json",
    "results/trial-simulated/one/1/graph.jsonl",
    "simulated",
    "simulated/one",
    "simulated/.one.lock",
    "simulated/one.tasks.jsonl",
];

fn pick<'a, T: ?Sized>(random: &mut ChaCha8Rng, all: &[&'a T]) -> &'a T {
    all[random.random_range(0..all.len())]
}

/// A declaration: valid, with hostile values, or with some bytes changed.
fn declaration(random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut text = SOUND.to_owned();
    for _ in 0..random.random_range(0..2) {
        let (key, value) = (pick(random, KEYS), pick(random, VALUES));
        // Remove the old key first: a duplicate key would only test the TOML library.
        let rest: Vec<&str> = text.lines().filter(|line| !line.starts_with(&format!("{key} ="))).collect();
        text = format!("{key} = {value}\n{}\n", rest.join("\n"));
    }
    for _ in 0..random.random_range(0..2) {
        let mut table = pick(random, TABLES).to_owned();
        while table.contains("VALUE") {
            table = table.replacen("VALUE", pick(random, VALUES), 1);
        }
        text.push_str(&table);
    }
    let mut bytes = text.into_bytes();
    if random.random_range(0..8) == 0 {
        for _ in 0..random.random_range(1..4) {
            let place = random.random_range(0..bytes.len());
            bytes[place] = random.random_range(0..=255);
        }
    }
    bytes
}

/// Puts something where the run needs a file or folder.
fn occupy(random: &mut ChaCha8Rng, workshop: &Workshop, outside: &Path) {
    let path = workshop.path(pick(random, PLACES));
    // Give up if something from an earlier call is in the way.
    if fs::create_dir_all(path.parent().unwrap()).is_err() || path.is_symlink() {
        return;
    }
    let _ = match random.random_range(0..6) {
        0 => fs::create_dir_all(path.join("foreign")),
        1 => fs::write(&path, "foreign\n"),
        2 => fs::write(&path, [0xff, 0x00, b'{', b'\n', 0xfe]),
        3 => std::os::unix::fs::symlink(outside, &path),
        4 => std::os::unix::fs::symlink(outside.join("precious"), &path),
        _ => std::os::unix::fs::symlink("nowhere/at/all", &path),
    };
}

/// Everything below a folder except the workshop, with the content of files.
fn listing(folder: &Path, workshop: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path == workshop {
                continue;
            }
            all.insert(path.clone(), fs::read(&path).unwrap_or_default());
            if path.is_dir() && !path.is_symlink() {
                folders.push(path);
            }
        }
    }
    all
}

#[test]
fn hostile_experiments_end_with_a_result_or_a_sentence() {
    let mut ends: BTreeMap<i32, u64> = BTreeMap::new();
    for number in 0..COUNT {
        let random = &mut random(number, "hostile experiments");
        let whole = tempfile::tempdir().unwrap();
        let parent = whole.path().join("a/b/c");
        let outside = whole.path().join("outside");
        fs::create_dir_all(&parent).unwrap();
        fs::create_dir_all(&outside).unwrap();
        fs::write(outside.join("precious"), "precious").unwrap();
        let workshop = Workshop::within(&parent, "");
        let declared = declaration(random);
        fs::write(workshop.path("trial.toml"), &declared).unwrap();
        workshop.write("mine.g2o", "VERTEX_SE2 0 0 0 0\n");
        for _ in 0..random.random_range(0..2) {
            occupy(random, &workshop, &outside);
        }
        let before = listing(whole.path(), &workshop.path(""));
        let task = pick(random, &["plan", "run", "run", "collect"]);
        let more: &[&str] = if random.random_range(0..2) == 0 { &["--data", "."] } else { &[] };
        let output = workshop.call(task, &[more, &["--threads", "2"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        let what = || format!("experiment {number}, {task}: {said}\n{}", String::from_utf8_lossy(&declared));
        let code = output.status.code().unwrap_or_else(|| panic!("a signal ended {}", what()));
        assert!((0..=2).contains(&code) && !said.contains("panicked"), "{code}: {}", what());
        if code == 2 {
            let lines: Vec<&str> = said.lines().filter(|line| !line.contains(": warning: ")).collect();
            // A run lists its failed tasks below its sentence.
            let (sentences, listed): (Vec<&str>, Vec<&str>) =
                lines.iter().partition(|line| !line.starts_with("  "));
            let errors =
                sentences.iter().filter(|line| line.starts_with("posecut-experiment: error: ")).count();
            assert_eq!(errors, 1, "{}", what());
            assert!(listed.is_empty() || said.contains("failed twice"), "{}", what());
        }
        assert_eq!(
            listing(whole.path(), &workshop.path("")),
            before,
            "something outside changed: {}",
            what()
        );
        let known = ["results", "simulated", "log", "mine.g2o", "stage.sh", "stages.toml", "trial.toml"];
        for entry in fs::read_dir(workshop.path("")).unwrap() {
            let name = entry.unwrap().file_name().to_string_lossy().into_owned();
            assert!(known.contains(&name.as_str()), "{name} was made: {}", what());
        }
        *ends.entry(code).or_default() += 1;
    }
    assert!(!Path::new("/tmp/posecut-escaped").exists());
    let most = ends.values().max().copied().unwrap_or(0);
    assert!(ends.contains_key(&0) && most < COUNT * 9 / 10, "the experiments all end the same way: {ends:?}");
}
