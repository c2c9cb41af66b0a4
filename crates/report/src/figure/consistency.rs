//! Draws which candidates of PCM agree with each other.

use posecut_graph::PoseGraph;

use super::colours;
use super::plotting::{self, Drawing};
use crate::consistency::{Matrix, clique_first};

/// One matrix a graph, the clique first. Rows and columns are candidates, cells are pairs.
pub fn drawing(graphs: &[(String, PoseGraph, Matrix)]) -> anyhow::Result<Drawing> {
    let shown: Vec<Shown> =
        graphs.iter().map(|(title, graph, matrix)| Shown::new(title, graph, matrix)).collect();
    let closures: Vec<_> = shown
        .iter()
        .map(|one| {
            let colour = move |row: usize, column: usize| one.colour(row, column);
            let wrong = move |row: usize| one.wrong(row).then_some(colours::INCORRECT);
            let kept = move |row: usize| one.kept(row).then_some(colours::CLIQUE);
            (one, colour, wrong, kept)
        })
        .collect();
    let strips: Vec<[&dyn Fn(usize) -> Option<&'static str>; 2]> = closures
        .iter()
        .map(|(_, _, wrong, kept)| [wrong as &dyn Fn(usize) -> Option<&'static str>, kept])
        .collect();
    let matrices: Vec<plotting::Matrix> = closures
        .iter()
        .zip(&strips)
        .map(|((one, colour, _, _), strips)| plotting::Matrix {
            title: &one.title,
            count: one.order.len(),
            colour,
            strips,
        })
        .collect();
    plotting::matrices(
        &matrices,
        &[
            (colours::CLIQUE, "consistent, both kept (strip: kept)"),
            (colours::AGREE, "consistent, not both kept"),
            (colours::INCORRECT, "consistent, at least one incorrect (strip: incorrect)"),
            (colours::GROUND, "not consistent"),
        ],
    )
}

struct Shown<'a> {
    title: String,
    graph: &'a PoseGraph,
    matrix: &'a Matrix,
    order: Vec<usize>,
}

impl<'a> Shown<'a> {
    fn new(title: &str, graph: &'a PoseGraph, matrix: &'a Matrix) -> Self {
        let kept = matrix.clique.iter().filter(|kept| **kept).count();
        let mut one = Self { title: String::new(), graph, matrix, order: clique_first(matrix) };
        // Put incorrect candidates at the end of the clique, where they are visible. The sort is stable.
        let incorrect = |row: usize| graph.edges[matrix.edges[row]].truth_correct() == Some(false);
        one.order.sort_by_key(|&row| {
            (matrix.group[row], !matrix.clique[row], matrix.clique[row] && incorrect(row))
        });
        let count = one.order.len();
        let wrong: Vec<usize> = (0..count).filter(|&row| one.wrong(row)).collect();
        let through = wrong.iter().filter(|&&row| one.kept(row)).count();
        one.title = format!(
            "{title}: {count} candidates, {kept} kept; {} incorrect, {through} of them kept",
            wrong.len()
        );
        one
    }

    fn wrong(&self, row: usize) -> bool {
        self.graph.edges[self.matrix.edges[self.order[row]]].truth_correct() == Some(false)
    }

    fn kept(&self, row: usize) -> bool {
        self.matrix.clique[self.order[row]]
    }

    fn colour(&self, row: usize, column: usize) -> &'static str {
        if !self.matrix.consistent(self.order[row], self.order[column]) {
            colours::GROUND
        } else if self.wrong(row) || self.wrong(column) {
            colours::INCORRECT
        } else if self.kept(row) && self.kept(column) {
            colours::CLIQUE
        } else {
            colours::AGREE
        }
    }
}
