//! Assembles the page: the template with its sections, styles, scripts and data.

use posecut_view::markup::{escape, fill, json};
use posecut_view::script::{self, policy};

use super::view::Page;

const TEMPLATE: &str = include_str!("../../assets/page.html");
const STYLE: &str = include_str!("../../assets/page.css");

/// The scripts in the order in which they run.
const SCRIPTS: [&str; 20] = [
    "// Series of numbers as posecut-report writes them: base 64 of zigzag differences, 7 bits a byte, lowest first.\n",
    script::SERIES,
    include_str!("../../assets/script/places.js"),
    script::ELEMENTS,
    include_str!("../../assets/script/theme.js"),
    script::SCALE,
    include_str!("../../assets/script/chart.js"),
    include_str!("../../assets/script/map.js"),
    include_str!("../../assets/script/state.js"),
    include_str!("../../assets/script/spread.js"),
    include_str!("../../assets/script/trajectories.js"),
    include_str!("../../assets/script/graphs.js"),
    include_str!("../../assets/script/error.js"),
    include_str!("../../assets/script/consistency.js"),
    include_str!("../../assets/script/components.js"),
    include_str!("../../assets/script/logs.js"),
    include_str!("../../assets/script/regimes.js"),
    include_str!("../../assets/script/trust.js"),
    include_str!("../../assets/script/reliability.js"),
    include_str!("../../assets/script/start.js"),
];

/// Sections whose data may be missing.
const TRAJECTORIES: &str = include_str!("../../assets/section/trajectories.html");
const GRAPHS: &str = include_str!("../../assets/section/graphs.html");
const ERROR: &str = include_str!("../../assets/section/error.html");
const CONSISTENCY: &str = include_str!("../../assets/section/consistency.html");
const COMPONENTS: &str = include_str!("../../assets/section/components.html");
const MAPS: &str = include_str!("../../assets/section/maps.html");
const REGIMES: &str = include_str!("../../assets/section/regimes.html");
const TRUST: &str = include_str!("../../assets/section/trust.html");
const RELIABILITY: &str = include_str!("../../assets/section/reliability.html");

/// The parts of the page that are text or HTML.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// The title, as text.
    pub title: String,
    /// The tables.
    pub tables: String,
    /// The source of the published figures, as text; empty if there are none.
    pub published: String,
    /// Requested sessions that have no data.
    pub missing: Vec<String>,
    /// The numbers of the maps of laser logs; empty without maps.
    pub maps: String,
    /// The tables of the trust benchmark; empty without its results.
    pub trust: String,
    /// Where the numbers come from.
    pub history: String,
    /// The version of the program.
    pub version: String,
}

/// Writes the page. Its content security policy forbids every connection, and every script but its own.
pub fn document(page: &Page, parts: &Parts) -> anyhow::Result<String> {
    let script = script::wrapped(&SCRIPTS);
    let data = json(&serde_json::to_string(page)?);
    Ok(fill(TEMPLATE, |name| match name {
        // Maps of laser logs are pictures in the page itself.
        "policy" if !page.maps.is_empty() => Some(format!("{}; img-src data:", policy(STYLE, &script))),
        "policy" => Some(policy(STYLE, &script)),
        "style" => Some(STYLE.to_owned()),
        "script" => Some(script.clone()),
        "data" => Some(data.clone()),
        _ => text(parts, name).or_else(|| drawing(page, parts, name)),
    }))
}

/// The parts that are text: the title, the tables and their notes.
fn text(parts: &Parts, name: &str) -> Option<String> {
    let note = |about: &str, ending: &str| {
        if about.is_empty() { String::new() } else { format!("<p class=\"note\">{ending}</p>") }
    };
    Some(match name {
        "title" => escape(&parts.title),
        "tables" => section(
            !parts.tables.is_empty(),
            &parts.tables,
            "There are no results. Name output files of posecut-evaluate, or directories that contain them.",
        ),
        "published" => {
            let published = escape(&parts.published);
            note(
                &published,
                &format!("Published figures: {published}. Their mean is over all published sessions."),
            )
        }
        "missing" => {
            let missing = escape(&parts.missing.join(", "));
            note(&missing, &format!("Requested sessions without data: {missing}."))
        }
        "history" => parts.history.clone(),
        "version" => escape(&parts.version),
        _ => return None,
    })
}

/// The parts that scripts draw, or the reason why they cannot.
fn drawing(page: &Page, parts: &Parts, name: &str) -> Option<String> {
    let sessions = || page.experiments.iter().flat_map(|it| &it.sessions);
    let seeds = || sessions().flat_map(|it| &it.seeds);
    let any = |wanted: fn(&super::view::Method) -> bool| seeds().flat_map(|it| &it.methods).any(wanted);
    Some(match name {
        "trajectories" => section(
            sessions().any(|it| it.truth.is_some()),
            TRAJECTORIES,
            "The routes of the sessions are unknown, because there are no graphs beside the results, or they have no ground truth.",
        ),
        "graphs" => section(
            any(|method| method.track.is_some()),
            GRAPHS,
            "There is nothing to draw, because there are no optimised graphs beside the results (METHOD.optimized.jsonl beside METHOD.result.json).",
        ),
        "error" => section(
            any(|method| method.error.is_some()),
            ERROR,
            "The errors of poses are unknown, because there is no reference beside the results (oracle.optimized.jsonl).",
        ),
        "consistency" => section(
            seeds().any(|it| it.consistency.is_some()),
            CONSISTENCY,
            "PCM has processed none of the graphs beside the results.",
        ),
        "components" => section(
            any(|method| method.landmarks.is_some()),
            COMPONENTS,
            "The multicut has processed none of the graphs beside the results.",
        ),
        "maps" => section(
            !page.maps.is_empty(),
            &fill(MAPS, |name| (name == "table").then(|| parts.maps.clone())),
            "There are no maps of laser logs; make map LOG=FILE makes them, and make report then shows them.",
        ),
        "regimes" => section(
            page.regimes.is_some(),
            REGIMES,
            "There are no results over regimes of covariance and false-edge rate; make regimes computes them.",
        ),
        "trust" => section(
            page.trust.is_some(),
            &fill(TRUST, |name| match name {
                "tables" => Some(parts.trust.clone()),
                "reliability" => Some(page.reliability.as_ref().map_or("", |_| RELIABILITY).to_owned()),
                _ => None,
            }),
            "There are no results of the trust benchmark; make trust DATA=DIR computes them.",
        ),
        _ => return None,
    })
}

/// The body of a section, or one sentence that says why it is missing.
fn section(present: bool, body: &str, absent: &str) -> String {
    if present { body.to_owned() } else { format!("<p class=\"absent-section\">{}</p>", escape(absent)) }
}
