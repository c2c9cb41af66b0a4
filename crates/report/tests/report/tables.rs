//! Tests tables with hand-made results.

use std::fs;
use std::path::{Path, PathBuf};

use posecut_report::published::Published;
use posecut_report::results::read_all;
use posecut_report::table::{latex, markdown, tables, write_csv};

fn result(folder: &Path, method: &str, session: &str, seed: u64, rmse: f64, components: usize) -> PathBuf {
    let path = folder.join(format!("{method}-{session}-{seed}.result.json"));
    let text = format!(
        r#"{{"format":"posecut-result","version":1,"labels":{{"pipeline":"paper","method":"{method}","session":"{session}","seed":{seed}}},
            "rmse":{rmse},"components":{components},"edges":{{"true_positive":9,"false_positive":{seed},"false_negative":1,"true_negative":2}}}}"#
    );
    fs::write(&path, text).unwrap();
    path
}

fn published() -> Published {
    let text = "source = \"a paper\"\n[rmse.pcm]\n\"s\" = 97.4\n\"u\" = 2.6\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("published.toml");
    fs::write(&path, text).unwrap();
    Published::read(&path).unwrap()
}

/// The TOML library's drawing of the line took several lines of the message.
#[test]
fn errors_of_published_figures_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("published.toml");
    for (text, line, part) in [
        ("source = \"a\"\n\n[rmse.pcm]\ns = \"x\"\n", "published.toml, line 4, rmse.pcm.s: ", "expected f64"),
        ("source = \"a\"\nyear = 2020\n", "published.toml, line 2", "unknown field `year`"),
        ("[rmse.pcm]\n", "published.toml", "missing field `source`"),
        ("source = \"a\"\n[rmse.pcm\n", "published.toml, line 2", "rmse.METHOD"),
        ("source = 1\n", "published.toml, line 1, source: ", "string"),
        ("source = \"a\"\n[rmse.pcm]\ns = nan\n", "published.toml: rmse.pcm.s is NaN", "finite"),
    ] {
        fs::write(&path, text).unwrap();
        let said = format!("{:#}", Published::read(&path).unwrap_err());
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains(line) && said.contains(part), "{said}");
    }
}

#[test]
fn means_spreads_and_published_figures_stand_where_they_belong() {
    let folder = tempfile::tempdir().unwrap();
    result(folder.path(), "pcm", "s", 1, 10.0, 1);
    result(folder.path(), "pcm", "s", 2, 14.0, 1);
    result(folder.path(), "pcm", "t", 1, 2.0, 2);
    result(folder.path(), "gc", "s", 1, 0.5, 1);
    let results = read_all(&[folder.path().to_owned()]).unwrap();
    let order = ["pcm".to_owned(), "gc".to_owned()];
    let tables = tables(&results, &order, &["z".to_owned()]);
    assert_eq!(tables[0].sessions, ["s", "t", "z"]);
    let cell = tables[0].methods[0].cells[0].clone().unwrap();
    assert_eq!((cell.mean, cell.seeds, cell.false_kept, cell.false_all), (12.0, 2, 1.5, 3.5));
    assert!((cell.deviation.unwrap() - 8.0_f64.sqrt()).abs() < 1e-12, "the sample deviation of 10 and 14");
    assert_eq!(tables[0].methods[0].mean(), Some(7.0), "the mean of the sessions' means");
    let text = markdown(&tables, &published());
    let row = |start: &str| {
        let line = text.lines().find(|line| line.starts_with(start)).unwrap();
        line.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(row("| pcm  "), "| pcm | 12.0 ± 2.83 | 2.00 † | no data | 7.00 |");
    assert_eq!(row("| pcm, published"), "| pcm, published | 97.4 | – | – | 50.0 |");
    assert!(text.contains("† in at least one seed"), "{text}");
    let tex = latex(&tables, &published());
    assert!(tex.contains("pcm & $12.0 \\pm 2.83$ & 2.00 & -- & 7.00 \\\\"), "{tex}");
    let csv = String::from_utf8(write_csv(&results).unwrap()).unwrap();
    assert!(csv.contains("paper,pcm,s,2,14,1,9,2,1,2"), "{csv}");
    assert_eq!(csv.lines().count(), 5);
}

/// Regression: a table of runs with another program in the place of PCM showed its figures in PCM's row without a word.
#[test]
fn a_replaced_stage_has_a_row_of_its_own_that_names_the_program() {
    let folder = tempfile::tempdir().unwrap();
    result(folder.path(), "pcm", "2012-01-22", 1, 3.0, 1);
    let replaced = result(folder.path(), "pcm", "2012-01-22", 2, 5.0, 1);
    let text = std::fs::read_to_string(&replaced).unwrap();
    std::fs::write(&replaced, text.replace(r#""seed":2"#, r#""seed":2,"replaced":"pcm = ./my-stage""#))
        .unwrap();
    let results = read_all(&[folder.path().to_owned()]).unwrap();
    let tables = tables(&results, &["pcm".to_owned()], &[]);
    let rows: Vec<(&str, Option<f64>)> =
        tables[0].methods.iter().map(|row| (row.method.as_str(), row.mean())).collect();
    assert_eq!(rows, [("pcm", Some(3.0)), ("pcm (pcm = ./my-stage)", Some(5.0))]);
}

#[test]
fn what_is_no_result_is_refused_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.result.json");
    for (text, part) in [
        ("{", "is not a result"),
        (r#"{"format":"other","version":1,"labels":{},"rmse":1,"components":1}"#, "\"other\" version 1"),
        (r#"{"format":"posecut-result","version":2,"labels":{},"rmse":1,"components":1}"#, "version 2"),
    ] {
        fs::write(&path, text).unwrap();
        let error = format!("{:#}", read_all(std::slice::from_ref(&path)).unwrap_err());
        assert!(error.contains("x.result.json") && error.contains(part), "{error}");
    }
    let error = format!("{:#}", read_all(&[folder.path().join("none.json")]).unwrap_err());
    assert!(error.contains("none.json: cannot be opened"), "{error}");
}

#[test]
fn figures_are_drawn_in_all_formats_and_the_same_each_time() {
    use posecut_graph::PoseGraph;
    use posecut_report::figure::plotting::charts;
    use posecut_report::figure::{Frame, graphs, trajectories};
    let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"session":"s/a","frame":0,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"s/a","frame":1,"pose":[50,10,0]}
{"kind":"node","id":2,"session":"s/b","frame":2,"pose":[60,40,0]}
{"kind":"node","id":3,"session":"s/b","frame":3,"pose":[10,30,0]}
{"kind":"landmark","id":0,"from":0,"to":3,"truth":{"correct":true}}
{"kind":"landmark","id":1,"from":1,"to":3,"truth":{"correct":false}}
{"kind":"landmark","id":2,"from":1,"to":2,"truth":{"correct":false},"rejected_by":"pcm"}
"#;
    let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
    let panel = graphs::panel("PCM & more", &graph, Some(&graph), Frame::Ned);
    let legends: Vec<&str> = panel.lines.iter().filter_map(|line| line.legend.as_deref()).collect();
    assert_eq!(
        legends,
        [
            "reference",
            "s/a",
            "s/b",
            "correct, in use (1)",
            "incorrect, rejected (1)",
            "incorrect, in use (1)"
        ]
    );
    assert_eq!(panel.lines[2].points, [(0.0, 0.0), (10.0, 50.0)], "east to the right, north upwards");
    let panels = [panel, trajectories::panels(&[("s".to_owned(), graph)], Frame::Xy).remove(0)];
    let draw = |extension: &str| charts(&panels, 2).and_then(|drawing| drawing.write(extension));
    let svg = draw("svg").unwrap();
    assert!(String::from_utf8(svg.clone()).unwrap().contains("<svg"));
    assert!(svg == draw("svg").unwrap(), "the same bytes each time");
    for (extension, magic) in [("png", &b"\x89PNG"[..]), ("pdf", b"%PDF-")] {
        if extension == "pdf" && cfg!(not(feature = "pdf")) {
            println!("skipped: built without PDF");
            continue;
        }
        let bytes = draw(extension).unwrap();
        assert!(bytes.starts_with(magic) && bytes == draw(extension).unwrap(), "{extension}");
    }
    assert!(draw("gif").unwrap_err().to_string().contains(".svg, .pdf or .png"));
    assert!(charts(&[], 2).is_err());
}

/// Labels of a foreign result used to become formulas of spreadsheets, cells and elements of Markdown, and commands of
/// LaTeX.
#[test]
fn hostile_labels_stay_text_in_every_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = result(folder.path(), "METHOD", "SESSION", 1, 2.0, 1);
    let text = fs::read_to_string(&path).unwrap();
    let text = text
        .replace("METHOD", "=HYPERLINK('x')|<script>")
        .replace("SESSION", "@SUM(A1)<img src=x>")
        .replace("\"paper\"", r#""+paper\n\\input{x}""#);
    fs::write(&path, text).unwrap();
    let results = read_all(&[folder.path().to_owned()]).unwrap();
    let csv = String::from_utf8(write_csv(&results).unwrap()).unwrap();
    let row = csv.split_once('\n').unwrap().1;
    assert!(
        row.starts_with("\"'+paper\n\\input{x}\",'=HYPERLINK('x')|<script>,'@SUM(A1)<img src=x>,1,"),
        "{csv}"
    );
    let tables = tables(&results, &[], &[]);
    let text = markdown(&tables, &published());
    assert!(
        text.contains("### +paper \\input{x}\n") && text.contains("| =HYPERLINK('x')\\|&lt;script> |"),
        "{text}"
    );
    assert!(!text.contains("<script") && !text.contains("<img"), "{text}");
    let tex = latex(&tables, &published());
    assert!(!tex.contains("\\input"), "{tex}");
}

/// Puts doubts into the result in a file. Doubts of a second call take precedence.
fn doubt(path: &Path, doubts: &str) {
    let text = fs::read_to_string(path).unwrap().replace("\"doubts\":[],", "");
    fs::write(path, text.replace("\"version\":1,", &format!("\"version\":1,\"doubts\":{doubts},"))).unwrap();
}

#[test]
fn doubtful_runs_carry_a_dagger_and_a_note_names_stage_doubt_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    let first = result(folder.path(), "pcm", "s", 1, 10.0, 1);
    let second = result(folder.path(), "pcm", "s", 2, 14.0, 2);
    let third = result(folder.path(), "gc", "s", 1, 0.5, 1);
    let before = || {
        let results = read_all(&[folder.path().to_owned()]).unwrap();
        let tables = tables(&results, &[], &[]);
        let csv = String::from_utf8(write_csv(&results).unwrap()).unwrap();
        (markdown(&tables, &published()), latex(&tables, &published()), csv)
    };
    let (plain, plain_tex, plain_csv) = before();
    assert!(plain.contains("† in at least one seed"), "results of older programs: {plain}");
    for path in [&first, &third] {
        doubt(path, "[]");
    }
    assert_eq!(before(), (plain, plain_tex.clone(), plain_csv.clone()), "no doubts, no change");
    let own = r#"{"stage":"pcm","doubt":"nothing-kept"}"#;
    doubt(&first, &format!("[{own},{own}]"));
    doubt(&second, &format!(r#"[{own},{{"stage":"optimize","doubt":"parts-not-connected"}}]"#));
    doubt(&third, r#"[{"stage":"a|<b>","doubt":"=1\n\\input{x}"}]"#);
    let (text, tex, csv) = before();
    let start = text.find("† doubts").unwrap();
    let note: String = text[start..].lines().next().unwrap().to_owned();
    assert!(note.contains("optimize: parts-not-connected (1 run), pcm: nothing-kept (2 runs)."), "{note}");
    assert!(note.contains("a\\|&lt;b>: =1 \\input{x} (1 run)"), "{note}");
    assert!(!text.contains("† in at least one seed"), "one note for one thing: {text}");
    assert!(text.contains("12.0 ± 2.83 † |") && text.contains("0.50 † |"), "{text}");
    assert!(tex.contains("$12.0 \\pm 2.83^\\dagger$") && tex.contains("$0.50^\\dagger$"), "{tex}");
    assert!(tex.contains("pcm: nothing-kept (2 runs)") && !tex.contains("\\input"), "{tex}");
    assert!(csv.starts_with(&format!("{},doubts\n", plain_csv.lines().next().unwrap())), "{csv}");
    assert!(csv.contains("pcm: nothing-kept; optimize: parts-not-connected"), "{csv}");
    assert_ne!(tex, plain_tex);
}

#[test]
fn doubts_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = result(folder.path(), "pcm", "s", 1, 10.0, 1);
    doubt(&path, r#"["nothing-kept"]"#);
    assert!(read_all(&[path]).is_err());
}
