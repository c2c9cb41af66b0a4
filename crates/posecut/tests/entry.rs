//! Tests that `posecut` finds programs, runs them as if called by their own names, and lists them. `built_in` has the tests of one
//! file alone.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;

use posecut_stage::registry::Registry;

#[path = "entry/built_in.rs"]
mod built_in;

/// A folder with a copy of `posecut` and with scripts instead of its programs, and another folder for the PATH.
struct Place {
    folder: tempfile::TempDir,
}

const DESCRIBED: &str = r#"#!/bin/sh
if [ "$1" = --generate ]; then
  echo '{"name":"NAME","version":"1.2","about":"Do NAME","phase":"PHASE","order":ORDER}'
elif [ "$1" = --version ]; then
  echo 'posecut-NAME 1.2'
else
  printf '%s|' "$@"; cat; exit 7
fi
"#;

/// Copies a program by another process. The system refuses to run a file that is open for writing, and a child that another
/// test starts meanwhile would inherit what this process has open.
fn install(program: &Path, target: &Path) {
    let status = Command::new("install").args(["-m", "755"]).args([program, target]).status().unwrap();
    assert!(status.success(), "{}", target.display());
}

static PLACE: LazyLock<Place> = LazyLock::new(|| {
    let place = Place { folder: tempfile::tempdir().unwrap() };
    std::fs::create_dir_all(place.folder.path().join("elsewhere")).unwrap();
    std::fs::create_dir(place.folder.path().join("posecut-folder")).unwrap();
    install(Path::new(env!("CARGO_BIN_EXE_posecut")), &place.folder.path().join("posecut"));
    for (name, phase, order) in
        [("later", "optimisation", "1"), ("second", "judgement", "20"), ("first", "judgement", "10")]
    {
        let script = DESCRIBED.replace("NAME", name).replace("PHASE", phase).replace("ORDER", order);
        place.write(&format!("posecut-{name}"), &script);
    }
    place.write("elsewhere/posecut-mine", "#!/bin/sh\ntouch \"$0.was-run\"; echo mine\n");
    // Programs that are built in too.
    place.write(
        "posecut-oracle",
        &DESCRIBED.replace("NAME", "oracle").replace("PHASE", "judgement").replace("ORDER", "1"),
    );
    place.write("elsewhere/posecut-islands", "#!/bin/sh\necho another\n");
    place.write("elsewhere/posecut-first", "#!/bin/sh\necho another\n");
    place.write("elsewhere/posecut-closed", "#!/bin/sh\n[ -e /proc/self/fd/1 ] || exit 9\n");
    place.write("posecut-first.d", "made by cargo");
    std::fs::write(place.folder.path().join("posecut-text"), "no program").unwrap();
    place
});

impl Place {
    fn write(&self, path: &str, script: &str) {
        let text = self.folder.path().join("script");
        std::fs::write(&text, script).unwrap();
        install(&text, &self.folder.path().join(path));
    }

    /// The PATH for the programs under test.
    fn path(&self) -> String {
        format!("{}:/usr/bin:/bin", self.folder.path().join("elsewhere").display())
    }

    fn run(&self, arguments: &[&str]) -> Output {
        use std::io::Write as _;
        let mut child = Command::new(self.folder.path().join("posecut"))
            .args(arguments)
            .env("PATH", self.path())
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        // Ignore the error: a program that does not read its input closes the pipe.
        drop(child.stdin.take().unwrap().write_all(b"input"));
        child.wait_with_output().unwrap()
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn a_program_gets_arguments_input_and_keeps_its_exit_status() {
    let output = PLACE.run(&["first", "--option", "a b", "-"]);
    assert_eq!(text(&output.stdout), "--option|a b|-|input");
    assert_eq!(output.status.code(), Some(7));
}

/// Regression: the standard library opens /dev/null in place of a closed descriptor, and the program wrote its result there.
#[cfg(target_os = "linux")]
#[test]
fn a_closed_standard_output_stays_closed() {
    let place = &*PLACE;
    let run = |redirection: &str| {
        let script = format!("exec \"$@\" {redirection}");
        let posecut = place.folder.path().join("posecut");
        Command::new("sh")
            .env("PATH", place.path())
            .args(["-c", &script, "sh"])
            .arg(posecut)
            .arg("closed")
            .status()
            .unwrap()
            .code()
    };
    assert_eq!(run(">&-"), Some(9));
    assert_eq!(run(">/dev/null"), Some(0));
}

#[test]
fn help_lists_programs_in_the_order_of_a_pipeline() {
    let place = &*PLACE;
    let help = text(&place.run(&["help"]).stdout);
    let at = |part: &str| help.find(part).unwrap_or_else(|| panic!("{part} is missing in {help}"));
    assert!(at("\n  first ") < at("\n  second ") && at("\n  second ") < at("\n  later "));
    assert!(at("\n  later ") < at("Other programs") && at("Other programs") < at("elsewhere/posecut-mine"));
    assert!(help.lines().any(|line| line.starts_with("  first ") && line.ends_with("  Do first")), "{help}");
    // Of two programs of one name, the one that runs is listed, once.
    assert_eq!(help.matches("\n  oracle ").count(), 1);
    assert!(help.contains("Do oracle") && !help.contains("elsewhere/posecut-islands"), "{help}");
    for same in [&["--help"][..], &["-h"], &[]] {
        assert_eq!(text(&place.run(same).stdout), help);
    }
}

/// Programs on the PATH are not started just to list them.
#[test]
fn a_stage_on_the_path_joins_the_others_and_does_not_hide_them() {
    let place = &*PLACE;
    place.run(&["help"]);
    place.run(&["version"]);
    let trace = place.folder.path().join("elsewhere/posecut-mine.was-run");
    assert!(!trace.exists());
    assert_eq!(text(&place.run(&["mine"]).stdout), "mine\n");
    assert!(trace.exists());
    assert_eq!(place.run(&["first"]).status.code(), Some(7));
}

#[test]
fn version_tells_those_of_all_programs() {
    let place = &*PLACE;
    let said = text(&place.run(&["version"]).stdout);
    let own = concat!("posecut ", env!("CARGO_PKG_VERSION"));
    assert!(said.starts_with(&format!("{own}\n")) && said.contains("\nposecut-mine: /"), "{said}");
    let verify = concat!("posecut-verify ", env!("CARGO_PKG_VERSION"));
    for line in ["posecut-first 1.2", "posecut-later 1.2", "posecut-oracle 1.2", "posecut-second 1.2", verify]
    {
        assert!(said.lines().any(|found| found == line), "{line}: {said}");
    }
    assert_eq!(text(&place.run(&["--version"]).stdout), format!("{own}\n"));
}

#[test]
fn an_unknown_program_is_an_error_with_the_nearest_name() {
    let place = &*PLACE;
    for (arguments, part) in [
        (&["secnd"][..], "(did you mean second?)"),
        (&["hlep"], "(did you mean help?)"),
        (&["../posecut-first"], "there is no program posecut-../posecut-first"),
        (
            &["help", "xyz"],
            "there is no program posecut-xyz beside posecut or on the PATH; posecut help lists",
        ),
        (&["--quiet", "first"], "write posecut NAME --quiet"),
        (&["--generate", "x"], "use man, bash"),
    ] {
        let output = place.run(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.starts_with("posecut: error: ") && said.contains(part) && said.lines().count() == 1,
            "{said}"
        );
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn completions_and_the_manual_page_have_the_programs_at_hand() {
    let place = &*PLACE;
    for what in ["man", "bash", "zsh", "fish"] {
        let said = text(&place.run(&["--generate", what]).stdout);
        assert!(
            ["first", "second", "later", "verify"].iter().all(|name| said.contains(name)),
            "{what}: {said}"
        );
    }
}

/// The manual page has the examples of the help.
#[test]
fn the_help_and_the_manual_page_have_examples() {
    let place = &*PLACE;
    let help = text(&place.run(&["help"]).stdout);
    assert!(help.contains("\nExamples:\n") && help.contains("\n    posecut clean "), "{help}");
    let manual = text(&place.run(&["--generate", "man"]).stdout);
    assert!(manual.contains("\n.SH EXAMPLES\n") && manual.contains("\nposecut clean "), "{manual}");
}

#[test]
fn what_is_no_program_is_not_listed() {
    let nowhere = std::iter::once(Path::new("/nonexistent").to_owned());
    let registry = Registry::of(Some(PLACE.folder.path()), nowhere);
    let names: Vec<String> = registry.beside().into_iter().map(|program| program.name).collect();
    assert_eq!(names, ["first", "later", "oracle", "second"]);
    assert_eq!(registry.elsewhere().len(), 0);
}
