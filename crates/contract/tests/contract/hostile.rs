//! Tests that programs refuse hostile input with one sentence, in bounded memory, and leave nothing behind.

#![cfg(unix)]

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use posecut_contract::{program, samples};

/// Address space in KiB that a program may take for input that is refused: 3 GB. Half of it is for threads.
const ADDRESS_SPACE: &str = "3000000";

/// Runs a program with limited memory. It aborts if it needs more.
fn confined(name: &str, arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new("sh")
        .args(["-c", &format!("ulimit -v {ADDRESS_SPACE}; exec \"$@\""), "sh"])
        .arg(program(name))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let bytes = input.to_vec();
    let writer = std::thread::spawn(move || drop(stdin.write_all(&bytes)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
}

fn refused(name: &str, arguments: &[&str], input: &[u8], part: &str) {
    let output = confined(name, arguments, input);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{name} {arguments:?}: {said}");
    assert!(said.contains(part), "{name} {arguments:?}: \"{part}\" is not in: {said}");
    assert_eq!(said.lines().count(), 1, "{name} {arguments:?}: one sentence: {said}");
}

fn compressed(bytes: impl Iterator<Item = Vec<u8>>) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    bytes.for_each(|part| encoder.write_all(&part).unwrap());
    encoder.finish().unwrap()
}

/// The programs that read text, each with its arguments.
const READERS: &[(&str, &[&str])] = &[
    ("pcm", &[]),
    ("inspect", &["validate"]),
    ("inspect", &["filter"]),
    ("convert", &["--from", "g2o"]),
    ("convert", &["--from", "tum"]),
    ("convert", &["--from", "kitti"]),
    ("partition", &["solve"]),
];

#[test]
fn compressed_input_made_to_fill_memory_is_refused() {
    // Blank lines, which every reader skips: 300 MiB in 1.5 MB. They are long, because a reader takes time for each line. A part is
    // compressed once and repeated.
    let repeated = |part: Vec<u8>| compressed(std::iter::once(part)).repeat(300);
    let bomb = repeated([[b' '; 4095].as_slice(), b"\n"].concat().repeat(256));
    for (name, arguments) in READERS {
        if *name == "partition" {
            continue;
        }
        refused(name, arguments, &bomb, "100 times their size");
    }
    let header = compressed(std::iter::once(b"MULTICUT\n".to_vec()));
    refused("partition", &["solve"], &[header, bomb].concat(), "100 times their size");
    let folder = tempfile::tempdir().unwrap();
    let list = folder.path().join("matches.csv.gz");
    // CSV readers skip empty lines but refuse lines of spaces.
    let empty = || vec![b'\n'; 1 << 20];
    std::fs::write(&list, repeated(empty())).unwrap();
    let session = samples().path("session.jsonl");
    refused("construct", &[&session, "--matches", list.to_str().unwrap()], b"", "100 times their size");
    let mut header = tar::Header::new_gnu();
    header.set_path("2012-01-22/wheels.csv").unwrap();
    header.set_size(300 << 20);
    header.set_cksum();
    let path = folder.path().join("2012-01-22_sen.tar.gz");
    let member = compressed(std::iter::once(header.as_bytes().to_vec()));
    let end = compressed(std::iter::once(vec![0; 1024]));
    std::fs::write(&path, [member, repeated(empty()), end].concat()).unwrap();
    refused("ingest", &[path.to_str().unwrap()], b"", "100 times their size");
}

#[test]
fn a_line_without_end_is_refused() {
    // Readers refuse a line once it is longer than 16 MiB.
    let endless = vec![b'1'; 17 << 20];
    for (name, arguments) in READERS {
        let (bytes, part) = match *name {
            "partition" => ([b"MULTICUT\n".as_slice(), &endless].concat(), "line 2"),
            "inspect" if arguments[0] == "validate" => continue,
            _ => (endless.clone(), "16 MiB"),
        };
        refused(name, arguments, &bytes, part);
    }
    // The validator reports its findings with exit status 1.
    let output = confined("inspect", &["validate"], &endless);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("16 MiB"));
}

#[test]
fn sizes_that_files_claim_are_not_believed() {
    for (text, part) in [
        ("MULTICUT\n0 1000000000000000000 1\n", "more than the"),
        ("MULTICUT\n0 99999999999999999999999999 1\n", "more than the"),
        ("MULTICUT\n0 268435455 1\n", "the number of edges is only 1;"),
    ] {
        refused("partition", &["solve"], text.as_bytes(), part);
    }
    let header = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
    let deep = format!("{header}\n{{\"kind\":\"node\",\"id\":0,\"x\":{}\n", "[".repeat(1_000_000));
    refused("pcm", &[], deep.as_bytes(), "recursion limit");
    let unknown = format!("{header}\n{{\"kind\":\"x\",\"x\":{}\n", "{\"a\":".repeat(1_000_000));
    refused("pcm", &[], unknown.as_bytes(), "not JSON");
    // The largest ids and frames are valid numbers.
    let extreme = format!(
        "{header}\n{}\n{}\n{}\n",
        r#"{"kind":"node","id":0,"session":"a","frame":-9223372036854775808,"utime":-9223372036854775808,"pose":[0,0,0]}"#,
        r#"{"kind":"node","id":18446744073709551615,"session":"a","frame":9223372036854775807,"utime":9223372036854775807,"pose":[1e308,-1e308,1e308]}"#,
        r#"{"kind":"landmark","id":18446744073709551615,"from":0,"to":18446744073709551615,"measurement":[1e308,1e308,1e308],"information":[1e308,0,0,1e308,0,1e308]}"#,
    );
    for (name, arguments) in
        [("pcm", &[][..]), ("multicut", &[]), ("optimize", &[]), ("inspect", &["info"]), ("evaluate", &[])]
    {
        let output = confined(name, arguments, extreme.as_bytes());
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 2)), "{name}: {code:?}, {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_damaged_archive_is_refused() {
    let whole = compressed([samples().bytes("graph.jsonl")].into_iter());
    let mut broken = whole.clone();
    let last = broken.len() - 6;
    broken[last] ^= 1;
    for (damage, bytes) in [("cut short", &whole[..whole.len() / 2]), ("check sum", &broken[..])] {
        for (name, arguments) in [("pcm", &[][..]), ("inspect", &["validate"])] {
            let output = confined(name, arguments, bytes);
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name}, {damage}: {said}");
            assert!(said.contains("standard input: cannot be read"), "{name}, {damage}: {said}");
        }
    }
}

fn listing(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut all = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().flatten() {
            all.push(entry.path());
            if entry.file_type().unwrap().is_dir() {
                folders.push(entry.path());
            }
        }
    }
    all.sort();
    all
}

/// Archive members are found by the last part of their names, and nothing is unpacked.
#[test]
fn no_member_of_an_archive_leaves_it() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("a/b");
    std::fs::create_dir_all(&inside).unwrap();
    let mut archive = tar::Builder::new(Vec::new());
    for name in ["../escaped.csv", "../../wheels.csv", "/kvh.csv", "2012-01-22/../../ms25.csv"] {
        let content = b"1,1,1\n2,1,1\n";
        let mut header = tar::Header::new_gnu();
        header.set_size(content.len() as u64);
        // Write the name directly into the header, because the library refuses such names.
        header.as_old_mut().name[..name.len()].copy_from_slice(name.as_bytes());
        header.set_cksum();
        archive.append(&header, content.as_slice()).unwrap();
    }
    let mut link = tar::Header::new_gnu();
    link.set_entry_type(tar::EntryType::Symlink);
    link.set_size(0);
    archive.append_link(&mut link, "2012-01-22/odometry_mu.csv", "/etc/passwd").unwrap();
    let path = inside.join("2012-01-22_sen.tar.gz");
    std::fs::write(&path, compressed([archive.into_inner().unwrap()].into_iter())).unwrap();
    let before = listing(folder.path());
    let output = confined("ingest", &[path.to_str().unwrap()], b"");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 2)), "{said}");
    assert!(!said.contains("root:"), "a link out of the archive was followed: {said}");
    assert_eq!(listing(folder.path()), before);
}
