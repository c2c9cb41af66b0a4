//! Makes cliques of pivots: a pivot joins its parent's clique where this adds few explicit zeros.

use crate::order::Pivot;

/// The plan of a clique. Variables are numbered as in the quotient graph.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    /// Frontal variables, then the separator, each in the order of elimination.
    pub(crate) variables: Vec<usize>,
    /// Number of frontal variables.
    pub(crate) frontals: usize,
    /// Index of the parent among the plans.
    pub(crate) parent: Option<usize>,
    /// Given elements (subtrees that stay) that become children.
    pub(crate) given: Vec<usize>,
    /// Explicit zeros that joining has put into the clique's trapezoid, in blocks.
    zeros: usize,
}

/// Plans the cliques, in the order of elimination, children before parents. `elements` is the number of given elements,
/// `variables` the number of variables, and `block` the number of scalars of a variable.
pub(crate) fn plan(pivots: Vec<Pivot>, elements: usize, variables: usize, block: usize) -> Vec<Plan> {
    let mut parents = vec![None; pivots.len()];
    for (index, pivot) in pivots.iter().enumerate() {
        for &child in pivot.children.iter().filter(|&&child| child >= elements) {
            parents[child - elements] = Some(index);
        }
    }
    // Roots come first, so that a parent has its final height when a child asks to join it. Frontals are collected backwards.
    let mut plans: Vec<Plan> = Vec::with_capacity(pivots.len());
    let mut boundaries: Vec<Vec<usize>> = Vec::with_capacity(pivots.len());
    let mut place = vec![0; pivots.len()];
    for (index, pivot) in pivots.into_iter().enumerate().rev() {
        let above = parents[index].map(|parent: usize| place[parent]);
        let joined = above.filter(|&above| joins(&pivot, &plans[above], &boundaries[above], block));
        let target = if let Some(target) = joined {
            let plan = &mut plans[target];
            plan.zeros += pivot.variables.len()
                * (plan.variables.len() + boundaries[target].len() - pivot.boundary.len());
            target
        } else {
            plans.push(Plan { parent: above, ..Plan::default() });
            boundaries.push(pivot.boundary);
            plans.len() - 1
        };
        place[index] = target;
        let plan = &mut plans[target];
        plan.variables.extend(pivot.variables.iter().rev());
        plan.given.extend(pivot.children.iter().filter(|&&child| child < elements));
    }
    let last = plans.len().saturating_sub(1);
    plans.reverse();
    boundaries.reverse();
    let mut ranks = vec![0; variables];
    let mut rank = 0;
    for plan in &mut plans {
        plan.parent = plan.parent.map(|parent| last - parent);
        plan.variables.reverse();
        plan.frontals = plan.variables.len();
        for &variable in &plan.variables {
            ranks[variable] = rank;
            rank += 1;
        }
    }
    for (plan, mut boundary) in plans.iter_mut().zip(boundaries) {
        boundary.sort_unstable_by_key(|&variable| ranks[variable]);
        plan.variables.append(&mut boundary);
    }
    plans
}

/// Whether to eliminate a pivot in its parent's clique: larger fronts cost some arithmetic and save bookkeeping.
fn joins(pivot: &Pivot, parent: &Plan, boundary: &[usize], block: usize) -> bool {
    let height = parent.variables.len() + boundary.len();
    let zeros = parent.zeros + pivot.variables.len() * (height - pivot.boundary.len());
    if zeros == 0 {
        return true;
    }
    let columns = pivot.variables.len() + parent.variables.len();
    let size = columns * (columns + 1) / 2 + columns * boundary.len();
    let share = zeros as f64 / size as f64;
    let scalars = columns * block;
    share < 0.1 || (scalars <= 64 && share < 0.2) || (scalars <= 24 && share < 0.5)
}
