//! The result under other hypotheses, for the page to switch between.

use posecut_graph::PoseGraph;
use posecut_stage::Context;
use posecut_verify::Verification;

use crate::command::Command;
use crate::run::{optimize, verification_options};

/// Most hypotheses that a page can switch to: each costs as much as the result itself.
const MOST: usize = 3;

/// The graph as the rivals of the applied hypothesis make it, those with the most evidence first, each with its name. If the command line
/// chooses a hypothesis, the map is one of them.
pub(crate) fn alternatives(
    command: &Command,
    before: &PoseGraph,
    found: &Verification,
    context: &Context,
) -> anyhow::Result<Vec<(String, PoseGraph)>> {
    let applied = command.judgement.hypothesis;
    let mut rivals: Vec<_> = found.rivals.iter().filter(|rival| rival.hypothesis != applied).collect();
    rivals.sort_by(|one, other| other.evidence.total_cmp(&one.evidence));
    let map = (applied != 0).then_some(0);
    let numbers = map.into_iter().chain(rivals.iter().map(|rival| rival.hypothesis)).take(MOST);
    numbers
        .map(|hypothesis| {
            let mut graph = before.clone();
            let options = verification_options(command, hypothesis)?;
            context.run_inside(|inner| options.judge(&mut graph, inner))?;
            context.run_inside(|inner| optimize(&mut graph, inner))?;
            let name =
                if hypothesis == 0 { "main map".to_owned() } else { format!("hypothesis {hypothesis}") };
            Ok((name, graph))
        })
        .collect()
}
