//! Reductions: decisions that hold in some optimum, made before any search.
//!
//! [`reduction`] isolates, eliminates and contracts nodes: degrees one and two, dominance (Lange, Karrenbauer, Andres, ICML
//! 2018), triangles (after Lange, Andres, Swoboda, CVPR 2019), and pairs ([`pair_rule`]); they state and prove each rule.
//! [`blocks`] splits a graph into biconnected blocks, which are independent because every cycle lies in one block (Hopcroft,
//! Tarjan, CACM 1973). [`decomposition`] alternates both until only kernels remain, and joins the nodes of blocks that a
//! complete packing closes.
//!
//! Depends on [`graph`](crate::graph), and on [`bound`](crate::bound) for complete packings.

pub(crate) mod blocks;
pub(crate) mod decomposition;
pub(crate) mod pair_rule;
pub(crate) mod reduction;
