//! Where the update matrices of fronts are stored until their parents take them.

use std::ops::Range;

use super::Symbolic;
use super::front::Stretch;

impl Symbolic {
    /// Gives every update matrix an offset on one of two stacks.
    ///
    /// When a front is assembled, the updates of its children are on top of one stack, and its own update goes on top of the
    /// other. So neither has to move, and the two can be borrowed apart. Stretches that run in parallel have their own
    /// regions of the stacks, below the region of the rest.
    pub(super) fn place_updates(&mut self, independent: &[Range<usize>]) {
        for index in (0..self.fronts.len()).rev() {
            let parent = self.fronts[index].parent;
            self.fronts[index].stack = self.fronts.get(parent).map_or(0, |parent| 1 - parent.stack);
        }
        // The stack is the parity of the depth: a front and its children never share a stack, and the updates of its
        // grandchildren are gone when it is assembled.
        // Region 0 is the rest.
        let mut regions = vec![0; self.fronts.len()];
        let mut base = [0, 0];
        for (index, fronts) in independent.iter().enumerate() {
            regions[fronts.clone()].fill(index + 1);
            let end = self.place_region(fronts.clone().collect(), &regions, base);
            base = end;
        }
        let rest = (0..self.fronts.len()).filter(|&front| regions[front] == 0).collect();
        self.stack_blocks = self.place_region(rest, &regions, base);
    }

    /// Adds a stretch of these fronts, all of one region, whose updates are on the stacks from `base` on. Returns the highest
    /// offsets that they reach.
    fn place_region(&mut self, fronts: Vec<usize>, regions: &[usize], base: [usize; 2]) -> [usize; 2] {
        let (mut top, mut end) = (base, base);
        for &index in &fronts {
            let front = &self.fronts[index];
            let (own, others) = (front.stack, 1 - front.stack);
            let size = front.below() * front.below();
            // In postorder the children's updates are the last on their stack. Updates of another region are on that region's
            // stacks and are not released here.
            let released: usize = self.children[front.children.clone()]
                .iter()
                .filter(|&&child| regions[child] == regions[index])
                .map(|&child| self.fronts[child].below())
                .map(|below| below * below)
                .sum();
            self.fronts[index].update = top[own];
            top[own] += size;
            end[own] = end[own].max(top[own]);
            top[others] -= released;
        }
        let start = fronts.first().map_or(0, |&front| self.fronts[front].panel);
        let panel_end = fronts.last().map_or(0, |&front| self.fronts[front].panel_end());
        self.stretches.push(Stretch {
            fronts,
            panels: start..panel_end,
            stacks: [base[0]..end[0], base[1]..end[1]],
        });
        end
    }
}
