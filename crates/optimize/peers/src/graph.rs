//! The g2o graph that every solver gets: vertices 0 to n - 1, all present, as posecut-convert writes them.

use std::fmt::Write as _;

pub struct Edge {
    pub from: usize,
    pub to: usize,
    /// `x y theta` or `x y z qx qy qz qw`.
    pub measurement: Vec<f64>,
    /// Full matrix, row-major; translation before rotation.
    pub information: Vec<Vec<f64>>,
}

pub struct Graph {
    pub planar: bool,
    pub poses: Vec<Vec<f64>>,
    pub edges: Vec<Edge>,
    text: String,
}

impl Graph {
    pub fn read(path: &str) -> Self {
        let text = std::fs::read_to_string(path).expect("the graph can be read");
        let planar = text.contains("EDGE_SE2");
        let (components, size) = if planar { (3, 3) } else { (7, 6) };
        let mut graph = Self { planar, poses: Vec::new(), edges: Vec::new(), text: String::new() };
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let numbers = |from: usize| -> Vec<f64> {
                words[from..].iter().map(|word| word.parse().expect("a number")).collect()
            };
            match words.first() {
                Some(&("VERTEX_SE2" | "VERTEX_SE3:QUAT")) => {
                    assert_eq!(words[1].parse(), Ok(graph.poses.len()), "vertices are numbered from 0, in order");
                    graph.poses.push(numbers(2));
                }
                Some(&("EDGE_SE2" | "EDGE_SE3:QUAT")) => {
                    let all = numbers(3);
                    let mut terms = all[components..].iter();
                    let mut information = vec![vec![0.0; size]; size];
                    for row in 0..size {
                        for column in row..size {
                            let term = *terms.next().expect("an upper triangle");
                            information[row][column] = term;
                            information[column][row] = term;
                        }
                    }
                    graph.edges.push(Edge {
                        from: words[1].parse().expect("an id"),
                        to: words[2].parse().expect("an id"),
                        measurement: all[..components].to_vec(),
                        information,
                    });
                }
                _ => {}
            }
        }
        graph.text = text;
        graph
    }

    /// The graph with other poses, in the same format.
    pub fn write(&self, poses: &[Vec<f64>], path: &str) {
        let mut out = String::new();
        for line in self.text.lines() {
            let mut words = line.split_whitespace();
            let tag = words.next().unwrap_or("");
            if tag.starts_with("VERTEX_SE") {
                let id: usize = words.next().and_then(|word| word.parse().ok()).expect("an id");
                write!(out, "{tag} {id}").expect("a string takes text");
                for value in &poses[id] {
                    write!(out, " {value}").expect("a string takes text");
                }
                out.push('\n');
            } else {
                out.push_str(line);
                out.push('\n');
            }
        }
        std::fs::write(path, out).expect("the result can be written");
    }
}

/// The result of a run: poses as in the file, and the number of iterations, if the solver reports it.
pub struct Outcome {
    pub seconds: f64,
    pub poses: Vec<Vec<f64>>,
    pub iterations: Option<usize>,
}
