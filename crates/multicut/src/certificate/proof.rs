//! Proofs of lower bounds, and their text format.

use std::io::Write;

use super::tree::CaseTree;
use crate::bound::conflict::Conflict;
use crate::bound::packing::Packed;
use crate::reduce::decomposition::Trace;
use crate::reduce::reduction::Step;

/// Proof that a kernel costs at least its bound. Nodes are those of the kernel.
#[derive(Debug, Clone)]
pub(crate) enum Proof {
    /// Disjoint conflicts.
    Packing(Vec<Packed>),
    /// Separating the ends of one of `edges`, but of none before it, lifts the packing's bound by the residual that connects them, so the
    /// rest of the proof may reward joining them.
    Fixed { conflicts: Vec<Packed>, edges: Vec<(u32, u32)>, reward: f64, rest: Reduced },
    /// Conflicts, and windows that share the capacity left by them, each with its own proof.
    Windows { conflicts: Vec<Packed>, windows: Vec<Cutout> },
    /// Two cases: the ends of an edge are joined or apart. The proof of each may reward its case.
    Branch { edge: (u32, u32), reward: f64, joined: Reduced, apart: Reduced },
    /// Cases with weights of inequalities.
    Tree(CaseTree),
}

/// A window of a kernel: some of its nodes, edges between positions in `nodes` with the capacity that the window takes, signed as
/// the edge, and a proof for the graph that they make.
#[derive(Debug, Clone)]
pub(crate) struct Cutout {
    pub(crate) nodes: Vec<u32>,
    pub(crate) edges: Vec<(u32, u32, f64)>,
    pub(crate) proof: Reduced,
}

/// A proof for a graph by reductions, with proofs for the kernels that they leave.
#[derive(Debug, Clone)]
pub(crate) struct Reduced {
    pub(crate) trace: Vec<Trace>,
    pub(crate) kernels: Vec<Proof>,
}

/// A solution and the proof of its lower bound, to be written to a file and checked by [`verify`](crate::verify()).
///
/// The format is text, with one statement on each line, and with the numbers that it needs:
///
/// ```text
/// POSECUT-MULTICUT-CERTIFICATE 1
/// labels 0 0 1 …                 one for each node
/// component 4 7 8 …              nodes of a part of the graph, numbered 0, 1, … from here on
/// reduce 2                       number of pieces that follow
/// piece - 0 1 2 …                the whole; steps follow
/// i NODE                         isolate a node without attraction
/// 2 NODE                         eliminate a node of degree two
/// d KEPT GONE                    contract by dominance
/// t KEPT GONE APEX               contract by the triangle rule
/// p KEPT GONE S S S              contract by the rule of pairs: shares of GONE to KEPT, KEPT to GONE, both out
/// piece 0 2 5 …                  a part of piece 0 with its edges; a kernel is followed by its proof:
/// pack 3                         three conflicts. A cycle: weight, then nodes (numbered within the
/// 1 0 1 4                        piece), the last and the first joined by the repulsive edge. A wheel:
/// wheel 1 1 2 3 / 0 1 / 0 2 / 0 3   weight, rim, and a spoke from the centre for each repulsive edge of
///                                the rim, in order, to where the rim enters it
/// fix 1 2 99                     one conflict, two edges (tail head) whose ends are joined, each by the
///                                capacity left once those before it are, reward; then reduce …
/// windows 3 2                    three conflicts, two windows
/// window 4 7 8 9                 nodes of the kernel, numbered 0, 1, … in this window; edges of the kernel with
/// edges 0 1 0.5 1 2 -1           the capacity that the window takes, signed as the edge; then reduce …
/// branch 3 8 99                  edge and reward; then reduce … if joined, and reduce … if apart
/// tree 3 4                       three inequalities, four cases. Conflicts as above, their weight being of no
/// 1 0 1 4                        account; also:
/// parts 1 0 / 1 2 3              two sets, smaller first: edges between attract, edges inside repel
/// any 1 5 6 7                    a cycle whose edges have any sign
/// split 3 8                      a case in two: edge not paid (the next case), and paid (the case after that ends)
/// leaf 0 1.5 2 0.5               number of an inequality and its weight, repeated
/// fixed 1 0 1.5                  one edge, weights; then the edge, and the payment from which deviating costs
/// 2 4 0                          more than the bound; then the case in which it does not deviate
/// end
/// ```
///
/// Bounds of parts add up, because no edge is in two of them. Edges outside all parts count with their cost if it is
/// negative. An edge is *paid* if it attracts and is cut, or repels and is not. The bound of a kernel is the sum of its negative costs and the packed weights (times (k + 1) / 2 for a wheel
/// with k spokes), rounded up if all its costs are integers.
#[derive(Debug, Clone)]
pub struct Certificate {
    pub(crate) labels: Vec<u32>,
    pub(crate) components: Vec<(Vec<u32>, Reduced)>,
}

/// First line of a certificate.
pub(crate) const MAGIC: &str = "POSECUT-MULTICUT-CERTIFICATE 1";

impl Certificate {
    /// Writes the certificate without buffering.
    pub fn write(&self, output: &mut impl Write) -> std::io::Result<()> {
        writeln!(output, "{MAGIC}")?;
        write_line(output, "labels", &self.labels)?;
        for (nodes, reduced) in &self.components {
            write_line(output, "component", nodes)?;
            write_reduced(output, reduced)?;
        }
        writeln!(output, "end")
    }
}

fn write_line(output: &mut impl Write, word: &str, numbers: &[u32]) -> std::io::Result<()> {
    write!(output, "{word}")?;
    for number in numbers {
        write!(output, " {number}")?;
    }
    writeln!(output)
}

fn write_reduced(output: &mut impl Write, reduced: &Reduced) -> std::io::Result<()> {
    writeln!(output, "reduce {}", reduced.trace.len())?;
    for piece in &reduced.trace {
        let parent = piece.parent.map_or_else(|| "-".into(), |parent| parent.to_string());
        write_line(output, &format!("piece {parent}"), &piece.names)?;
        for step in &piece.steps {
            match step {
                Step::Isolate { node } => writeln!(output, "i {node}")?,
                Step::DegreeTwo { node } => writeln!(output, "2 {node}")?,
                Step::Dominance { kept, gone } => writeln!(output, "d {kept} {gone}")?,
                Step::Triangle { kept, gone, apex } => writeln!(output, "t {kept} {gone} {apex}")?,
                Step::Pair { kept, gone, shares: [here, there, out] } => {
                    writeln!(output, "p {kept} {gone} {here} {there} {out}")?;
                }
            }
        }
        if let Some(conflicts) = &piece.packed {
            write_packing(output, conflicts)?;
        } else if let Some(proof) = piece.kernel.and_then(|kernel| reduced.kernels.get(kernel)) {
            write_proof(output, proof)?;
        }
    }
    Ok(())
}

fn write_proof(output: &mut impl Write, proof: &Proof) -> std::io::Result<()> {
    match proof {
        Proof::Packing(conflicts) => write_packing(output, conflicts),
        Proof::Fixed { conflicts, edges, reward, rest } => {
            writeln!(output, "fix {} {} {reward}", conflicts.len(), edges.len())?;
            write_conflicts(output, conflicts)?;
            for (tail, head) in edges {
                writeln!(output, "{tail} {head}")?;
            }
            write_reduced(output, rest)
        }
        Proof::Windows { conflicts, windows } => {
            writeln!(output, "windows {} {}", conflicts.len(), windows.len())?;
            write_conflicts(output, conflicts)?;
            for window in windows {
                write_line(output, "window", &window.nodes)?;
                write!(output, "edges")?;
                for (tail, head, capacity) in &window.edges {
                    write!(output, " {tail} {head} {capacity}")?;
                }
                writeln!(output)?;
                write_reduced(output, &window.proof)?;
            }
            Ok(())
        }
        Proof::Branch { edge: (tail, head), reward, joined, apart } => {
            writeln!(output, "branch {tail} {head} {reward}")?;
            write_reduced(output, joined)?;
            write_reduced(output, apart)
        }
        Proof::Tree(tree) => tree.write(output),
    }
}

fn write_packing(output: &mut impl Write, conflicts: &[Packed]) -> std::io::Result<()> {
    writeln!(output, "pack {}", conflicts.len())?;
    write_conflicts(output, conflicts)
}

fn write_conflicts(output: &mut impl Write, conflicts: &[Packed]) -> std::io::Result<()> {
    conflicts.iter().try_for_each(|Packed { conflict, weight }| write_conflict(output, *weight, conflict))
}

/// Writes a conflict with its weight.
pub(super) fn write_conflict(
    output: &mut impl Write,
    weight: f64,
    conflict: &Conflict,
) -> std::io::Result<()> {
    let list =
        |output: &mut dyn Write, nodes: &[u32]| nodes.iter().try_for_each(|node| write!(output, " {node}"));
    match conflict {
        Conflict::Cycle(nodes) => {
            write!(output, "{weight}")?;
            list(output, nodes)?;
        }
        Conflict::Wheel(wheel) => {
            write!(output, "wheel {weight}")?;
            list(output, &wheel.rim)?;
            for spoke in &wheel.spokes {
                write!(output, " /")?;
                list(output, spoke)?;
            }
        }
        Conflict::Parts(parts) => {
            write!(output, "parts {weight}")?;
            list(output, &parts.few)?;
            write!(output, " /")?;
            list(output, &parts.many)?;
        }
    }
    writeln!(output)
}
