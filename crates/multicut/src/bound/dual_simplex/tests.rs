//! The method against enumeration of vertices of random small programs.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{DualSimplex, End};
use crate::budget::Budget;

/// The optimum of `costs * x` over a fine set of candidates: all vertices of the polytope of bounds and rows, by solving every
/// square subsystem. `None` if no vertex is feasible.
fn by_vertices(costs: &[f64], bounds: &[(f64, f64)], rows: &[(Vec<(u32, f64)>, f64)]) -> Option<f64> {
    let count = costs.len();
    let mut planes: Vec<(Vec<f64>, f64)> = Vec::new();
    for (column, &(lower, upper)) in bounds.iter().enumerate() {
        let mut unit = vec![0.0; count];
        unit[column] = 1.0;
        planes.push((unit.clone(), lower));
        planes.push((unit, upper));
    }
    let dense = |entries: &[(u32, f64)]| {
        let mut row = vec![0.0; count];
        for &(column, a) in entries {
            row[column as usize] += a;
        }
        row
    };
    planes.extend(rows.iter().map(|(entries, least)| (dense(entries), *least)));
    let mut best: Option<f64> = None;
    for code in 0u32..1 << planes.len() {
        if code.count_ones() as usize != count {
            continue;
        }
        let mut system: Vec<Vec<f64>> = (0..planes.len())
            .filter(|plane| code >> plane & 1 == 1)
            .map(|plane| [planes[plane].0.as_slice(), &[planes[plane].1]].concat())
            .collect();
        let Some(point) = gauss(&mut system) else { continue };
        let inside = point.iter().zip(bounds).all(|(x, b)| *x >= b.0 - 1e-7 && *x <= b.1 + 1e-7)
            && rows.iter().all(|(entries, least)| {
                entries.iter().map(|&(column, a)| a * point[column as usize]).sum::<f64>() >= least - 1e-7
            });
        if inside {
            let value = costs.iter().zip(&point).map(|(c, x)| c * x).sum::<f64>();
            best = Some(best.map_or(value, |best| best.min(value)));
        }
    }
    best
}

fn gauss(system: &mut [Vec<f64>]) -> Option<Vec<f64>> {
    let count = system.len();
    for column in 0..count {
        let pivot =
            (column..count).max_by(|&a, &b| system[a][column].abs().total_cmp(&system[b][column].abs()))?;
        if system[pivot][column].abs() < 1e-9 {
            return None;
        }
        system.swap(column, pivot);
        for row in 0..count {
            if row != column {
                let (factor, own) = (system[row][column] / system[column][column], system[column].clone());
                for (value, own) in system[row].iter_mut().zip(own) {
                    *value -= factor * own;
                }
            }
        }
    }
    Some((0..count).map(|row| system[row][count] / system[row][row]).collect())
}

#[test]
fn rows_come_and_bounds_change_and_every_optimum_is_right() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let budget = &mut Budget::new(None, None);
    let (mut infeasible, mut optimal) = (0, 0);
    for round in 0..150 {
        let count = random.random_range(2..=4);
        // Integer costs and coefficients make ties.
        let costs: Vec<f64> = (0..count).map(|_| f64::from(random.random_range(0..=3))).collect();
        let mut simplex = DualSimplex::new(costs.clone());
        let mut bounds = vec![(0.0, 1.0); count];
        let mut rows: Vec<(Vec<(u32, f64)>, f64)> = Vec::new();
        for step in 0..6 {
            if step < 4 {
                let entries: Vec<(u32, f64)> = (0..count as u32)
                    .filter_map(|column| {
                        let a = f64::from(random.random_range(-1..=2));
                        (a != 0.0).then_some((column, a))
                    })
                    .collect();
                let least = f64::from(random.random_range(-1..=2));
                simplex.add_row(entries.clone(), least);
                rows.push((entries, least));
            }
            let column = random.random_range(0..count);
            bounds[column] = [(0.0, 1.0), (0.0, 0.0), (1.0, 1.0)][random.random_range(0..3)];
            simplex.set_bounds(column as u32, bounds[column].0, bounds[column].1);
            let end = simplex.run(|_| false, 1000, budget);
            match by_vertices(&costs, &bounds, &rows) {
                None => {
                    assert_eq!(end, End::Infeasible, "round {round}");
                    infeasible += 1;
                }
                Some(best) => {
                    assert_eq!(end, End::Optimal, "round {round}");
                    assert!((simplex.objective() - best).abs() < 1e-7, "round {round}");
                    optimal += 1;
                }
            }
        }
    }
    assert!(infeasible > 50 && optimal > 300, "{infeasible} {optimal}");
}
