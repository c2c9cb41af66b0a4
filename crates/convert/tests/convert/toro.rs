//! Reads and writes TORO graphs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::{Matrix3, Rotation2};
use posecut_convert::{g2o, toro};
use posecut_graph::{EdgeKind, PoseGraph};
use proptest::prelude::*;

fn read(text: &str) -> Result<(PoseGraph, g2o::ReadSummary), posecut_convert::ConvertError> {
    toro::read("test.toro", text.as_bytes(), &g2o::ReadOptions::default())
}

#[test]
fn planar_terms_are_in_toros_order_and_turned_into_the_second_frame() {
    let (graph, _) =
        read("VERTEX2 0 0 0 0\nVERTEX2 1 1 2 0.5\nEDGE2 0 1 1 2 0.5 4 1 9 16 0.2 0.3\n").unwrap();
    assert_eq!(graph.nodes[1].pose.as_deref(), Some(&[1.0, 2.0, 0.5][..]));
    let edge = &graph.edges[0];
    assert_eq!(edge.kind, EdgeKind::Odometry);
    let printed = Matrix3::new(4.0, 1.0, 0.2, 1.0, 9.0, 0.3, 0.2, 0.3, 16.0);
    let turn = Rotation2::new(0.5).to_homogeneous();
    let expected = turn.transpose() * printed * turn;
    let found = edge.information.as_deref().unwrap();
    let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    assert!(
        places.iter().zip(found).all(|(&place, term)| (expected[place] - term).abs() < 1e-12),
        "{found:?}"
    );
}

#[test]
fn errors_name_their_line() {
    let right_angle = "EDGE3 0 1 0 0 0 0 1.5707963267948966 0 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
    for (text, parts) in [
        ("VERTEX_SE2 0 0 0 0", &["line 1", "VERTEX_SE2", "VERTEX2"][..]),
        ("VERTEX3 0 0 0 0", &["line 1", "expected 6 numbers", "found 3"]),
        ("VERTEX2 0 0 0 0\nVERTEX3 1 0 0 0 0 0 0", &["line 2", "dimension 3 follows"]),
        ("EDGE2 0 1 0 0 0 1 2 1 1 0 0", &["line 1", "not positive semidefinite"]),
        (right_angle, &["line 1", "right angle", "g2o"]),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{text}: {error}");
    }
}

proptest! {
    #[test]
    fn spatial_graphs_come_back(
        numbers in prop::array::uniform6(-3.0..3.0_f64),
        pitch in -1.5..1.5_f64,
        spread in prop::collection::vec(-1.0..1.0_f64, 36),
    ) {
        let [x, y, z, roll, yaw, _] = numbers;
        let spread = nalgebra::DMatrix::from_vec(6, 6, spread);
        let information = &spread * spread.transpose() + nalgebra::DMatrix::identity(6, 6);
        let terms: Vec<String> = (0..6)
            .flat_map(|row| (row..6).map(move |column| (row, column)))
            .map(|place| information[place].to_string())
            .collect();
        let pose = format!("{x} {y} {z} {roll} {pitch} {yaw}");
        let text = format!("VERTEX3 7 {pose}\nVERTEX3 9 0 0 0 0 0 0\nEDGE3 7 9 {pose} {}\n", terms.join(" "));
        let (graph, _) = read(&text).unwrap();
        let (bytes, summary) = toro::write(&graph, false).unwrap();
        prop_assert_eq!(summary, g2o::WriteSummary::default());
        let again = String::from_utf8(bytes).unwrap();
        for (line, back) in text.lines().zip(again.lines()) {
            let (words, others): (Vec<_>, Vec<_>) = (line.split(' ').collect(), back.split(' ').collect());
            prop_assert_eq!((words[0], words.len()), (others[0], others.len()));
            for (word, other) in words[1..].iter().zip(&others[1..]) {
                let (number, other): (f64, f64) = (word.parse().unwrap(), other.parse().unwrap());
                prop_assert!((number - other).abs() < 1e-8 * (1.0 + information.amax()), "{} {}", line, back);
            }
        }
        // Nothing is lost through JSON Lines either.
        let mut jsonl = Vec::new();
        graph.write(&mut jsonl).unwrap();
        prop_assert_eq!(PoseGraph::read("again", jsonl.as_slice()).unwrap(), graph);
    }
}
