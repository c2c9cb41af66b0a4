//! The report: what the checks found.

use serde::Serialize;

/// The importance of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Without it a pipeline breaks, or its results mean nothing.
    Must,
    /// Users will miss it.
    Should,
}

/// The outcome of a check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "outcome", content = "reason", rename_all = "lowercase")]
pub enum Outcome {
    /// The demand is met.
    Passed,
    /// The demand is not met, for this reason.
    Failed(String),
    /// The check could not be run, for this reason.
    Skipped(String),
}

/// One check of a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckReport {
    /// The check's name.
    pub name: &'static str,
    /// The importance of the check.
    pub level: Level,
    /// The demand in words.
    pub demand: &'static str,
    /// The outcome.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// All checks of a program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// The command.
    pub program: Vec<String>,
    /// The number of landmark edges of the sample that the program rejected, and of those that it could reject. Absent if the
    /// program does not work.
    pub rejected: Option<(usize, usize)>,
    /// The checks, in the order in which they were run.
    pub checks: Vec<CheckReport>,
}

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    version: u32,
    conforms: bool,
    #[serde(flatten)]
    report: &'a Report,
}

impl Report {
    /// Whether the program meets every demand of level `must`; with `strict`, every demand.
    pub fn conforms(&self, strict: bool) -> bool {
        self.failures(Level::Must) == 0 && (!strict || self.failures(Level::Should) == 0)
    }

    fn failures(&self, level: Level) -> usize {
        self.checks
            .iter()
            .filter(|check| check.level == level && matches!(check.outcome, Outcome::Failed(_)))
            .count()
    }

    /// The names of the checks that failed.
    pub fn failed(&self) -> Vec<&'static str> {
        self.checks
            .iter()
            .filter(|check| matches!(check.outcome, Outcome::Failed(_)))
            .map(|check| check.name)
            .collect()
    }

    /// Counts for a summary.
    pub fn figures(&self) -> [(&'static str, usize); 4] {
        let count = |outcome: fn(&Outcome) -> bool| {
            self.checks.iter().filter(|check| outcome(&check.outcome)).count()
        };
        [
            ("passed", count(|outcome| *outcome == Outcome::Passed)),
            ("failed", self.failures(Level::Must)),
            ("advice", self.failures(Level::Should)),
            ("skipped", count(|outcome| matches!(outcome, Outcome::Skipped(_)))),
        ]
    }

    /// The report as text, for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n", self.program.join(" "));
        for check in &self.checks {
            let (word, reason) = match (&check.outcome, check.level) {
                (Outcome::Passed, _) => ("passed ", None),
                (Outcome::Failed(reason), Level::Must) => ("FAILED ", Some(reason)),
                (Outcome::Failed(reason), Level::Should) => ("advice ", Some(reason)),
                (Outcome::Skipped(reason), _) => ("skipped", Some(reason)),
            };
            text += &format!("{word}  {:<24} {}\n", check.name, check.demand);
            if let Some(reason) = reason {
                text += &format!("         {:<24} -> {reason}\n", "");
            }
        }
        if let Some((rejected, all)) = self.rejected {
            text += &format!("\nThe program rejected {rejected} of the sample's {all} landmark edges.\n");
        }
        let [passed, failed, advice, skipped] = self.figures().map(|(_, count)| count);
        let verdict = if self.conforms(false) { "conforms" } else { "does not conform" };
        text +=
            &format!("\n{verdict}: {passed} passed, {failed} failed, {advice} advised, {skipped} skipped\n");
        text
    }

    /// The report as JSON, for programs.
    pub fn json(&self) -> serde_json::Result<String> {
        let document = Document {
            format: "posecut-conformance",
            version: 1,
            conforms: self.conforms(false),
            report: self,
        };
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}
