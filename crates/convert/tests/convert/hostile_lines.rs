//! Lines that no tool should write.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_convert::{g2o, kitti, toro, tum};

fn g2o_error(bytes: &[u8]) -> String {
    g2o::read("x.g2o", bytes, &g2o::ReadOptions::default()).unwrap_err().to_string()
}

fn tum_error(text: &str) -> String {
    tum::read("x.tum", text.as_bytes(), "0").unwrap_err().to_string()
}

/// Editors on Windows write a byte order mark. It made the first tag unknown although it looked right.
#[test]
fn a_byte_order_mark_is_skipped() {
    let text = "\u{feff}VERTEX_SE2 0 1 2 3\n";
    let (graph, _) = g2o::read("x", text.as_bytes(), &g2o::ReadOptions::default()).unwrap();
    assert_eq!(graph.nodes.len(), 1);
    let text = "\u{feff}VERTEX2 0 1 2 3\n";
    assert_eq!(toro::read("x", text.as_bytes(), &g2o::ReadOptions::default()).unwrap().0.nodes.len(), 1);
    assert_eq!(tum::read("x", "\u{feff}1 0 0 0 0 0 0 1\n".as_bytes(), "0").unwrap().nodes.len(), 1);
    let text = "\u{feff}1 0 0 0 0 1 0 0 0 0 1 0\n";
    assert_eq!(kitti::read("x", text.as_bytes(), "0").unwrap().nodes.len(), 1);
    // A byte order mark is recognised only at the start of a file.
    assert!(
        g2o_error("VERTEX_SE2 0 1 2 3\n\u{feff}VERTEX_SE2 1 1 2 3\n".as_bytes()).contains("line 2: the tag")
    );
}

/// These errors used to name no line.
#[test]
fn lines_that_are_no_text_or_too_long_are_named() {
    let said = g2o_error(b"VERTEX_SE2 0 1 2 3\nVERTEX_SE2 1 1 2 \xff\n");
    assert!(said.starts_with("x.g2o, line 2: cannot be read: ") && said.contains("UTF-8"), "{said}");
    let long = [b"# comment\n\n".as_slice(), &vec![b'1'; 17 << 20]].concat();
    let said = g2o_error(&long);
    assert!(said.starts_with("x.g2o, line 3: ") && said.contains("16 MiB"), "{said}");
    let said = tum::read("x.tum", &b"1 0 0 0 0 0 0 1\n\xff\n"[..], "0").unwrap_err().to_string();
    assert!(said.starts_with("x.tum, line 2: cannot be read"), "{said}");
}

/// 1e300 s used to become the last microsecond that 64 bits can count.
#[test]
fn times_beyond_64_bits_are_refused() {
    for time in ["1e300", "-1e300", "9223372036854.775808", "1.3e18"] {
        let said = tum_error(&format!("# t\n{time} 0 0 0 0 0 0 1\n"));
        assert!(said.contains("line 2: the time") && said.contains("64 bits"), "{said}");
    }
    let text = "-9223372036854 0 0 0 0 0 0 1\n9223372036854 0 0 0 0 0 0 1\n";
    assert_eq!(tum::read("x", text.as_bytes(), "0").unwrap().nodes.len(), 2);
}

/// Both used to be accepted, although a time must identify a pose.
#[test]
fn repeated_and_unordered_times_are_refused() {
    let said = tum_error("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n\n2.0000001 1 0 0 0 0 0 1\n");
    assert!(said.contains("line 4: the time 2.0000001 s is the same as in line 2"), "{said}");
    let said = tum_error("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
    assert!(
        said.contains("line 2: the time 1 s is before that of line 1") && said.contains("sort"),
        "{said}"
    );
}
