//! Tests the map of regimes with hand-made results.

use std::fmt::Write as _;
use std::fs;

use posecut_report::regimes::document::sections;
use posecut_report::regimes::table::signed;
use posecut_report::regimes::{Map, Verdict, table};
use posecut_report::results::{RunResult, read_all};
use posecut_report::splice::splice;

fn line(session: &str, method: &str, scale: &str, rate: &str, seed: u32, rmse: f64) -> String {
    format!(
        r#"{{"format":"posecut-result","version":1,"labels":{{"session":"{session}","method":"{method}","seed":{seed},"covariance_scale":{scale},"incorrect_rate":{rate},"incorrect_kind":"uniform"}},"rmse":{rmse},"components":1,"edges":{{"true_positive":9,"false_positive":1,"false_negative":3,"true_negative":2}}}}"#
    )
}

fn results(lines: &str) -> anyhow::Result<Vec<RunResult>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.jsonl");
    fs::write(&path, lines).unwrap();
    read_all(&[path])
}

/// Twenty seeds: the graph cut is better at scale 3, worse at 0.3, and equal at 1.
fn sample() -> Vec<RunResult> {
    let mut text = String::new();
    for seed in 0..20 {
        for session in ["s", "t"] {
            let wobble = f64::from(seed) / 10.0;
            for (scale, without, with) in [
                ("\"0.3\"", 1.0 + wobble, 2.5 + wobble),
                ("1", 1.0 + wobble, 3.0 - f64::from(seed) / 10.0),
                ("3", 100.0 + wobble, 5.0 + wobble),
            ] {
                let _ = writeln!(text, "{}", line(session, "pcm", scale, "\"0.1\"", seed, without));
                let _ = writeln!(text, "{}\n", line(session, "pcm+gc", scale, "\"0.1\"", seed, with));
            }
        }
    }
    results(&text).unwrap()
}

#[test]
fn cells_are_means_over_seeds_with_intervals_around_them() {
    let map = Map::new(&sample(), &["pcm+gc".to_owned()]).unwrap();
    assert_eq!(map.sessions, ["all sessions", "s", "t"]);
    assert_eq!((map.scales.as_slice(), map.rates.as_slice()), ([0.3, 1.0, 3.0].as_slice(), [0.1].as_slice()));
    assert_eq!(map.methods, ["pcm+gc", "pcm"], "those asked for first");
    let cell = map.of("s", "uniform", "pcm").unwrap().cells[2].unwrap();
    assert!((cell.mean - 100.95).abs() < 1e-9, "{cell:?}");
    assert_eq!((cell.seeds, cell.precision, cell.recall), (20, Some(0.9), Some(0.75)));
    // The mean's standard error is 0.132 m; the interval extends about 1.96 of them to either side.
    assert!((cell.low - 100.70).abs() < 0.06 && (cell.high - 101.20).abs() < 0.06, "{cell:?}");
    let all = map.of("all sessions", "uniform", "pcm").unwrap().cells[2].unwrap();
    assert!((all.mean - 100.95).abs() < 1e-9 && all.seeds == 40);
    assert!(all.high - all.low < cell.high - cell.low, "more runs, a narrower interval");
}

#[test]
fn verdicts_follow_the_paired_differences() {
    let map = Map::new(&sample(), &[]).unwrap();
    let comparison = map.compared("s", "uniform").next().unwrap();
    assert_eq!((comparison.with.as_str(), comparison.without.as_str()), ("pcm+gc", "pcm"));
    let effects: Vec<_> = comparison.cells.iter().map(|effect| effect.unwrap()).collect();
    assert_eq!(
        effects.iter().map(|effect| effect.verdict).collect::<Vec<_>>(),
        [Verdict::Hurts, Verdict::Neutral, Verdict::Helps]
    );
    assert!((effects[2].difference + 95.0).abs() < 1e-9 && (effects[0].difference - 1.5).abs() < 1e-9);
    assert!(effects[1].low < 0.0 && effects[1].high > 0.0 && effects[1].p > 0.5, "{:?}", effects[1]);
}

#[test]
fn tables_say_the_same_in_markdown_and_csv_and_always_alike() {
    let map = Map::new(&sample(), &[]).unwrap();
    let (sessions, kinds) = (["s".to_owned()], ["uniform".to_owned()]);
    let text = table::markdown(&map, &sessions, &kinds);
    assert!(
        text.contains(
            "**pcm+gc against pcm**, difference in metres: helps in 1, neutral in 1, hurts in 1 of 3 cells"
        ),
        "{text}"
    );
    assert!(
        text.contains("−95.0 helps") && text.contains("+1.50 hurts") && !text.contains("### t,"),
        "{text}"
    );
    let csv = String::from_utf8(table::csv(&map, &sessions, &kinds).unwrap()).unwrap();
    let row = csv.lines().find(|line| line.starts_with("s,uniform,pcm+gc,0.1,3,20,")).unwrap();
    assert!(row.contains(",0.9,0.75,pcm,-95") && row.ends_with(",helps"), "{row}");
    let again = Map::new(&sample(), &[]).unwrap();
    assert_eq!(map, again);
}

#[test]
fn a_cell_without_results_and_a_session_without_the_cell_are_no_data() {
    let mut text = line("s", "pcm", "1", "\"0.1\"", 1, 1.0) + "\n";
    text += &(line("s", "pcm", "3", "\"0.1\"", 1, 2.0) + "\n");
    text += &(line("t", "pcm", "1", "\"0.1\"", 1, 5.0) + "\n");
    let map = Map::new(&results(&text).unwrap(), &[]).unwrap();
    assert_eq!(map.of("t", "uniform", "pcm").unwrap().cells[1], None);
    let all = &map.of("all sessions", "uniform", "pcm").unwrap().cells;
    assert_eq!(
        (all[0].unwrap().mean, all[1]),
        (3.0, None),
        "a mean over other sessions would be another quantity"
    );
    assert!(table::markdown(&map, &map.sessions, &map.kinds).contains("no data"));
    // Session t has no corridor mistakes: means are over the other sessions, and a sentence says so.
    text += &(line("s", "pcm", "1", "\"0.1\"", 1, 7.0).replace("uniform", "corridor") + "\n");
    let map = Map::new(&results(&text).unwrap(), &[]).unwrap();
    assert_eq!(map.kinds, ["uniform", "corridor"]);
    assert_eq!(map.of("all sessions", "corridor", "pcm").unwrap().cells[0].unwrap().mean, 7.0);
    assert_eq!(map.of("t", "corridor", "pcm").unwrap().cells, [None, None]);
    let kinds = sections(&map).into_iter().find(|(name, _)| *name == "kinds").unwrap().1;
    assert!(
        kinds.contains("No corridor mistakes on t; means over sessions are over the others there."),
        "{kinds}"
    );
}

#[test]
fn methods_stand_after_what_they_are_compared_with() {
    let names = ["pcm+gc", "gc", "none", "pcm-root", "pcm"];
    let text = names.map(|name| line("s", name, "1", "\"0.1\"", 1, 1.0)).join("\n");
    let all = results(&text).unwrap();
    let order = |asked: &[String]| Map::new(&all, asked).unwrap().methods;
    assert_eq!(order(&[]), ["none", "pcm", "pcm-root", "gc", "pcm+gc"]);
    assert_eq!(order(&["gc".to_owned()]), ["gc", "none", "pcm", "pcm-root", "pcm+gc"]);
}

#[test]
fn what_cannot_be_placed_is_refused_in_sentences() {
    let said = |text: &str| format!("{:#}", results(text).and_then(|all| Map::new(&all, &[])).unwrap_err());
    let twice = line("s", "pcm", "1", "\"0.1\"", 1, 1.0) + "\n" + &line("s", "pcm", "1", "\"0.1\"", 1, 2.0);
    assert!(
        said(&twice).contains("seed 1 of pcm on s, covariance scale 1, rate 0.1 occurs twice"),
        "{}",
        said(&twice)
    );
    let word = line("s", "pcm", "\"wide\"", "\"0.1\"", 1, 1.0);
    assert!(said(&word).contains("has the label covariance_scale=wide, but needs a finite number"));
    let none = word.replace(r#""covariance_scale":"wide","#, "");
    assert!(said(&none).contains("has no label covariance_scale"), "{}", said(&none));
    assert!(said("\n").contains("there are no results"), "{}", said("\n"));
    let broken = line("s", "pcm", "1", "\"0.1\"", 1, 1.0) + "\n{\n";
    assert!(said(&broken).contains("results.jsonl, line 2: is not a result"), "{}", said(&broken));
}

#[test]
fn heat_maps_and_curves_say_what_the_map_says() {
    use posecut_report::figure::plotting::{charts, grids};
    use posecut_report::figure::regimes::{Quantity, curves, differences, heat_maps};
    let map = Map::new(&sample(), &[]).unwrap();
    let (panels, ramp) = heat_maps(&map, "s", "uniform", Quantity::Rmse);
    assert_eq!(panels.iter().map(|panel| panel.title.as_str()).collect::<Vec<_>>(), ["pcm", "pcm+gc"]);
    let texts = |panel: usize| -> Vec<&str> {
        panels[panel].cells.iter().flatten().map(|cell| cell.text.as_str()).collect()
    };
    assert_eq!((texts(0), texts(1)), (vec!["1.95", "1.95", "101"], vec!["3.45", "2.05", "5.95"]));
    let (changes, _) = differences(&map, "s", "uniform");
    assert_eq!(changes[0].title, "pcm+gc against pcm");
    assert_eq!(changes[0].note, "helps in 1, neutral in 1, hurts in 1");
    let dots: Vec<bool> = changes[0].cells.iter().flatten().map(|cell| cell.dot).collect();
    assert_eq!(dots, [true, false, true]);
    let draw = || grids("a map", &panels, &ramp, 2).unwrap().write("svg").unwrap();
    let svg = String::from_utf8(draw()).unwrap();
    assert!(svg.contains(">101<") && svg.contains(">mean RMSE over seeds (m)<") && svg.as_bytes() == draw());
    let lines = curves(&map, "s", "uniform", 2, 0);
    assert!((lines[1].lines[0].points[2].1 - 100.95).abs() < 1e-9, "over scales, without the graph cut");
    assert!(lines[1].lines[0].band[2].0 < 100.95 && lines[1].lines[0].band[2].1 > 100.95);
    assert!(charts(&lines, 2).unwrap().write("png").unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_tables_of_the_document_stand_between_their_markers_and_say_what_the_map_says() {
    let map = Map::new(&sample(), &[]).unwrap();
    let document = "before\n<!-- begin: a -->\nold\n<!-- end: a -->\nafter\n";
    let once = splice(document, "a", "| new |\n").unwrap();
    assert_eq!(once, "before\n<!-- begin: a -->\n\n| new |\n\n<!-- end: a -->\nafter\n");
    assert_eq!(splice(&once, "a", "| new |\n").unwrap(), once);
    let command = splice(document, "a", "\n    make table\n").unwrap();
    assert!(
        command.contains("-->\n\n    make table\n\n<!--"),
        "a code block keeps its indentation: {command}"
    );
    assert!(splice(document, "b", "").unwrap_err().to_string().contains("<!-- begin: b -->"));
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/results/regimes.md");
    let page = std::fs::read_to_string(path).unwrap();
    let tables = sections(&map);
    for (name, text) in &tables {
        splice(&page, name, text).unwrap();
    }
    let effect = map.comparisons.iter().find_map(|comparison| comparison.cells[0]).unwrap();
    assert!(tables[0].1.contains(&signed(effect.difference)), "{}", tables[0].1);
}

/// A real and a simulated session may have the same date.
#[test]
fn real_and_simulated_sessions_are_never_taken_together() {
    let real = line("2012-01-22", "pcm", "1", "0.1", 1, 2.0);
    let simulated = real.replacen("\"labels\":{", "\"labels\":{\"pipeline\":\"regimes-simulated\",", 1);
    let map = Map::new(&results(&format!("{real}\n{simulated}\n")).unwrap(), &[]).unwrap();
    assert_eq!(map.sessions, ["2012-01-22", "2012-01-22 (simulated)"]);
    let other = |text: &str| text.replace("2012-01-22", "2012-08-04");
    let lines = [real.clone(), simulated.clone(), other(&real), other(&simulated)].join("\n");
    let map = Map::new(&results(&lines).unwrap(), &[]).unwrap();
    assert_eq!(map.sessions[..2], ["real sessions", "simulated sessions"]);
    assert_eq!(map.singles().count(), 4);
}
