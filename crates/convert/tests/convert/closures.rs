//! Closures from a table: each way to name their ends, and each way to weight their measurements.

use posecut_convert::closures::{Added, ClosureOptions, add};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, PoseGraph};

/// Two sessions of three nodes: ids 0 to 5, frames 0, 10 and 20, times 0, 1 and 2 s, those of session b 100 s later.
pub(crate) fn graph(dimension: Dimension) -> PoseGraph {
    let mut graph = PoseGraph::new(Header::new(dimension));
    for id in 0..6 {
        let (session, step) = if id < 3 { ("a", id as i64) } else { ("b", id as i64 - 3) };
        graph.nodes.push(Node {
            id,
            session: Some(session.to_owned()),
            frame: Some(10 * step),
            utime: Some(1_000_000 * step + if session == "b" { 100_000_000 } else { 0 }),
            pose: Some(dimension.identity()),
            ..Node::default()
        });
    }
    for id in [0, 1, 3, 4] {
        let mut edge = Edge::new(EdgeKind::Odometry, id, id, id + 1);
        edge.measurement = Some(dimension.identity());
        graph.edges.push(edge);
    }
    graph
}

/// The landmark edges that a table adds.
fn added(dimension: Dimension, table: &str, options: &ClosureOptions) -> (Vec<Edge>, Added) {
    let mut graph = graph(dimension);
    let added = add(&mut graph, "closures.csv", table.as_bytes(), options).unwrap();
    assert_eq!(graph.edges.len(), 4 + added.closures);
    (graph.edges_of(EdgeKind::Landmark).cloned().collect(), added)
}

fn ends(table: &str) -> Vec<(u64, u64)> {
    let (edges, _) = added(Dimension::Two, table, &ClosureOptions::default());
    edges.iter().map(|edge| (edge.from, edge.to)).collect()
}

fn information(dimension: Dimension, table: &str) -> Vec<f64> {
    added(dimension, table, &ClosureOptions::default()).0[0].information.clone().unwrap()
}

#[test]
fn ends_are_named_by_id_frame_or_time() {
    assert_eq!(ends("from,to\n0,4\n5,2\n"), [(0, 4), (5, 2)]);
    // The order of columns is free; a byte order mark, blanks, comments and blank lines do not count.
    assert_eq!(ends("\u{feff}to , from\n# checked by hand\n\n 4 , 0\n"), [(0, 4)]);
    let sessions = "session_from,frame_from,session_to,frame_to\na,20,b,0\nb,10,a,0\n";
    assert_eq!(ends(sessions), [(2, 3), (4, 0)]);
    // The nearest node: 1.04 s is 0.04 s from node 1.
    assert_eq!(ends("time_from,time_to\n0,100\n1.04,101.96\n"), [(0, 3), (1, 5)]);
    assert_eq!(ends("time_from,time_to,session_from,session_to\n0,102,a,b\n"), [(0, 5)]);
}

#[test]
fn frames_need_no_session_where_they_are_unique() {
    let mut graph = graph(Dimension::Two);
    graph.nodes.truncate(3);
    graph.edges.truncate(2);
    add(&mut graph, "x", b"frame_from,frame_to\n20,0\n", &ClosureOptions::default()).unwrap();
    assert_eq!((graph.edges[2].from, graph.edges[2].to), (2, 0));
}

#[test]
fn the_tolerance_of_times_is_an_option() {
    let options = ClosureOptions { time_tolerance: 0.4, ..ClosureOptions::default() };
    let (edges, _) = added(Dimension::Two, "time_from,time_to\n0.4,100\n", &options);
    assert_eq!((edges[0].from, edges[0].to), (0, 3));
}

#[test]
fn planar_measurements_have_x_y_theta() {
    let table = "from,to,x,y,theta,sigma_translation,sigma_rotation,score,label\n0,4,1.5,-2,0.25,0.5,0.1,0.75,1\n1,5,0,0,0,0.5,0.1,,0\n2,3,,,,0.5,0.1,3,\n";
    let (edges, summary) = added(Dimension::Two, table, &ClosureOptions::default());
    assert_eq!(summary, Added { closures: 3, unmeasured: 1, labelled: 2 });
    assert_eq!(edges[0].measurement.as_deref(), Some(&[1.5, -2.0, 0.25][..]));
    let information = edges[0].information.as_deref().unwrap();
    let expected = [4.0, 0.0, 0.0, 4.0, 0.0, 100.0];
    assert!(
        information.iter().zip(expected).all(|(found, term)| (found - term).abs() < 1e-9),
        "{information:?}"
    );
    assert_eq!(edges.iter().map(|edge| edge.score).collect::<Vec<_>>(), [Some(0.75), None, Some(3.0)]);
    let labels: Vec<Option<bool>> = edges.iter().map(Edge::truth_correct).collect();
    assert_eq!(labels, [Some(true), Some(false), None]);
    assert_eq!((edges[2].measurement.as_ref(), edges[2].information.as_ref()), (None, None));
    // New ids, above those of the graph.
    assert_eq!(edges.iter().map(|edge| edge.id).collect::<Vec<_>>(), [5, 6, 7]);
}

#[test]
fn spatial_measurements_have_a_quaternion() {
    let table =
        "from,to,x,y,z,qx,qy,qz,qw,sigma_translation,sigma_rotation\n0,4,1,2,3,0,0,0.70711,0.70711,1,0.5\n";
    let (edges, _) = added(Dimension::Three, table, &ClosureOptions::default());
    let measurement = edges[0].measurement.as_deref().unwrap();
    let half = 0.5_f64.sqrt();
    let expected = [1.0, 2.0, 3.0, 0.0, 0.0, half, half];
    assert!(
        measurement.iter().zip(expected).all(|(found, number)| (found - number).abs() < 1e-12),
        "{measurement:?}"
    );
    let information = edges[0].information.as_deref().unwrap();
    assert_eq!((information.len(), information[0], information[20]), (21, 1.0, 4.0));
}

#[test]
fn covariances_and_information_matrices_are_equal_ways_to_weight() {
    let row = "0,4,0,0,0";
    // The covariance [[2, 1], [1, 2]] of x and y, whose inverse is [[2, -1], [-1, 2]] / 3, and 0.25 of theta.
    let covariance = format!(
        "from,to,x,y,theta,cov_xx,cov_xy,cov_xtheta,cov_yy,cov_ytheta,cov_thetatheta\n{row},2,1,0,2,0,0.25\n"
    );
    let found = information(Dimension::Two, &covariance);
    let expected = [2.0 / 3.0, -1.0 / 3.0, 0.0, 2.0 / 3.0, 0.0, 4.0];
    assert!(found.iter().zip(expected).all(|(found, term)| (found - term).abs() < 1e-12), "{found:?}");
    let diagonal = format!("from,to,x,y,theta,cov_xx,cov_yy,cov_thetatheta\n{row},0.5,0.25,0.125\n");
    let found = information(Dimension::Two, &diagonal);
    assert!(
        found.iter().zip([2.0, 0.0, 0.0, 4.0, 0.0, 8.0]).all(|(found, term)| (found - term).abs() < 1e-12)
    );
    assert!(found.iter().all(|term| term.is_sign_positive()), "no -0 in the file: {found:?}");
    let given = format!("from,to,x,y,theta,info_xx,info_yy,info_thetatheta\n{row},2,4,8\n");
    assert_eq!(information(Dimension::Two, &given), [2.0, 0.0, 0.0, 4.0, 0.0, 8.0]);
    let spatial = "from,to,x,y,z,qx,qy,qz,qw,info_xx,info_yy,info_zz,info_rxrx,info_ryry,info_rzrz\n0,4,0,0,0,0,0,0,1,1,2,3,4,5,6\n";
    let found = information(Dimension::Three, spatial);
    let places = [0, 6, 11, 15, 18, 20].map(|place| found[place]);
    assert_eq!(places, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{found:?}");
}

#[test]
fn options_weight_what_the_table_does_not() {
    let options = ClosureOptions {
        closure_sigma_translation: Some(0.5),
        closure_sigma_rotation: Some(0.25),
        ..ClosureOptions::default()
    };
    let (edges, _) = added(Dimension::Two, "from,to,x,y,theta\n0,4,1,2,3\n", &options);
    assert_eq!(edges[0].information.as_deref(), Some(&[4.0, 0.0, 0.0, 4.0, 0.0, 16.0][..]));
}
