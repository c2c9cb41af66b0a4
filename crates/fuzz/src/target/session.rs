//! Targets for NCLT sessions: directories of CSV files, and archives.

use clap::Parser as _;
use posecut_ingest::{Options, SessionFiles, ingest};

use super::{Outcome, scratch};
use crate::seeds::{compressed, sections};

#[derive(clap::Parser)]
struct Arguments {
    #[command(flatten)]
    options: Options,
}

fn ingested(path: &std::path::Path) -> Outcome {
    let mut worst = Outcome::Read(String::new());
    for dimension in ["2", "3"] {
        let arguments = Arguments::try_parse_from(["ingest", "--dimension", dimension, "--keep-every", "2"]);
        let options = arguments.expect("these are its options").options;
        let mut files = match SessionFiles::find(path, None, None) {
            Ok(files) => files,
            Err(error) => return Outcome::refused(error),
        };
        match ingest(&mut files, &options, &mut |_| ()) {
            Ok(ingested) => {
                // Writing may refuse a number that overflowed on the way; everything else must be valid.
                let mut bytes = Vec::new();
                match ingested.graph.write(&mut bytes) {
                    Ok(()) => {
                        posecut_graph::PoseGraph::read("again", bytes.as_slice())
                            .expect("an ingested graph is sound");
                    }
                    Err(error) => worst = Outcome::refused(error),
                }
            }
            Err(error) => worst = Outcome::refused(error),
        }
    }
    worst
}

/// Reads an input of several files, each opened by a line with its name.
pub(super) fn directory(input: &[u8]) -> Outcome {
    let folder = scratch("2012-01-22");
    drop(std::fs::remove_dir_all(&folder));
    std::fs::create_dir_all(&folder).expect("the scratch folder takes it");
    for (name, content) in sections(input) {
        // Skip a file whose name the system refuses.
        drop(std::fs::write(folder.join(name), content));
    }
    ingested(&folder)
}

/// Reads an input that is an uncompressed archive. Nothing may be unpacked: the scratch folder's parent must not change.
pub(super) fn archive(input: &[u8]) -> Outcome {
    let path = scratch("2012-01-22_sen.tar.gz");
    std::fs::write(&path, compressed(input)).expect("the scratch folder takes it");
    let outcome = ingested(&path);
    let folder = path.parent().expect("it lies in the scratch folder");
    let escaped =
        ["wheels.csv", "../wheels.csv", "../../wheels.csv"].iter().any(|name| folder.join(name).exists());
    assert!(!escaped, "a member of an archive was written to disk");
    outcome
}
