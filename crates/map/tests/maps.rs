//! Maps of small graphs.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_graph::PoseGraph;
use posecut_map::{Cell, Grid, MapError, Picture, ros, write_opacity};
use posecut_scan::Scans;

/// Two nodes, 1 m apart; the first sees a wall 2 m ahead and one 1 m to the left, the second nothing new.
fn graph() -> PoseGraph {
    let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"session":"a","pose":[0.25,0.25,0]}
{"kind":"node","id":1,"session":"a","pose":[1.25,0.25,0]}
{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"scan","node":0,"first_angle":0,"angle_step":1.5707963267948966,"ranges":[2,1]}
{"kind":"scan","node":1,"first_angle":0,"angle_step":1.5707963267948966,"ranges":[1,0]}
"#;
    PoseGraph::read("graph", text.as_bytes()).unwrap()
}

fn grid(graph: &PoseGraph) -> Grid {
    Grid::of_graph(graph, &Scans::of_graph(graph).unwrap(), 0.5, f64::INFINITY).unwrap()
}

/// The cells as text, the row of the largest y first.
fn text(grid: &Grid) -> String {
    let cell = |column, row| match grid.cell(column, row) {
        Cell::Occupied => '#',
        Cell::Free => '.',
        Cell::Unknown => ' ',
    };
    let line = |row: usize| (0..grid.width).map(|column| cell(column, row)).collect::<String>();
    (0..grid.height).rev().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn beams_free_the_cells_they_pass_and_occupy_those_they_end_in() {
    let grid = grid(&graph());
    assert_eq!((grid.corner.x, grid.corner.y), (-0.5, -0.5));
    assert_eq!(text(&grid), "       \n #     \n .     \n ....# \n       ");
    // Two beams end in the wall ahead: 1.7 in log-odds.
    assert!((grid.probability(5, 1) - 0.8455).abs() < 1e-4, "{}", grid.probability(5, 1));
    assert!((grid.probability(0, 0) - 0.5).abs() < 1e-12);
    assert_eq!((grid.count(Cell::Occupied), grid.count(Cell::Free)), (2, 5));
}

#[test]
fn long_beams_are_ignored_on_request() {
    let graph = graph();
    let grid = Grid::of_graph(&graph, &Scans::of_graph(&graph).unwrap(), 0.5, 1.5).unwrap();
    assert!((grid.probability(5, 1) - 0.7006).abs() < 1e-4, "one beam only");
}

#[test]
fn the_picture_has_the_trajectory_and_the_first_row_on_top() {
    let graph = graph();
    let grid = grid(&graph);
    let mut picture = Picture::of_grid(&grid);
    picture.draw_trajectories(&graph, &grid);
    let mut bytes = Vec::new();
    picture.write(&mut bytes).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels.len(), 35);
    // Unknown cells are in the middle of the greys, walls dark, the trajectory in the first colour.
    assert_eq!(pixels[..7], [124; 7]);
    assert!(pixels[8] < 80 && pixels[15] > 140, "{pixels:?}");
    assert_eq!(pixels[21..28], [124, 249, 249, 249, 171, 38, 124]);
}

#[test]
fn ink_is_opaque_on_walls_faint_on_floors_and_nothing_elsewhere() {
    let grid = grid(&graph());
    let mut bytes = Vec::new();
    write_opacity(&grid, &mut bytes).unwrap();
    let mut decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert!(pixels.chunks(4).all(|pixel| pixel[..3] == [0, 0, 0]), "one colour");
    let opacity: Vec<u8> = pixels.chunks(4).map(|pixel| pixel[3]).collect();
    assert_eq!(opacity.len(), 35, "7 cells are an odd row of half bytes");
    assert_eq!(opacity[..7], [0; 7]);
    // The wall to the left was hit once, that ahead twice: the probabilities are 0.70 and 0.85.
    assert_eq!(opacity[8], 102);
    assert_eq!(opacity[21..28], [0, 0, 0, 17, 17, 170, 0]);
}

#[test]
fn maps_of_ros_have_its_values_and_the_origin_of_the_lower_left_cell() {
    let grid = grid(&graph());
    let mut pgm = Vec::new();
    ros::write_pgm(&grid, &mut pgm).unwrap();
    let (head, pixels) = pgm.split_at(11);
    assert_eq!(head, b"P5\n7 5\n255\n");
    assert_eq!(pixels[21..28], [205, 254, 254, 254, 254, 0, 205]);
    let mut yaml = Vec::new();
    ros::write_yaml(&grid, "a \"b\".pgm", &mut yaml).unwrap();
    let expected = "image: \"a \\\"b\\\".pgm\"\nresolution: 0.5\norigin: [-0.500000, -0.500000, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    assert_eq!(String::from_utf8(yaml).unwrap(), expected);
}

#[test]
fn graphs_without_a_map_are_refused() {
    let refused = |graph: &PoseGraph, scans: &Scans, resolution| {
        Grid::of_graph(graph, scans, resolution, f64::INFINITY).unwrap_err()
    };
    let mut graph = graph();
    let scans = Scans::of_graph(&graph).unwrap();
    assert!(matches!(refused(&graph, &Scans::default(), 0.5), MapError::NoScans));
    assert!(matches!(refused(&graph, &scans, 1e-6), MapError::TooLarge { .. }));
    graph.nodes[1].pose = None;
    assert!(matches!(refused(&graph, &scans, 0.5), MapError::NoPose(1)));
    graph.header.dimension = posecut_graph::Dimension::Three;
    assert!(matches!(refused(&graph, &scans, 0.5), MapError::Spatial));
}

#[test]
fn poses_far_away_do_not_ask_for_all_memory() {
    let mut graph = graph();
    graph.nodes[1].pose = Some(vec![1e300, 0.0, 0.0]);
    let scans = Scans::of_graph(&graph).unwrap();
    let said = Grid::of_graph(&graph, &scans, 0.5, f64::INFINITY).unwrap_err().to_string();
    assert!(said.contains("increase --resolution"), "{said}");
}
