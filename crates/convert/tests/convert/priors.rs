//! Priors of g2o and JRL.

use nalgebra::SMatrix;
use posecut_convert::{g2o, jrl, toro};
use posecut_geometry::covariance::{pack_upper_triangle, unpack_upper_triangle};
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{Dimension, Header, Node, PoseGraph, Prior, PriorOf};

fn read(text: &str) -> Result<PoseGraph, String> {
    let read = g2o::read("file", text.as_bytes(), &g2o::ReadOptions::default());
    read.map(|(graph, _)| graph).map_err(|error| error.to_string())
}

fn written(graph: &PoseGraph) -> String {
    String::from_utf8(g2o::write(graph, false).0).unwrap()
}

/// The lines of a file without the others.
fn lines<'a>(text: &'a str, tags: &[&str]) -> Vec<&'a str> {
    text.lines().filter(|line| tags.iter().any(|tag| line.split(' ').next() == Some(tag))).collect()
}

const PLANE: &str = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_PRIOR_SE2 1 10.1 -0.2 3.0000000000000004 4 0.1 0 5 0 0.30000000000000004\nEDGE_PRIOR_SE2_XY 0 9 1e-7 0.25 0.1 0.5\n";
const SPACE: &str = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nEDGE_SE3_PRIOR 0 0 1 2 3 0.6 0 0 0.8 1 0 0 0 0 0 2 0 0 0 0 3 0 0 0 4 0 0 5 0 6\nEDGE_SE3_PRIOR 7 0 1.1 2 3 0 0 0 1 1 0.1 0 0 0 0 2 0 0 0 0 3 0 0 0 0 0 0 0 0 0\n";

#[test]
fn priors_of_the_plane_come_back_bit_for_bit() {
    let graph = read(PLANE).unwrap();
    let [pose, position] = &graph.priors[..] else { panic!("{:?}", graph.priors) };
    assert_eq!((pose.node, pose.of(Dimension::Two)), (1, Some(PriorOf::Pose)));
    assert_eq!(pose.measurement, [10.1, -0.2, 3.000_000_000_000_000_4]);
    assert_eq!(pose.information.as_deref().unwrap(), [4.0, 0.1, 0.0, 5.0, 0.0, 0.300_000_000_000_000_04]);
    assert_eq!((position.node, position.of(Dimension::Two)), (0, Some(PriorOf::Position)));
    assert_eq!(position.information.as_deref().unwrap(), [0.25, 0.1, 0.5]);
    let text = written(&graph);
    let tags = ["EDGE_PRIOR_SE2", "EDGE_PRIOR_SE2_XY"];
    let exact = PLANE.replace("1e-7", "0.0000001");
    assert_eq!(lines(&text, &tags), lines(&exact, &tags));
    assert_eq!(read(&text).unwrap(), graph);
}

/// A prior without information about the rotation measures a position; vertex 7 has a prior but no line.
#[test]
fn priors_of_space_come_back_bit_for_bit() {
    let graph = read(SPACE).unwrap();
    let [pose, position] = &graph.priors[..] else { panic!("{:?}", graph.priors) };
    assert_eq!((pose.node, pose.of(Dimension::Three)), (0, Some(PriorOf::Pose)));
    assert_eq!((position.node, position.of(Dimension::Three)), (7, Some(PriorOf::Position)));
    assert_eq!(position.information.as_deref().unwrap(), [1.0, 0.1, 0.0, 2.0, 0.0, 3.0]);
    assert_eq!(graph.nodes[1].id, 7);
    let text = written(&graph);
    let tags = ["PARAMS_SE3OFFSET", "EDGE_SE3_PRIOR"];
    assert_eq!(lines(&text, &tags), lines(SPACE, &tags));
    assert_eq!(read(&text).unwrap(), graph);
}

/// With an offset `P`, the cost of any pose `X` is that of g2o's `Z^-1 X P`.
#[test]
fn offsets_are_composed() {
    let (x, z, p) = (
        SE3::from_euler(1.0, 2.0, -0.5, 0.3, -0.4, 1.0),
        SE3::from_euler(1.5, 1.0, -0.2, -0.1, 0.2, 1.4),
        SE3::from_euler(0.3, -0.7, 0.2, 0.5, 0.1, -2.0),
    );
    let spread = SMatrix::<f64, 6, 6>::from_fn(|row, column| ((row * 5 + column * 3) % 7) as f64 * 0.2);
    let omega = SMatrix::identity() + spread * spread.transpose();
    let words =
        |numbers: &[f64]| format!(" {}", numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    let text = format!(
        "PARAMS_SE3OFFSET 3{}\nEDGE_SE3_PRIOR 0 3{}{}\n",
        words(&p.components()),
        words(&z.components()),
        words(&pack_upper_triangle(&omega))
    );
    let prior = &read(&text).unwrap().priors[0];
    let measured = SE3::from_components(&prior.measurement).unwrap();
    let matrix = unpack_upper_triangle::<6>(prior.information.as_deref().unwrap()).unwrap();
    let square = |error: nalgebra::SVector<f64, 6>, matrix: SMatrix<f64, 6, 6>| error.dot(&(matrix * error));
    let ours = square(measured.between(&x).log(), matrix);
    let theirs = square(z.between(&x.compose(&p)).log(), omega);
    assert!((ours - theirs).abs() < 1e-9 * theirs, "{ours} {theirs}");
}

/// The information of a position is turned from the frame of the measurement into that of the map.
#[test]
fn positions_measured_in_a_turned_frame() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turned = read(&format!(
        "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nEDGE_SE3_PRIOR 0 0 1 2 3 0 0 {half} {half} 4 0 0 0 0 0 9 0 0 0 0 1 0 0 0 0 0 0 0 0 0\n"
    ));
    let prior = &turned.unwrap().priors[0];
    assert_eq!(prior.measurement, [1.0, 2.0, 3.0]);
    let found = prior.information.as_deref().unwrap();
    for (found, expected) in found.iter().zip([9.0, 0.0, 0.0, 4.0, 0.0, 1.0]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    let planar =
        read(&format!("EDGE_PRIOR_SE2 0 1 2 {} 4 0 0 9 0 0\n", std::f64::consts::FRAC_PI_2)).unwrap();
    assert_eq!(planar.priors[0].measurement, [1.0, 2.0]);
    assert!((planar.priors[0].information.as_deref().unwrap()[0] - 9.0).abs() < 1e-12);
}

#[test]
fn impossible_priors_are_refused_by_name() {
    let information = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 0 0 0 0 0";
    for (text, words) in [
        ("EDGE_PRIOR_SE2 0 1 2 3 1 0 0 1 0\n".to_owned(), &["line 1", "expected 9 numbers", "found 8"][..]),
        ("EDGE_PRIOR_SE2 x 1 2 3 1 0 0 1 0 1\n".to_owned(), &["line 1", "\"x\" is not a vertex id"]),
        (
            "EDGE_PRIOR_SE2 0 1 2 3 1 2 0 1 0 1\n".to_owned(),
            &["line 1", "prior of 0", "not positive semidefinite"],
        ),
        (
            "EDGE_PRIOR_SE2_XY 0 1 2 1 2 1\n".to_owned(),
            &["line 1", "prior of 0", "not positive semidefinite"],
        ),
        ("EDGE_PRIOR_SE2_XY 0 nan 2 1 0 1\n".to_owned(), &["line 1", "not finite"]),
        (
            format!("EDGE_SE3_PRIOR 0 4 0 0 0 0 0 0 1 {information}\n"),
            &["line 1", "parameter 4", "PARAMS_SE3OFFSET"],
        ),
        (
            format!("PARAMS_SE3OFFSET 4 0 0 1 0 0 0 1\nEDGE_SE3_PRIOR 0 4 0 0 0 0 0 0 1 {information}\n"),
            &["line 2", "point beside vertex 0", "parameter 4"],
        ),
        (
            "PARAMS_SE3OFFSET 4 0 0 1 0 0 0 1\nPARAMS_SE3OFFSET 4 0 0 2 0 0 0 1\n".to_owned(),
            &["line 2", "occurs twice"],
        ),
        (format!("VERTEX_SE2 0 0 0 0\n{SPACE}"), &["line 2", "dimension 3 follows"]),
    ] {
        let error = read(&text).unwrap_err();
        assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
    }
}

/// A rejected prior is not in the file unless it is asked for, and TORO has none.
#[test]
fn rejected_priors_and_formats_without_any() {
    let mut graph = read(PLANE).unwrap();
    graph.priors[1].reject("optimize");
    let (text, summary) = g2o::write(&graph, false);
    assert_eq!(summary.rejected_priors, 1);
    assert_eq!(read(std::str::from_utf8(&text).unwrap()).unwrap().priors.len(), 1);
    assert_eq!(read(std::str::from_utf8(&g2o::write(&graph, true).0).unwrap()).unwrap().priors.len(), 2);
    assert_eq!(toro::write(&graph, true).unwrap().1.priors, 2);
}

/// Several files may repeat a prior.
#[test]
fn a_prior_in_two_files_is_read_once() {
    let files = ["one", "two"].map(|name| (name.to_owned(), SPACE.as_bytes())).to_vec();
    let (graph, _) = g2o::read_several(files, &g2o::ReadOptions::default()).unwrap();
    assert_eq!(graph.priors.len(), 2);
}

/// Priors of later poses come back from JRL; a position is left out and counted, and the first pose is an anchor.
#[test]
fn priors_of_a_dataset() {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    let first = u64::from(b'a') << 56;
    for id in [first, first + 1, first + 2] {
        let pose = Some(vec![(id - first) as f64, 0.0, 0.0]);
        graph.nodes.push(Node {
            id,
            session: Some("a".to_owned()),
            frame: Some((id - first) as i64),
            pose,
            ..Node::default()
        });
    }
    let prior = |id, node, measurement: &[f64], information: &[f64]| Prior {
        id,
        node,
        measurement: measurement.to_vec(),
        information: Some(information.to_vec()),
        ..Prior::default()
    };
    graph.priors = vec![
        prior(0, first + 1, &[1.5, 0.25, 0.1], &[4.0, 0.0, 0.0, 16.0, 0.0, 64.0]),
        prior(1, first + 2, &[2.0, 0.0], &[1.0, 0.0, 1.0]),
        prior(2, first, &[0.0, 0.0, 0.0], &[1.0, 0.0, 0.0, 1.0, 0.0, 1.0]),
    ];
    let (bytes, summary) = jrl::write(&graph, false).unwrap();
    assert_eq!((summary.positions, summary.anchors), (1, 1));
    let (again, summary) = jrl::read("file", &bytes, &jrl::ReadOptions::default()).unwrap();
    assert_eq!(again.priors, graph.priors[..1]);
    assert_eq!((summary.priors, again.nodes[0].is_fixed()), (0, Ok(true)));
    let broken =
        String::from_utf8(bytes).unwrap().replace("0.25,0.0,0.0,0.0,0.0625", "0.25,9.0,0.0,9.0,0.0625");
    let error = jrl::read("file", broken.as_bytes(), &jrl::ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("measurements.a[1].measurements[0]") && error.contains("; "), "{error}");
}
