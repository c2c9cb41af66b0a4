//! Multifrontal Cholesky factorisation of sparse symmetric matrices made of small square blocks, and parts of the inverse.
//!
//! The matrix `A` is positive definite, and a block row belongs to one variable: a pose, say, with blocks of 3 x 3 or 6 x 6.
//!
//! 1. [`Symbolic::new`] looks only at the pattern. It chooses a fill-reducing order `P` of the variables: approximate minimum
//!    degree (Amestoy, Davis, Duff, 1996) or, where that takes many operations, nested dissection (George, 1973) if this takes fewer. The
//!    elimination tree (Liu, 1990) gives the structure of the factor and its *fronts*: sets of variables that are eliminated
//!    together as one dense matrix. All of this counts blocks, 9 to 36 times fewer than scalars. One analysis serves every
//!    block size.
//! 2. [`Factor::factorize`] computes `P A P^T = L L^T` (Duff and Reid, 1983). Each front gathers its columns of the matrix and
//!    the update matrices of its children, eliminates its columns `[A_11; A_21]`, and leaves its own *update matrix* to its
//!    parent:
//!
//!    ```text
//!    A_11 = L L^T,   M = A_21 L^-T,   U = A_22 - M M^T
//!    ```
//! 3. [`Factor::solve`] solves `L y = P b` up the tree and `L^T x = y` down.
//!    [`MixedFactor`] stores a very large factor in single precision and solves by conjugate gradients.
//! 4. [`SelectedInverse`] has the blocks of `A^-1` where `L` has blocks, front by front from the roots down (Takahashi, Fagan, Chen,
//!    1973). With the rows `R` below a front's columns `J`, whose inverse the parent knows,
//!
//!    ```text
//!    W = M L^-1,   Z_RJ = -Z_RR W,   Z_JJ = L^-T L^-1 - W^T Z_RJ
//!    ```
//!
//!    [`Factor::inverse_column`] solves for any other block, along the paths of the tree alone.
//!
//! [`fronts`] has the dense kernels for a program that keeps its own tree of fronts.
//!
//! # Complexity
//!
//! With `n` variables, `|L|` blocks in the factor and blocks of order `D`: analysis takes time proportional to `|L|`, plus
//! the time of the ordering. Factorisation takes [`Symbolic::flops`] operations, the sum over columns of their squared
//! length. Solving takes `4 D^2 |L|` operations, and the selected inverse about twice those of the factorisation. Nested
//! dissection gives O(n log n) blocks and O(n^1.5) operations on a planar grid, and O(n^(4/3)) and O(n^2) on a grid in space.
//! [`Factor::new`] reserves all memory; factorising and solving allocate nothing.
//!
//! # The same bits
//!
//! Results depend only on the input, not on the number of threads: fixed rules choose the subtrees that threads take and the
//! strips of very large fronts, and every sum has a fixed order.
//!
//! # Example
//!
//! A chain of three variables, `-x_{i-1} + 3 x_i - x_{i+1} = 1`:
//!
//! ```
//! use nalgebra::{Matrix2, Vector2};
//! use posecut_cholesky::{Factor, SelectedInverse, Symbolic};
//!
//! let pairs = [(0, 1), (1, 2)];
//! let symbolic = Symbolic::new(3, &pairs, 2);
//! let mut factor = Factor::<2>::new(&symbolic);
//! let diagonal = [Matrix2::identity() * 3.0; 3];
//! let off_diagonal = [-Matrix2::identity(); 2];
//! factor.factorize(&symbolic, &diagonal, &off_diagonal, 0.0, [0.0; 2])?;
//! let mut values = [Vector2::repeat(1.0); 3];
//! factor.solve(&symbolic, &mut values);
//! assert!((values[1].x - 5.0 / 7.0).abs() < 1e-15);
//!
//! let inverse = SelectedInverse::new(&symbolic, &mut factor);
//! let block = inverse.block(&symbolic, 1, 1).expect("the factor has every diagonal block");
//! assert!((block[(0, 0)] - 3.0 / 7.0).abs() < 1e-15);
//! # Ok::<(), posecut_cholesky::Breakdown>(())
//! ```

mod adjacency;
pub mod fronts;
pub mod instructions;
mod inverse_column;
mod matrix;
mod mixed;
mod ordering;
mod selected_inverse;
mod symbolic;
pub mod vectors;

pub use adjacency::Adjacency;
pub use fronts::breakdown::Breakdown;
pub use fronts::factor::{Factor, Memory, SINGULAR};
pub use inverse_column::Workspace;
pub use matrix::Matrix;
pub use mixed::{End, MixedFactor};
pub use selected_inverse::SelectedInverse;
pub use symbolic::Symbolic;
