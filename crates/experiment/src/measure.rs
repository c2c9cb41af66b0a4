//! Computes the rows of a plan's outputs.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context as _;

use crate::expected::Cover;
use crate::{Fingerprint, Plan, Task};

/// The values of one file, or the means over the same file of several seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The file below the folder of results.
    pub file: String,
    /// The step that writes it.
    pub stage: String,
    /// The indices in the plan of the tasks that write it.
    pub tasks: Vec<usize>,
    /// The values, or why there are none.
    pub found: Result<Fingerprint, String>,
}

/// Reads the covered files of a plan, in the plan's order, then the means over seeds.
pub fn measure(plan: &Plan, covers: &[Cover], results: &Path) -> Vec<Measured> {
    let mut rows = Vec::new();
    for cover in covers {
        let mut means: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (place, task) in plan.tasks.iter().enumerate() {
            let Some(run) = Run::of(task, results, cover, plan) else { continue };
            if run.seed.is_none_or(|seed| seed <= cover.seeds) {
                rows.push(Measured {
                    file: run.file.clone(),
                    stage: task.stage.clone(),
                    tasks: vec![place],
                    found: Fingerprint::read(Path::new(&task.id)).map_err(|error| format!("{error:#}")),
                });
            }
            if let Some(seed) = run.seed
                && seed <= cover.mean_over
                && run.file.ends_with(".result.json")
            {
                let over = format!("/1-{}/", cover.mean_over);
                means.entry(run.file.replace(&format!("/{seed}/"), &over)).or_default().push(place);
            }
        }
        for (file, tasks) in means {
            // A plan with fewer seeds cannot give this mean.
            if tasks.len() as u64 == cover.mean_over {
                let found = mean(plan, &tasks).map_err(|error| format!("{error:#}"));
                rows.push(Measured { file, stage: "evaluate".to_owned(), tasks, found });
            }
        }
    }
    rows
}

/// The run that a file belongs to.
struct Run {
    file: String,
    /// Absent for files that all seeds share.
    seed: Option<u64>,
}

impl Run {
    fn of(task: &Task, results: &Path, cover: &Cover, plan: &Plan) -> Option<Self> {
        let Ok(path) = Path::new(&task.id).strip_prefix(results) else {
            // A simulated session is in another folder. It belongs to each experiment whose tasks read it.
            let folder = results.join(&cover.experiment);
            let read = plan
                .tasks
                .iter()
                .any(|reader| reader.inputs.contains(&task.id) && Path::new(&reader.id).starts_with(&folder));
            let name = Path::new(&task.id).file_name()?.to_string_lossy();
            return read.then(|| Self { file: format!("{}/{name}", cover.experiment), seed: None });
        };
        let file = path.to_string_lossy().into_owned();
        let seed = path.parent()?.file_name()?.to_string_lossy().parse().ok();
        path.starts_with(&cover.experiment).then_some(Self { file, seed })
    }
}

fn mean(plan: &Plan, tasks: &[usize]) -> anyhow::Result<Fingerprint> {
    let mut sum = 0.0;
    for &place in tasks {
        let found = Fingerprint::read(Path::new(&plan.tasks[place].id))?;
        sum += found.close.get("rmse").context("a result has no RMSE")?;
    }
    let close = BTreeMap::from([("rmse".to_owned(), sum / tasks.len() as f64)]);
    Ok(Fingerprint { exact: BTreeMap::new(), close })
}
