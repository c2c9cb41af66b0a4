//! Checks which method does better.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::Row;
use crate::{Fingerprint, Order, Plan};

/// Judges an order by the plan's results; `None` if the plan does not run both methods. A share is valid only for the sessions
/// for which it was recorded. If the plan lacks some of them, the order is not judged, and the row says so.
pub(super) fn judge(order: &Order, plan: &Plan, results: &Path) -> Option<Row> {
    let folder = results.join(&order.experiment);
    let Runs { pairs, sessions } = runs(order, plan, &folder);
    if pairs.is_empty() {
        return None;
    }
    let mut row = Row {
        name: format!("{}: {} better than {}", order.experiment, order.better, order.worse),
        stage: "order".to_owned(),
        failures: Vec::new(),
        notes: Vec::new(),
        largest: None,
        tasks: pairs.values().flatten().copied().collect(),
    };
    let missing: Vec<&str> =
        order.sessions.iter().filter(|&session| !sessions.contains(session)).map(String::as_str).collect();
    if !missing.is_empty() {
        row.notes.push(format!(
            "not judged: the share of {:.2} was recorded for {}, and this plan lacks {}",
            order.share,
            order.sessions.join(", "),
            missing.join(", ")
        ));
        return Some(row);
    }
    let (mut wins, mut against) = (0, Vec::new());
    for (run, places) in &pairs {
        let [better, worse] = places.map(|place| read(&plan.tasks[place].id));
        match better.and_then(|better| Ok((better, worse?))) {
            Ok((better, worse)) if better < worse => wins += 1,
            Ok((better, worse)) => {
                let run = run.strip_prefix(&folder).unwrap_or(run).display();
                against.push(format!("{run} ({better:.3} m against {worse:.3} m)"));
            }
            Err(error) => row.failures.push(error),
        }
    }
    let share = f64::from(wins) / pairs.len() as f64;
    let said = format!(
        "lower RMSE in {wins} of {} runs, a share of {share:.2}, where at least {:.2} is expected",
        pairs.len(),
        order.share
    );
    if share >= order.share {
        row.notes.push(said);
    } else {
        row.failures.push(format!("{said} ({}); not in {}", order.reason, against.join(", ")));
    }
    Some(row)
}

/// The runs with both methods of an order.
struct Runs<'a> {
    /// For each folder, the indices of the two results in the plan, the better method first.
    pairs: BTreeMap<&'a Path, [usize; 2]>,
    /// The sessions that the plan has.
    sessions: BTreeSet<String>,
}

fn runs<'a>(order: &Order, plan: &'a Plan, folder: &Path) -> Runs<'a> {
    let mut sides: BTreeMap<&Path, [Option<usize>; 2]> = BTreeMap::new();
    let mut sessions = BTreeSet::new();
    for (place, task) in plan.tasks.iter().enumerate() {
        let path = Path::new(&task.id);
        let (Some(run), Some(name), Ok(below)) = (path.parent(), path.file_name(), path.strip_prefix(folder))
        else {
            continue;
        };
        let session = below.components().next().map(|part| part.as_os_str().to_string_lossy().into_owned());
        let seed: Option<u64> = run.file_name().and_then(|seed| seed.to_string_lossy().parse().ok());
        let wanted = order.sessions.is_empty()
            || session.as_ref().is_some_and(|session| order.sessions.contains(session));
        if !wanted || seed.is_none_or(|seed| seed > order.seeds) {
            continue;
        }
        let side = match name.to_string_lossy().strip_suffix(".result.json") {
            Some(method) if method == order.better => 0,
            Some(method) if method == order.worse => 1,
            _ => continue,
        };
        sides.entry(run).or_default()[side] = Some(place);
        sessions.extend(session);
    }
    let both = |(run, [better, worse]): (_, [Option<usize>; 2])| Some((run, [better?, worse?]));
    Runs { pairs: sides.into_iter().filter_map(both).collect(), sessions }
}

fn read(path: &str) -> Result<f64, String> {
    let found = Fingerprint::read(Path::new(path)).map_err(|error| format!("{error:#}"))?;
    found.close.get("rmse").copied().ok_or_else(|| format!("{path}: has no RMSE"))
}
