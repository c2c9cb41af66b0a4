//! Vectors and matrices of three dimensions, one in each lane. A matrix is an array of its columns.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;

use posecut_geometry::lanes::Lanes;

use super::three;

pub(super) type Vector<S> = [Lanes<S>; 3];
pub(super) type Matrix<S> = [Vector<S>; 3];

#[inline(always)]
pub(super) fn plus<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn minus<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn negated<S: Simd>(a: Vector<S>) -> Vector<S> {
    three!(row => -a[row])
}

#[inline(always)]
pub(super) fn scaled<S: Simd>(a: Vector<S>, factor: Lanes<S>) -> Vector<S> {
    three!(row => a[row] * factor)
}

/// `a * factor + b`.
#[inline(always)]
pub(super) fn scaled_plus<S: Simd>(a: Vector<S>, factor: Lanes<S>, b: Vector<S>) -> Vector<S> {
    three!(row => a[row].times_plus(factor, b[row]))
}

#[inline(always)]
pub(super) fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> Lanes<S> {
    a[0].times_plus(b[0], a[1].times_plus(b[1], a[2] * b[2]))
}

/// `a . b + c`.
#[inline(always)]
pub(super) fn dot_plus<S: Simd>(a: Vector<S>, b: Vector<S>, c: Lanes<S>) -> Lanes<S> {
    a[0].times_plus(b[0], a[1].times_plus(b[1], a[2].times_plus(b[2], c)))
}

#[inline(always)]
pub(super) fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    let entry = |i: usize, j: usize| a[i].times_plus(b[j], -(a[j] * b[i]));
    [entry(1, 2), entry(2, 0), entry(0, 1)]
}

/// `M a`.
#[inline(always)]
pub(super) fn times<S: Simd>(matrix: &Matrix<S>, a: Vector<S>) -> Vector<S> {
    three!(row => dot([matrix[0][row], matrix[1][row], matrix[2][row]], a))
}

/// `M^T a`.
#[inline(always)]
pub(super) fn transposed_times<S: Simd>(matrix: &Matrix<S>, a: Vector<S>) -> Vector<S> {
    three!(row => dot(matrix[row], a))
}

/// `M^T a + b`.
#[inline(always)]
pub(super) fn transposed_times_plus<S: Simd>(matrix: &Matrix<S>, a: Vector<S>, b: Vector<S>) -> Vector<S> {
    three!(row => dot_plus(matrix[row], a, b[row]))
}

#[inline(always)]
pub(super) fn transposed<S: Simd>(matrix: &Matrix<S>) -> Matrix<S> {
    three!(column => three!(row => matrix[row][column]))
}

/// `M + [s]`, where `[s] a = s x a`.
#[inline(always)]
pub(super) fn plus_cross<S: Simd>(matrix: &Matrix<S>, s: Vector<S>) -> Matrix<S> {
    let [[a, b, c], [d, e, f], [g, h, i]] = *matrix;
    let [x, y, z] = s;
    [[a, b + z, c - y], [d - z, e, f + x], [g + y, h - x, i]]
}

/// `a b^T`.
#[inline(always)]
pub(super) fn outer<S: Simd>(a: Vector<S>, b: Vector<S>) -> Matrix<S> {
    three!(column => scaled(a, b[column]))
}

#[inline(always)]
pub(super) fn plus_matrix<S: Simd>(a: &Matrix<S>, b: &Matrix<S>) -> Matrix<S> {
    three!(column => plus(a[column], b[column]))
}

/// `M + d I`.
#[inline(always)]
pub(super) fn plus_diagonal<S: Simd>(matrix: &Matrix<S>, d: Lanes<S>) -> Matrix<S> {
    let [[a, b, c], [e, f, g], [h, i, j]] = *matrix;
    [[a + d, b, c], [e, f + d, g], [h, i, j + d]]
}

/// A matrix that is symmetric, by its entries of the upper triangle.
macro_rules! symmetric {
    ($row:ident, $column:ident => $entry:expr) => {{
        let [a, b, c, d, e, f] = [
            {
                let ($row, $column) = (0, 0);
                $entry
            },
            {
                let ($row, $column) = (0, 1);
                $entry
            },
            {
                let ($row, $column) = (1, 1);
                $entry
            },
            {
                let ($row, $column) = (0, 2);
                $entry
            },
            {
                let ($row, $column) = (1, 2);
                $entry
            },
            {
                let ($row, $column) = (2, 2);
                $entry
            },
        ];
        [[a, b, d], [b, c, e], [d, e, f]]
    }};
}
pub(super) use symmetric;
