//! evo's result files: one absolute trajectory error, as `evo_ape --save_results` writes it and `evo_res` reads it.
//!
//! The file is a zip archive of `info.json` (title and names), `stats.json` (rmse, mean, median, std, min, max, sse),
//! arrays in NumPy's format, and both trajectories in TUM's format.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use nalgebra::UnitQuaternion;
use posecut_evaluate::alignment::Freedom;
use posecut_evaluate::summary::Summary;
use posecut_evaluate::trajectory::{Match, align, errors};
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, PoseGraph};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::ConvertError;
use crate::tum::{Poses, seconds, spatial_poses};

/// A pose that both graphs have, and its time.
struct TimedMatch {
    utime: i64,
    found: Match,
}

/// Writes the translation error of `estimate` against `reference`, after one alignment of all poses.
///
/// Poses are matched by node id and written in the order of time, so both graphs need times. The statistics are those
/// of [`posecut_evaluate`]. The default of `freedom` is SE(2) in the plane and SE(3) in space.
pub fn write(
    estimate: &PoseGraph,
    reference: &PoseGraph,
    freedom: Option<Freedom>,
    session: Option<&str>,
) -> Result<Vec<u8>, ConvertError> {
    let freedom = freedom.unwrap_or(match estimate.header.dimension {
        Dimension::Two => Freedom::Se2,
        Dimension::Three => Freedom::Se3,
    });
    let timed = matches(estimate, reference, session);
    let matches: Vec<&Match> = timed.iter().map(|timed| &timed.found).collect();
    let alignment = align(&matches, freedom);
    let (distances, _) = errors(&matches, &alignment);
    let Some(summary) = Summary::of(&distances) else {
        return Err(ConvertError::graph(
            "no node has a time (utime) and a pose in both graphs",
            "evo's results need times, and ids that mean the same nodes in both graphs",
        ));
    };
    let turn = UnitQuaternion::from_rotation_matrix(&alignment.rotation);
    let aligned: Vec<SE3> = matches
        .iter()
        .map(|found| SE3::new(alignment.apply(&found.estimate.translation), turn * found.estimate.rotation))
        .collect();
    let known: Vec<SE3> = matches.iter().map(|found| found.reference).collect();
    let times: Vec<f64> = timed.iter().map(|timed| timed.utime as f64 / 1e6).collect();
    let from_start: Vec<f64> = times.iter().map(|time| time - times[0]).collect();

    let info = serde_json::json!({
        "title": format!("APE w.r.t. translation part (m)\n(with {} Umeyama alignment)", freedom.name()),
        "ref_name": "reference",
        "est_name": "estimate",
        "label": "APE (m)",
    });
    let Summary { rmse, mean, median, std, min, max, sse, .. } = summary;
    let stats = serde_json::json!({
        "rmse": rmse, "mean": mean, "median": median, "std": std, "min": min, "max": max, "sse": sse,
    });
    let files = [
        ("info.json", info.to_string().into_bytes()),
        ("stats.json", stats.to_string().into_bytes()),
        ("error_array.npy", array(&distances)),
        ("timestamps.npy", array(&times)),
        ("seconds_from_start.npy", array(&from_start)),
        ("distances_from_start.npy", array(&travelled(&known))),
        ("reference.tum", trajectory(&timed, &known)),
        ("estimate.tum", trajectory(&timed, &aligned)),
    ];
    archive(&files).map_err(|error| {
        ConvertError::graph(format!("the archive cannot be written: {error}"), "choose another format")
    })
}

fn matches(estimate: &PoseGraph, reference: &PoseGraph, session: Option<&str>) -> Vec<TimedMatch> {
    let known: HashMap<u64, SE3> = spatial_poses(reference, Poses::Estimate, None)
        .filter_map(|(node, pose)| Some((node.id, SE3::from_components(&pose)?)))
        .collect();
    let mut timed: Vec<TimedMatch> = spatial_poses(estimate, Poses::Estimate, session)
        .filter_map(|(node, pose)| {
            let found = Match {
                // All poses share one alignment, so components do not matter.
                component: 0,
                session: node.session.clone().unwrap_or_default(),
                frame: node.frame.unwrap_or_default(),
                estimate: SE3::from_components(&pose)?,
                reference: *known.get(&node.id)?,
            };
            Some(TimedMatch { utime: node.utime?, found })
        })
        .collect();
    timed.sort_by_key(|timed| timed.utime);
    timed
}

/// Distance travelled up to each pose, metres.
fn travelled(poses: &[SE3]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = poses.windows(2).map(|pair| (pair[1].translation - pair[0].translation).norm());
    std::iter::once(0.0)
        .chain(steps)
        .map(|step| {
            sum += step;
            sum
        })
        .collect()
}

fn trajectory(timed: &[TimedMatch], poses: &[SE3]) -> Vec<u8> {
    let mut text = String::new();
    for (timed, pose) in timed.iter().zip(poses) {
        text += &seconds(timed.utime);
        for number in pose.components() {
            // Writing to a string cannot fail.
            let _ = write!(text, " {number}");
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// NumPy's format, version 1.0: magic, length of the header, header padded to a multiple of 64 bytes, numbers.
fn array(numbers: &[f64]) -> Vec<u8> {
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", numbers.len());
    let padded = (10 + header.len() + 1).next_multiple_of(64);
    header += &" ".repeat(padded - 10 - header.len() - 1);
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

fn archive(files: &[(&str, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // No time stamp: the same results must give the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::DEFAULT);
    for (name, content) in files {
        archive.start_file(*name, options)?;
        archive.write_all(content)?;
    }
    Ok(archive.finish()?.into_inner())
}
