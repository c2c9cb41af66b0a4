//! Proofs by a tree of cases, each with weights of inequalities.

use std::io::Write;

use super::proof::write_conflict;
use crate::bound::cut::Cut;

/// Weights of inequalities, by their numbers.
pub(crate) type Weights = Vec<(u32, f64)>;

/// A case of the proof.
#[derive(Debug, Clone)]
pub(crate) enum Case {
    /// The weights prove the bound of this case.
    Leaf(Weights),
    /// An edge is not paid in the first case, and paid in the second.
    Split { edge: (u32, u32), cases: [usize; 2] },
    /// The weights prove the bound if one of the edges deviates from its stated payment; `rest` is the case in which none
    /// does.
    Fix { weights: Weights, edges: Vec<((u32, u32), bool)>, rest: usize },
}

/// A tree of cases; the first one is the root.
///
/// Weights `w >= 0` of inequalities `a x >= b` prove the bound `sum of negative costs + w b + sum over edges of the least of
/// r_e x_e`, with `r = |c| - w a`, where `x_e` is 0, 1 or either, as the case says.
#[derive(Debug, Clone)]
pub(crate) struct CaseTree {
    pub(crate) cuts: Vec<Cut>,
    pub(crate) cases: Vec<Case>,
}

impl CaseTree {
    pub(crate) fn write(&self, output: &mut impl Write) -> std::io::Result<()> {
        // Only inequalities with a weight are written, numbered by first use.
        let order = self.preorder();
        let mut number = vec![u32::MAX; self.cuts.len()];
        let mut used = Vec::new();
        for &case in &order {
            let (Case::Leaf(weights) | Case::Fix { weights, .. }) = &self.cases[case] else { continue };
            for &(cut, _) in weights {
                if number[cut as usize] == u32::MAX {
                    number[cut as usize] = used.len() as u32;
                    used.push(cut);
                }
            }
        }
        writeln!(output, "tree {} {}", used.len(), order.len())?;
        for cut in used {
            match &self.cuts[cut as usize] {
                Cut::Conflict(conflict) => write_conflict(output, 1.0, conflict)?,
                Cut::Cycle(nodes) => {
                    write!(output, "any 1")?;
                    for node in nodes {
                        write!(output, " {node}")?;
                    }
                    writeln!(output)?;
                }
            }
        }
        for case in order {
            match &self.cases[case] {
                Case::Leaf(weights) => write_weights(output, "leaf", weights, &number)?,
                Case::Split { edge: (tail, head), .. } => writeln!(output, "split {tail} {head}")?,
                Case::Fix { weights, edges, .. } => {
                    write_weights(output, &format!("fixed {}", edges.len()), weights, &number)?;
                    for ((tail, head), paid) in edges {
                        writeln!(output, "{tail} {head} {}", u8::from(*paid))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn preorder(&self) -> Vec<usize> {
        let mut order = Vec::new();
        let mut open = vec![0];
        while let Some(case) = open.pop() {
            order.push(case);
            match &self.cases[case] {
                Case::Leaf(_) => {}
                Case::Split { cases: [first, second], .. } => open.extend([*second, *first]),
                Case::Fix { rest, .. } => open.push(*rest),
            }
        }
        order
    }
}

fn write_weights(
    output: &mut impl Write,
    word: &str,
    weights: &Weights,
    number: &[u32],
) -> std::io::Result<()> {
    write!(output, "{word}")?;
    for &(cut, weight) in weights {
        write!(output, " {} {weight}", number[cut as usize])?;
    }
    writeln!(output)
}
