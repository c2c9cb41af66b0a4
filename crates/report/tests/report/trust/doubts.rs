//! Tests doubts of stages in the benchmark.

use posecut_report::trust::Half;
use posecut_report::trust::tables::{doubts, tables};

use super::{done, read, refused, sample};

#[test]
fn doubts_are_counted_in_one_table_and_change_no_other() {
    let plain = read(&sample("test")).unwrap();
    assert_eq!(doubts(&plain, Half::Test), None, "results of older programs have none");
    let lines = sample("test").replacen(
        "\"version\":1,",
        r#""version":1,"doubts":[{"stage":"pcm","doubt":"nothing-kept"},{"stage":"pcm","doubt":"nothing-kept"}],"#,
        3,
    );
    let doubtful = read(&lines).unwrap();
    let table = doubts(&doubtful, Half::Test).unwrap();
    let rows: Vec<String> = table.cells[1..].iter().map(|row| row.join(" ")).collect();
    assert_eq!(rows, ["one pcm nothing-kept 2 of 4", "two pcm nothing-kept 1 of 4"], "{table:?}");
    let others = |benchmark| -> Vec<_> {
        let all = tables(benchmark, Half::Test).into_iter();
        all.filter(|other| other.title != table.title).collect()
    };
    assert_eq!(others(&plain), others(&doubtful));
}

#[test]
fn doubts_of_another_layout_are_refused() {
    let line = done(("test", "f", "a", 1), "one", 1.0, [1, 0, 0]);
    let said = refused(&line.replace("\"version\":1,", r#""version":1,"doubts":["nothing-kept"],"#));
    assert!(said.contains("field `doubts`") && said.contains("`stage` and `doubt`"), "{said}");
}
