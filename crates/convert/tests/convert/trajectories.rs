//! Trajectories become graphs that can be optimised.

use std::fmt::Write as _;

use posecut_graph::{Dimension, EdgeKind, PoseGraph};

use crate::program::{converted, folder, refused};

/// Four poses on a circle of 10 m, a step of 0.1 rad each second.
fn tum(height: f64) -> String {
    let mut text = "# time x y z qx qy qz qw\n".to_owned();
    for step in 0..4 {
        let angle = 0.1 * f64::from(step);
        let (x, y) = (10.0 * angle.sin(), 10.0 * (1.0 - angle.cos()));
        let (z, half) = (height * f64::from(step), angle / 2.0);
        writeln!(text, "{step}.5 {x} {y} {z} 0 0 {} {}", half.sin(), half.cos()).unwrap();
    }
    text
}

/// The same drive as KITTI has it: z forward, x right, y down.
fn kitti() -> String {
    let mut text = String::new();
    for step in 0..4 {
        let angle = 0.1 * f64::from(step);
        let (forward, left) = (10.0 * angle.sin(), 10.0 * (1.0 - angle.cos()));
        let (sin, cos) = angle.sin_cos();
        writeln!(text, "{cos} 0 {} {} 0 1 0 0 {sin} 0 {cos} {forward}", -sin, -left).unwrap();
    }
    text
}

const ODOMETRY: [&str; 5] =
    ["--odometry-from-poses", "--sigma-translation", "0.5", "--sigma-rotation", "0.25"];

fn check_circle(graph: &PoseGraph) {
    assert_eq!(graph.header.dimension, Dimension::Two);
    assert_eq!((graph.nodes.len(), graph.edges.len()), (4, 3));
    for edge in &graph.edges {
        assert_eq!((edge.kind, edge.to), (EdgeKind::Odometry, edge.from + 1));
        let step = edge.measurement.as_deref().unwrap();
        let expected = [10.0 * 0.1_f64.sin(), 10.0 * (1.0 - 0.1_f64.cos()), 0.1];
        assert!(step.iter().zip(expected).all(|(found, number)| (found - number).abs() < 1e-9), "{step:?}");
        assert_eq!(edge.information.as_deref(), Some(&[4.0, 0.0, 0.0, 4.0, 0.0, 16.0][..]));
    }
}

/// A trajectory of 8358 poses used to become a graph of 8358 components.
#[test]
fn poses_are_joined_by_odometry_in_the_plane_and_in_space() {
    let folder = folder(&[("drive.tum", &tum(0.0)), ("00.kitti", &kitti())]);
    for file in ["drive.tum", "00.kitti"] {
        let arguments: Vec<&str> = [file, "--dimension", "2"].into_iter().chain(ODOMETRY).collect();
        let (graph, said) = converted(folder.path(), &arguments);
        assert!(said.contains("added 3 odometry edges"), "{said}");
        check_circle(&graph);
    }
    let arguments: Vec<&str> = std::iter::once("drive.tum").chain(ODOMETRY).collect();
    let (graph, _) = converted(folder.path(), &arguments);
    assert_eq!((graph.header.dimension, graph.edges.len()), (Dimension::Three, 3));
    let information = graph.edges[0].information.as_deref().unwrap();
    assert_eq!((information.len(), information[0], information[20]), (21, 4.0, 16.0));
    // Times are kept.
    assert_eq!(graph.nodes[2].utime, Some(2_500_000));
}

#[test]
fn without_odometry_the_program_says_that_there_is_nothing_to_optimise() {
    let folder = folder(&[("drive.tum", &tum(0.0))]);
    let (graph, said) = converted(folder.path(), &["drive.tum"]);
    assert!(graph.edges.is_empty());
    assert!(
        said.contains("drive.tum: there are no edges") && said.contains("--odometry-from-poses"),
        "{said}"
    );
}

#[test]
fn closures_join_a_trajectory_by_its_times() {
    let table =
        "time_from,time_to,x,y,theta,sigma_translation,sigma_rotation,score\n0.5,3.48,2,1,0.3,0.5,0.1,0.9\n";
    let folder = folder(&[("drive.tum", &tum(0.0)), ("closures.csv", table)]);
    let arguments: Vec<&str> =
        ["drive.tum", "--dimension", "2", "--closures", "closures.csv"].into_iter().chain(ODOMETRY).collect();
    let (graph, said) = converted(folder.path(), &arguments);
    assert!(
        said.contains("closures.csv: added 1 landmark edge (0 with a label, 0 without a measurement)"),
        "{said}"
    );
    let closure = graph.edges_of(EdgeKind::Landmark).next().unwrap();
    assert_eq!((closure.from, closure.to, closure.score), (0, 3, Some(0.9)));
    let said = refused(folder.path(), &["closures.csv"]);
    assert!(said.contains("closures.csv: neither the content nor the name"), "{said}");
    // The table is planar, the trajectory is not.
    let said = refused(folder.path(), &["drive.tum", "--closures", "closures.csv"]);
    assert!(said.contains("closures.csv, line 1: the measurements are planar"), "{said}");
    assert!(said.contains("project a trajectory with --dimension 2"), "{said}");
}

#[test]
fn what_has_no_projection_or_no_weight_is_refused() {
    let folder = folder(&[
        ("climb.tum", &tum(2.0)),
        ("00.kitti", &kitti()),
        ("space.g2o", "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"),
        ("graph.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nVERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"),
    ]);
    let said = refused(folder.path(), &["climb.tum", "--dimension", "2"]);
    assert!(
        said.contains("not near a plane") && said.contains("6.0 m") && said.contains("--flatten"),
        "{said}"
    );
    let (graph, _) = converted(folder.path(), &["climb.tum", "--dimension", "2", "--flatten"]);
    assert_eq!(graph.header.dimension, Dimension::Two);
    let said = refused(folder.path(), &["00.kitti", "--dimension", "2", "--axes", "robot"]);
    assert!(said.contains("--axes camera"), "{said}");
    let said = refused(folder.path(), &["space.g2o", "--dimension", "2"]);
    assert!(said.contains("the graph has edges") && said.contains("leave --dimension out"), "{said}");
    let more = |file| std::iter::once(file).chain(ODOMETRY).collect::<Vec<&str>>();
    let said = refused(folder.path(), &more("graph.g2o"));
    assert!(said.contains("the graph has some already (odometry 0)"), "{said}");
    let zero = ["climb.tum", "--odometry-from-poses", "--sigma-translation", "0", "--sigma-rotation", "1"];
    let said = refused(folder.path(), &zero);
    assert!(said.contains("--sigma-translation is 0"), "{said}");
}
