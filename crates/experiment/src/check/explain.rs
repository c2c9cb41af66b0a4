//! A report in words. It names the first stage whose output differs although its input does not.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write as _;

use super::{Report, Row};
use crate::Plan;
use crate::make_rules::shell;

/// The number of failing rows of each stage that are shown in full.
const SHOWN: usize = 3;

impl Report {
    /// The report as text: a summary for each stage, then the failures and where they start.
    pub fn text(&self, plan: &Plan) -> anyhow::Result<String> {
        let mut text = self.summary();
        let failing: Vec<&Row> = self.rows.iter().filter(|row| !row.failures.is_empty()).collect();
        if failing.is_empty() {
            return Ok(text);
        }
        let origins = self.origins(plan)?;
        let (first, later): (Vec<&Row>, Vec<&Row>) =
            failing.iter().partition(|row| origins.contains(row.name.as_str()));
        let mut stages: Vec<&str> = Vec::new();
        for row in &first {
            if !stages.contains(&row.stage.as_str()) {
                stages.push(&row.stage);
            }
        }
        // Writing to a string cannot fail.
        for stage in stages {
            let rows: Vec<&&Row> = first.iter().filter(|row| row.stage == stage).collect();
            let _ = if stage == "order" {
                writeln!(
                    text,
                    "\nFAILED order of methods, although every file is as expected or has no row of its own"
                )
            } else {
                let verb = if rows.len() == 1 { "differs" } else { "differ" };
                writeln!(
                    text,
                    "\nFAILED in stage `{stage}`: {} {verb}, although the inputs of the stage do not",
                    files(rows.len())
                )
            };
            for row in rows.iter().take(SHOWN) {
                let _ = writeln!(text, "  {}", row.name);
                for failure in &row.failures {
                    let _ = writeln!(text, "    {failure}");
                }
                if let [place] = row.tasks[..] {
                    let task = &plan.tasks[place];
                    let words: Vec<String> = task.argv.iter().map(|word| shell(word)).collect();
                    let _ = writeln!(text, "    made by: {}", words.join(" "));
                }
            }
            if rows.len() > SHOWN {
                let _ = writeln!(text, "  … and {} more of this stage", rows.len() - SHOWN);
            }
        }
        if !later.is_empty() {
            let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
            for row in &later {
                *counts.entry(&row.stage).or_default() += 1;
            }
            let counts: Vec<String> =
                counts.iter().map(|(stage, number)| format!("{stage} {number}")).collect();
            let _ = writeln!(
                text,
                "\nFiles that depend on them differ too, perhaps only for that reason: {}.",
                counts.join(", ")
            );
        }
        text.push_str("If the change is intended, record it with `make accept-results` and commit pipelines/expected.toml.\n");
        Ok(text)
    }

    fn summary(&self) -> String {
        let mut text = String::new();
        let mut groups: Vec<(String, Vec<&Row>)> = Vec::new();
        for row in self.rows.iter().filter(|row| row.stage != "order") {
            let experiment = row.name.split('/').next().unwrap_or_default();
            let title = format!("{experiment} {}", row.stage);
            match groups.iter_mut().find(|(other, _)| *other == title) {
                Some((_, rows)) => rows.push(row),
                None => groups.push((title, vec![row])),
            }
        }
        for (title, rows) in groups {
            let good = rows.iter().filter(|row| row.failures.is_empty()).count();
            let largest = rows
                .iter()
                .filter_map(|row| Some((row.largest.as_ref()?, row)))
                .max_by(|(first, _), (second, _)| first.0.total_cmp(&second.0));
            let distance = largest.map_or_else(String::new, |((share, quantity), row)| {
                format!("; largest deviation {share:.1e} of its tolerance ({quantity} of {})", row.name)
            });
            let _ = writeln!(text, "{title}: {good} of {} as expected{distance}", files(rows.len()));
        }
        for row in self.rows.iter().filter(|row| row.stage == "order") {
            for said in row.notes.iter().chain(&row.failures) {
                let _ = writeln!(text, "{}: {said}", row.name);
            }
        }
        if self.not_checked > 0 {
            let _ = writeln!(
                text,
                "not checked, because this plan does not write them: {}",
                files(self.not_checked)
            );
        }
        text
    }

    /// The failing rows with no failing row among their direct and indirect inputs.
    fn origins(&self, plan: &Plan) -> anyhow::Result<BTreeSet<&str>> {
        let dependencies = plan.dependencies()?;
        let mut failing = vec![false; plan.tasks.len()];
        let single = |row: &&Row| !row.failures.is_empty() && row.tasks.len() == 1;
        for row in self.rows.iter().filter(single) {
            failing[row.tasks[0]] = true;
        }
        // Whether a direct or indirect input of a task differs. One pass suffices, because tasks follow their inputs.
        let mut tainted: HashMap<usize, bool> = HashMap::new();
        for (place, own) in dependencies.iter().enumerate() {
            let from =
                own.iter().any(|&other| failing[other] || tainted.get(&other).copied().unwrap_or(false));
            tainted.insert(place, from);
        }
        Ok(self
            .rows
            .iter()
            .filter(|row| !row.failures.is_empty())
            .filter(|row| {
                let own = |place: &usize| tainted.get(place).copied().unwrap_or(false);
                // A mean or an order is an origin only if none of its files differs by itself.
                !row.tasks.iter().any(|place| own(place) || (row.tasks.len() > 1 && failing[*place]))
            })
            .map(|row| row.name.as_str())
            .collect())
    }
}

fn files(number: usize) -> String {
    posecut_stage::counted(number, "file")
}
