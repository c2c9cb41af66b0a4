//! Analysis, factorisation, solution and selected inverse on grids in the plane and in space.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{Factor, SelectedInverse, Symbolic};

/// The number of variables of a grid with these sides, and the pairs of neighbours.
fn grid(sides: [usize; 3]) -> (usize, Vec<(usize, usize)>) {
    let at = |x: usize, y: usize, z: usize| (z * sides[1] + y) * sides[0] + x;
    let mut pairs = Vec::new();
    for z in 0..sides[2] {
        for y in 0..sides[1] {
            for x in 0..sides[0] {
                let ahead = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
                for (i, j, k) in ahead {
                    if i < sides[0] && j < sides[1] && k < sides[2] {
                        pairs.push((at(x, y, z), at(i, j, k)));
                    }
                }
            }
        }
    }
    (sides.iter().product(), pairs)
}

fn measure<const D: usize>(criterion: &mut Criterion, name: &str, sides: [usize; 3]) {
    let (variables, pairs) = grid(sides);
    let symbolic = Symbolic::new(variables, &pairs, D);
    // At most six neighbours, with entries up to one half: the matrix is diagonally dominant.
    let entry = |index: usize| {
        SMatrix::<f64, D, D>::from_fn(|row, column| 0.5 * ((index * D + row * 3 + column) as f64).sin())
    };
    let off_diagonal: Vec<_> = (0..pairs.len()).map(entry).collect();
    let diagonal = vec![SMatrix::<f64, D, D>::identity() * (3.0 * D as f64 + 1.0); variables];
    let right = vec![SVector::<f64, D>::repeat(1.0); variables];
    let mut factor = Factor::<D>::new(&symbolic);
    let mut group = criterion.benchmark_group(format!("{name}, {D} x {D}"));
    group.sample_size(10).throughput(Throughput::Elements(symbolic.flops() as u64));
    group.bench_function(BenchmarkId::from_parameter("analysis"), |bencher| {
        bencher.iter(|| Symbolic::new(variables, &pairs, D));
    });
    group.bench_function(BenchmarkId::from_parameter("factorisation"), |bencher| {
        bencher.iter(|| factor.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0; D]));
    });
    group.bench_function(BenchmarkId::from_parameter("solution"), |bencher| {
        bencher.iter(|| {
            let mut values = right.clone();
            factor.solve(&symbolic, &mut values);
            values
        });
    });
    group.bench_function(BenchmarkId::from_parameter("selected inverse"), |bencher| {
        bencher.iter(|| SelectedInverse::new(&symbolic, &mut factor));
    });
    group.finish();
}

fn grids(criterion: &mut Criterion) {
    measure::<3>(criterion, "plane 100 x 100", [100, 100, 1]);
    measure::<6>(criterion, "plane 60 x 60", [60, 60, 1]);
    measure::<6>(criterion, "space 12 x 12 x 12", [12, 12, 12]);
}

criterion_group!(benches, grids);
criterion_main!(benches);
