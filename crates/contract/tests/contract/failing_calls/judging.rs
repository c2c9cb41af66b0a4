//! Judges how a program behaves when a call fails.

use std::process::{Command, Stdio};

use posecut_contract::program;

use super::cases::Case;
use super::folder::{self, Files, files};
use super::{Fault, Run};

/// The errors of a run in which a call failed.
pub(super) fn wrong(
    case: &Case,
    before: &Files,
    sound: &Run,
    at: usize,
    fault: Fault,
    run: &Run,
) -> Vec<String> {
    let mut wrong = Vec::new();
    let said = String::from_utf8_lossy(&run.output.stderr);
    let Some((name, path)) = run.calls.get(at - 1) else { return wrong };
    if name == "close" && path.contains(".lock") {
        // The call wrote nothing that could be lost.
        return wrong;
    }
    let removes = ["unlink", "unlinkat", "rmdir"].contains(&name.as_str());
    let status = run.output.status.code();
    let survived = !matches!(fault, Fault::Error { .. });
    if survived && status != sound.output.status.code() {
        wrong.push(format!("status {:?}, and not as without a fault", run.output.status));
    }
    if let Fault::Error { said: cause, .. } = fault {
        wrong.extend(badly_said(case, (removes, path), &said, cause, status, sound.output.status.code()));
    }
    wrong.extend(files_torn(case, before, sound, run, removes && said.contains(".tmp")));
    wrong.extend(folders_torn(case, before, sound, run));
    if status == sound.output.status.code() && status != Some(2) {
        if run.stdout != sound.stdout {
            wrong.push("standard output is torn".to_owned());
        }
        for (file, bytes) in &sound.files {
            if !case.varies(file) && run.files.get(file) != Some(bytes) {
                wrong.push(format!("{} is not complete", file.display()));
            }
        }
    }
    if let (true, Fault::Error { .. }) = (case.resumes, fault) {
        wrong.extend(not_resumed(case, sound, run, removes));
    }
    wrong
}

/// The files that are neither unchanged nor complete, and missing files. A file that could not be removed may stay if the
/// message names it, so that the user can remove it.
fn files_torn(case: &Case, before: &Files, sound: &Run, run: &Run, may_stay: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    for (file, bytes) in &run.files {
        let sound_bytes = sound.files.get(file);
        let complete = if case.varies(file) {
            sound_bytes.is_some() && folder::is_json(bytes)
        } else {
            sound_bytes == Some(bytes) || case.grows(file) && folder::is_json(bytes)
        };
        if complete || before.get(file) == Some(bytes) {
            continue;
        }
        match sound_bytes {
            None if may_stay => {}
            None => wrong.push(format!("{} was left", file.display())),
            Some(_) => wrong.push(format!("{} is torn", file.display())),
        }
    }
    if let Some(missing) = before.keys().find(|file| !run.files.contains_key(*file)) {
        wrong.push(format!("{} is gone", missing.display()));
    }
    wrong
}

/// The folders that must be replaced as a whole but are neither the old nor the new one.
fn folders_torn(case: &Case, before: &Files, sound: &Run, run: &Run) -> Vec<String> {
    let part = |files: &Files, whole: &str| -> Files {
        files
            .iter()
            .filter(|(file, _)| file.starts_with(whole))
            .map(|(file, bytes)| (file.clone(), bytes.clone()))
            .collect()
    };
    let torn = |whole: &&&str| {
        let now = part(&run.files, whole);
        now != part(before, whole) && now != part(&sound.files, whole)
    };
    let said = |whole: &&str| format!("{whole} is neither the old folder nor the new one");
    case.wholes.iter().filter(torn).map(said).collect()
}

/// Checks that the same command, repeated, finishes the work.
fn not_resumed(case: &Case, sound: &Run, run: &Run, removes: bool) -> Option<String> {
    let again = Command::new(program(case.program))
        .args(&case.arguments)
        .current_dir(run.folder.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let mut after = files(run.folder.path());
    let mut expected = sound.files.clone();
    after.retain(|file, _| !case.varies(file) && (!removes || expected.contains_key(file)));
    expected.retain(|file, _| !case.varies(file));
    (!again.status.success() || after != expected)
        .then(|| format!("the next run does not resume: {}", String::from_utf8_lossy(&again.stderr)))
}

/// The errors in the exit status and the messages of a program whose call failed.
fn badly_said(
    case: &Case,
    (removes, path): (bool, &str),
    said: &str,
    cause: &str,
    status: Option<i32>,
    sound: Option<i32>,
) -> Vec<String> {
    // Success is allowed in two cases: posecut-experiment warns and runs a failed stage again, and a failed removal leaves the
    // result complete. `files_torn` checks that a file that could not be removed is named.
    let warned = said.lines().any(|line| line.contains(": warning: ") && line.contains(cause));
    if status == sound && (warned || removes) {
        return Vec::new();
    }
    let mut wrong = Vec::new();
    if status != Some(2) {
        wrong.push(format!("status {status:?}, and not 2"));
    }
    let errors: Vec<&str> = said.lines().filter(|line| line.contains(": error: ")).collect();
    if errors.len() != 1 {
        wrong.push(format!("{} sentences", errors.len()));
    }
    if !said.contains(cause) {
        wrong.push("the cause is not named".to_owned());
    }
    if !case.names.iter().any(|name| said.contains(name.as_str())) && !said.contains(path) {
        wrong.push("no path is named".to_owned());
    }
    wrong
}
