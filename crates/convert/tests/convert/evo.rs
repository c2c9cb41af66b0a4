//! Tests that evo's result files have the numbers of evaluation. (scripts/check-with-evo.sh reads them with evo
//! itself.)

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::{Cursor, Read as _};

use posecut_convert::evo;
use posecut_evaluate::alignment::Freedom;
use posecut_graph::PoseGraph;
use zip::ZipArchive;

/// A square, or the same square turned, shifted and slightly bent. Its times are as close as microseconds allow.
fn square(bend: f64, turn: f64) -> PoseGraph {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for (id, (x, y)) in [(0.0, 0.0), (1.0, bend), (1.0, 1.0), (0.0, 1.0)].iter().enumerate() {
        let (sine, cosine) = turn.sin_cos();
        let (x, y) = (cosine * x - sine * y + 7.0 * turn, sine * x + cosine * y);
        text += &format!(
            "{{\"kind\":\"node\",\"id\":{id},\"utime\":{},\"pose\":[{x},{y},{turn}]}}\n",
            1_327_194_947_000_001_u64 + id as u64
        );
    }
    PoseGraph::read("square", text.as_bytes()).unwrap()
}

fn file(archive: &mut ZipArchive<Cursor<Vec<u8>>>, name: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

/// The numbers of a one-dimensional array in NumPy's format.
fn numbers(bytes: &[u8]) -> Vec<f64> {
    assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    assert_eq!((10 + length) % 64, 0, "NumPy aligns the numbers");
    let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
    let numbers: Vec<f64> = bytes[10 + length..]
        .chunks_exact(8)
        .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
        .collect();
    assert!(header.contains("'<f8'") && header.contains(&format!("({},)", numbers.len())), "{header}");
    numbers
}

#[test]
fn errors_times_and_trajectories_are_those_of_the_graphs() {
    let (estimate, reference) = (square(0.2, 1.0), square(0.0, 0.0));
    let bytes = evo::write(&estimate, &reference, None, None).unwrap();
    assert_eq!(bytes, evo::write(&estimate, &reference, None, None).unwrap(), "no time of writing");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let stats: serde_json::Value = serde_json::from_slice(&file(&mut archive, "stats.json")).unwrap();
    let errors = numbers(&file(&mut archive, "error_array.npy"));
    let rmse = (errors.iter().map(|error| error * error).sum::<f64>() / 4.0).sqrt();
    assert!((stats["rmse"].as_f64().unwrap() - rmse).abs() < 1e-15 && rmse > 0.05 && rmse < 0.2, "{stats}");
    assert_eq!(numbers(&file(&mut archive, "distances_from_start.npy")), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(numbers(&file(&mut archive, "timestamps.npy"))[0], 1_327_194_947.000_001);
    let aligned = String::from_utf8(file(&mut archive, "estimate.tum")).unwrap();
    let known = String::from_utf8(file(&mut archive, "reference.tum")).unwrap();
    assert!(aligned.starts_with("1327194947.000001 ") && aligned.lines().count() == 4);
    let place = |text: &str| -> Vec<f64> {
        text.lines()
            .next()
            .unwrap()
            .split(' ')
            .skip(1)
            .take(2)
            .map(|number| number.parse().unwrap())
            .collect()
    };
    let (a, b) = (place(&aligned), place(&known));
    assert!(((a[0] - b[0]).hypot(a[1] - b[1]) - errors[0]).abs() < 1e-12, "the estimate is written aligned");
    let info: serde_json::Value = serde_json::from_slice(&file(&mut archive, "info.json")).unwrap();
    assert!(info["title"].as_str().unwrap().contains("SE(2)"));
}

#[test]
fn without_alignment_the_shift_counts() {
    let bytes = evo::write(&square(0.0, 1.0), &square(0.0, 0.0), Some(Freedom::None), None).unwrap();
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    assert_eq!(numbers(&file(&mut archive, "error_array.npy"))[0], 7.0);
}

#[test]
fn graphs_without_times_are_refused() {
    let text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n{\"kind\":\"node\",\"id\":0,\"pose\":[0,0,0]}\n";
    let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
    let error = evo::write(&graph, &graph, None, None).unwrap_err().to_string();
    assert!(error.contains("utime"), "{error}");
}
