//! Sums of small dense matrices, factored sparsely.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

/// Most entries of a factor, and most products: one gigabyte. Larger programs keep the bound that they have.
const LARGEST: usize = 1 << 27;

/// `diag(d) + sum of s_q v_q v_q'` over cliques `q` with sparse vectors `v_q`: pattern, factor and scratch.
pub(crate) struct CliqueMatrix {
    /// The vectors, sorted by index.
    cliques: Vec<Vec<(u32, f32)>>,
    /// The occurrences of each index: clique, and position in it.
    holding: Vec<Vec<(u32, u32)>>,
    pattern: SymbolicSparseColMat<usize>,
    matrix: Vec<f64>,
    /// One dense column; zero between uses.
    sums: Vec<f64>,
    products: usize,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl CliqueMatrix {
    /// `None` if the matrix would be too large.
    pub(crate) fn new(size: usize, mut cliques: Vec<Vec<(u32, f32)>>) -> Option<Self> {
        let products: usize = cliques.iter().map(|clique| clique.len() * clique.len() / 2).sum();
        if products > LARGEST {
            return None;
        }
        let mut holding: Vec<Vec<(u32, u32)>> = vec![Vec::new(); size];
        for (index, clique) in cliques.iter_mut().enumerate() {
            clique.sort_unstable_by_key(|entry| entry.0);
            for (place, &(entry, _)) in clique.iter().enumerate() {
                holding[entry as usize].push((index as u32, place as u32));
            }
        }
        let (starts, row_indices) = pattern(&cliques, &holding);
        let matrix = vec![0.0; row_indices.len()];
        let pattern = SymbolicSparseColMat::new_checked(size, size, starts, None, row_indices);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        if symbolic.len_val() > LARGEST {
            return None;
        }
        let request = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let scratch = MemBuffer::try_new(request).ok()?;
        let (sums, factor) = (vec![0.0; size], Vec::new());
        Some(Self { cliques, holding, pattern, matrix, sums, products, symbolic, factor, scratch })
    }

    /// Work of one factorisation, in visited entries: with a fill of `k` entries in each column, each entry costs about `k`
    /// operations.
    pub(crate) fn work(&self) -> u64 {
        let columns = self.holding.len().max(1) as u64;
        let fill = self.symbolic.len_val() as u64;
        self.products as u64 + fill + fill * (fill / columns) / 64
    }

    /// `None` if the matrix is not positive definite to working precision.
    pub(crate) fn factorise(&mut self, diagonal: &[f64], scales: &[f64]) -> Option<()> {
        let mut values = self.matrix.iter_mut();
        for (column, &own) in diagonal.iter().enumerate() {
            self.sums[column] = own;
            for &(clique, place) in &self.holding[column] {
                let entries = &self.cliques[clique as usize][place as usize..];
                let scale = scales[clique as usize] * f64::from(entries[0].1);
                for &(row, coefficient) in entries {
                    self.sums[row as usize] += scale * f64::from(coefficient);
                }
            }
            for (&row, value) in self.pattern.row_idx_of_col_raw(column).iter().zip(values.by_ref()) {
                *value = std::mem::take(&mut self.sums[row]);
            }
        }
        self.factor.resize(self.symbolic.len_val(), 0.0);
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.matrix);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                faer::linalg::cholesky::llt::factor::LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.scratch),
                faer::Spec::default(),
            )
            .ok()?;
        Some(())
    }

    /// Replaces a right-hand side by the solution.
    pub(crate) fn solve(&mut self, right: &mut [f64]) {
        let count = right.len();
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(right, count, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
    }
}

/// Column starts and sorted row indices of the lower triangle.
fn pattern(cliques: &[Vec<(u32, f32)>], holding: &[Vec<(u32, u32)>]) -> (Vec<usize>, Vec<usize>) {
    let mut last = vec![u32::MAX; holding.len()];
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for (column, holding) in holding.iter().enumerate() {
        let start = rows.len();
        last[column] = column as u32;
        rows.push(column);
        for &(clique, place) in holding {
            for &(entry, _) in &cliques[clique as usize][place as usize + 1..] {
                if std::mem::replace(&mut last[entry as usize], column as u32) != column as u32 {
                    rows.push(entry as usize);
                }
            }
        }
        rows[start..].sort_unstable();
        starts.push(rows.len());
    }
    (starts, rows)
}
