//! Hostile graphs for every program that reads one from standard input and is not a target in this process. A new stage is
//! included automatically.

use posecut_contract::registry::table;
use posecut_contract::run;
use posecut_fuzz::{Campaign, TARGETS};

/// The number of inputs for each program. Each input starts a process.
const INPUTS: usize = 200;

#[test]
fn programs_that_are_no_target_answer_hostile_graphs() {
    let is_target = |name: &str| TARGETS.iter().any(|target| target.name == name);
    let reader = TARGETS.iter().find(|target| target.name == "jsonl").expect("graphs are a target");
    let takes_graphs = table().iter().filter(|row| row.pipe && row.input == Some("graph.jsonl"));
    for row in takes_graphs.filter(|row| !is_target(row.name)) {
        let mut campaign = Campaign::new(reader, 1);
        let mut refused = 0;
        for number in 0..INPUTS {
            let input = campaign.input();
            let output = run(row.name, row.arguments, &input);
            let said = String::from_utf8_lossy(&output.stderr);
            let call = format!("posecut-{} {:?}, input {number} of seed 1: {said}", row.name, row.arguments);
            assert!(output.status.code().is_some_and(|code| code <= 3), "{call}");
            // Status 3: done, but a warning says why the result should not be believed.
            assert!(output.status.code() != Some(3) || said.contains(": warning: "), "{call}");
            if output.status.code() == Some(2) {
                refused += 1;
                let error = format!("posecut-{}: error: ", row.name);
                let last = said.lines().last().unwrap_or_default();
                assert!(last.starts_with(&error) && output.stdout.is_empty(), "{call}");
            }
            // The outcome of the reader guides the choice of the next inputs.
            campaign.step(input).expect("the reader has its own test");
        }
        assert!((1..INPUTS).contains(&refused), "posecut-{}: {refused} of {INPUTS} refused", row.name);
    }
}
