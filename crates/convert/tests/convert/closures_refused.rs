//! Tables of closures that are refused: file, line, column, remedy. Nothing is added to the graph.

use posecut_convert::closures::{ClosureOptions, add};
use posecut_graph::Dimension;

use crate::closures::graph;

fn refused(dimension: Dimension, table: &[u8], options: &ClosureOptions) -> String {
    let (mut changed, graph) = (graph(dimension), graph(dimension));
    let said = add(&mut changed, "closures.csv", table, options).unwrap_err().to_string();
    assert_eq!(changed, graph, "{said}");
    said
}

/// Each table with what the message contains.
fn check(dimension: Dimension, cases: &[(&str, &[&str])]) {
    for (table, parts) in cases {
        let said = refused(dimension, table.as_bytes(), &ClosureOptions::default());
        assert!(said.starts_with("closures.csv"), "{said}");
        for part in *parts {
            assert!(said.contains(part), "{table:?} lacks {part:?}: {said}");
        }
    }
}

#[test]
fn unknown_and_incomplete_columns_are_named() {
    check(
        Dimension::Two,
        &[
            ("", &["the table is empty", "names the columns"]),
            ("from,to,confidence\n0,4,1\n", &["line 1", "the column \"confidence\" is unknown", "score"]),
            ("# exported\nfrom,to,X\n0,4,1\n", &["line 2", "the column \"X\" is unknown"]),
            ("from,to,to\n0,4,4\n", &["line 1", "the column \"to\" occurs twice"]),
            ("from,x,y,theta\n", &["line 1", "has from, but not to", "from,to belong together"]),
            ("x,y,theta\n", &["line 1", "no columns name the ends", "time_from,time_to"]),
            ("from,to,frame_from,frame_to\n", &["line 1", "in several ways"]),
            ("from,to,session_from,session_to\n", &["line 1", "in several ways"]),
            ("from,to,x,y\n", &["line 1", "has x,y, but not theta"]),
            ("from,to,x,y,theta,qw\n", &["line 1", "those of the plane and those of space"]),
            ("from,to,x,y,z,qx,qy,qz,qw\n", &["line 1", "the graph is planar", "x,y,theta"]),
            ("from,to,x,y,theta,sigma_translation\n", &["line 1", "not sigma_rotation"]),
            (
                "from,to,x,y,theta,cov_xx,cov_yy\n",
                &["line 1", "the column \"cov_xy\" is missing", "only the diagonal"],
            ),
            ("from,to,x,y,theta,cov_xx,cov_yy,cov_zz\n", &["line 1", "cov_"]),
            (
                "from,to,x,y,theta\n0,4,1,2,3\n",
                &["line 1", "the measurements have no weight", "--closure-sigma-translation"],
            ),
            ("from,to,sigma_translation,sigma_rotation\n", &["line 1", "no measurements"]),
            (
                "from,to,x,y,theta,sigma_translation,sigma_rotation,info_xx,info_yy,info_thetatheta\n",
                &["line 1", "in several ways", "keep"],
            ),
        ],
    );
    check(
        Dimension::Three,
        &[
            ("from,to,x,y,theta\n", &["line 1", "the graph is spatial", "sin(theta/2)"]),
            ("from,to,x,y,z,qx,qy,qz\n", &["line 1", "but not qw"]),
        ],
    );
}

#[test]
fn ends_that_no_node_has_are_named() {
    check(
        Dimension::Two,
        &[
            ("from,to\n0,4\n0,6\n", &["line 3", "the graph has no node 6", "by frame or time"]),
            // Comments and blank lines used to be left out of the count.
            ("# a\nfrom,to\n\n0,4\n# b\n\n0,6\n", &["line 7", "no node 6"]),
            ("from,to\n0,-1\n", &["line 2", "\"-1\" is not a node id"]),
            ("from,to\n2,2\n", &["line 2", "joins node 2 to itself"]),
            (
                "frame_from,frame_to\n0,10\n",
                &["line 2", "in several sessions: a and b", "session_from,session_to"],
            ),
            (
                "frame_from,frame_to,session_from,session_to\n0,5,a,b\n",
                &["line 2", "session \"b\" has frame 5", "a, b"],
            ),
            ("frame_from,frame_to,session_from,session_to\n0,0,a,c\n", &["line 2", "session \"c\"", "a, b"]),
            (
                "frame_from,frame_to,session_from,session_to\n0,1.5,a,b\n",
                &["line 2", "\"1.5\" is not a frame number"],
            ),
            (
                "time_from,time_to\n0,1.5\n",
                &["line 2", "no node is within 0.1 s", "0.5 s away", "--time-tolerance"],
            ),
            (
                "time_from,time_to,session_from,session_to\n0,100,a,c\n",
                &["line 2", "no node of session \"c\" has a time"],
            ),
            ("time_from,time_to\n0,1e300\n", &["line 2", "64 bits"]),
        ],
    );
}

#[test]
fn numbers_that_mean_nothing_are_named() {
    let sigmas = "from,to,x,y,theta,sigma_translation,sigma_rotation\n0,4,0,0,0,1,1\n";
    for (row, parts) in [
        ("0,4,nan,0,0,1,1", &["line 3", "\"nan\" is not finite"][..]),
        ("0,4,1e999,0,0,1,1", &["line 3", "is not finite"]),
        ("0,4,1 m,0,0,1,1", &["line 3", "\"1 m\" is not a number"]),
        ("0,4,1,,0,1,1", &["line 3", "2 of the 3 fields", "none"]),
        ("0,4,1,0,0,0,1", &["line 3", "sigma_translation is 0", "positive"]),
        ("0,4,1,0,0,1,-1", &["line 3", "sigma_rotation is -1", "positive"]),
        ("0,4,1,0,0,1", &["line 3", "6 fields", "7 columns"]),
    ] {
        check(Dimension::Two, &[(&format!("{sigmas}{row}\n"), parts)]);
    }
    let covariance = "from,to,x,y,theta,cov_xx,cov_xy,cov_xtheta,cov_yy,cov_ytheta,cov_thetatheta\n";
    let information = covariance.replace("cov_", "info_");
    check(
        Dimension::Two,
        &[
            // Eigenvalues 3 and -1.
            (
                &format!("{covariance}0,4,0,0,0,1,2,0,1,0,1\n"),
                &["line 2", "the covariance has no inverse", "positive definite"],
            ),
            (
                &format!("{covariance}0,4,0,0,0,1,0,0,0,0,1\n"),
                &["line 2", "the covariance has no inverse", "singular"],
            ),
            (
                &format!("{information}0,4,0,0,0,1,2,0,1,0,1\n"),
                &["line 2", "not positive semidefinite", "-1", "correct it"],
            ),
            ("from,to,score\n0,4,high\n", &["line 2", "\"high\" is not a number"]),
            ("from,to,label\n0,4,yes\n", &["line 2", "the label is \"yes\"", "1 for a correct closure"]),
        ],
    );
    let table = "from,to,x,y,z,qx,qy,qz,qw,sigma_translation,sigma_rotation\n0,4,0,0,0,1,0,0,1,1,1\n";
    check(Dimension::Three, &[(table, &["line 2", "the quaternion has norm 1.41", "qx, qy, qz, qw"])]);
    let said = refused(Dimension::Two, b"from,to\n0,\xff\n", &ClosureOptions::default());
    assert!(said.starts_with("closures.csv, line 2: the line is not UTF-8"), "{said}");
}

#[test]
fn options_that_contradict_the_table_or_themselves_are_refused() {
    let table = b"from,to,x,y,theta,sigma_translation,sigma_rotation\n0,4,0,0,0,1,1\n";
    let base = ClosureOptions::default();
    let set = |translation, rotation| ClosureOptions {
        closure_sigma_translation: translation,
        closure_sigma_rotation: rotation,
        ..ClosureOptions::default()
    };
    for (options, part) in [
        (set(Some(1.0), None), "only one of"),
        (set(Some(0.0), Some(1.0)), "--closure-sigma-translation is 0"),
        (set(Some(1.0), Some(f64::NAN)), "--closure-sigma-rotation is NaN"),
        (set(Some(1.0), Some(1.0)), "leave the columns or the options out"),
        (ClosureOptions { time_tolerance: -1.0, ..base.clone() }, "--time-tolerance is -1"),
        (ClosureOptions { time_tolerance: f64::INFINITY, ..base }, "--time-tolerance is inf"),
    ] {
        let said = refused(Dimension::Two, table, &options);
        assert!(said.contains(part), "{said}");
    }
}
