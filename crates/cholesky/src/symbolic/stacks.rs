//! Where the update matrices of fronts are stored until their parents take them.

use std::ops::Range;

use super::Symbolic;
use super::front::{Front, Stretch};

impl Symbolic {
    /// Gives every update matrix an offset on one of two stacks.
    ///
    /// When a front is assembled, the updates of its children are on top of one stack, and its own update goes on top of the
    /// other. So neither has to move, and the two can be borrowed apart. Stretches that run in parallel have their own
    /// regions of the stacks. What they leave to the rest lies at the start of their regions and moves together, to the start of the
    /// stacks, before the rest takes the memory behind it.
    pub(super) fn place_updates(&mut self, independent: &[Range<usize>]) {
        for index in (0..self.fronts.len()).rev() {
            let parent = self.fronts[index].parent;
            self.fronts[index].stack = self.fronts.get(parent).map_or(0, |parent| 1 - parent.stack);
        }
        // Region 0 is the rest; so far it has all fronts.
        let mut regions = vec![0; self.fronts.len()];
        let all: Vec<usize> = (0..self.fronts.len()).collect();
        let [_, corners] = self.place(&all, &regions, [0, 0], |front, offset| front.corner = offset);
        let (mut start, mut moved) = ([0, 0], [0, 0]);
        for (index, fronts) in independent.iter().enumerate() {
            regions[fronts.clone()].fill(index + 1);
            let fronts: Vec<usize> = fronts.clone().collect();
            let [top, end] = self.place(&fronts, &regions, moved, |front, offset| front.update = offset);
            let stacks = [0, 1].map(|stack| start[stack]..start[stack] + end[stack] - moved[stack]);
            start = [stacks[0].end, stacks[1].end];
            self.add_stretch(fronts, stacks, [moved[0]..top[0], moved[1]..top[1]]);
            moved = top;
        }
        let rest: Vec<usize> = (0..self.fronts.len()).filter(|&front| regions[front] == 0).collect();
        let [top, end] = self.place(&rest, &regions, moved, |front, offset| front.update = offset);
        self.add_stretch(rest, [moved[0]..end[0], moved[1]..end[1]], [moved[0]..top[0], moved[1]..top[1]]);
        self.stack_blocks = [0, 1].map(|stack| start[stack].max(end[stack]).max(corners[stack]));
    }

    /// Places the updates of these fronts, all of one region, on the stacks from `base` on. Returns the offsets where the updates end
    /// that remain, and the highest ones in between.
    ///
    /// A front's stack is the parity of its depth: a front and its children never share a stack, and the updates of its
    /// grandchildren are gone when it is assembled.
    fn place(
        &mut self,
        fronts: &[usize],
        regions: &[usize],
        base: [usize; 2],
        set: impl Fn(&mut Front, usize),
    ) -> [[usize; 2]; 2] {
        let (mut top, mut end) = (base, base);
        for &index in fronts {
            let front = &self.fronts[index];
            let (own, others) = (front.stack, 1 - front.stack);
            let size = front.below() * front.below();
            // In postorder the children's updates are the last on their stack. Updates of another region are not released here.
            let released: usize = self.children[front.children.clone()]
                .iter()
                .filter(|&&child| regions[child] == regions[index])
                .map(|&child| self.fronts[child].below())
                .map(|below| below * below)
                .sum();
            set(&mut self.fronts[index], top[own]);
            top[own] += size;
            end[own] = end[own].max(top[own]);
            top[others] -= released;
        }
        [top, end]
    }

    fn add_stretch(&mut self, fronts: Vec<usize>, stacks: [Range<usize>; 2], left: [Range<usize>; 2]) {
        let start = fronts.first().map_or(0, |&front| self.fronts[front].panel);
        let panel_end = fronts.last().map_or(0, |&front| self.fronts[front].panel_end());
        self.stretches.push(Stretch { fronts, panels: start..panel_end, stacks, left });
    }
}
