//! Compares probabilities with shares of correct edges.

use posecut_report::figure::plotting::charts;
use posecut_report::figure::reliability::figure as diagram;
use posecut_report::trust::Half;
use posecut_report::trust::reliability::{ALL, reliability, sentence};
use posecut_report::trust::tables::{Table, calibration, tables};

use super::{judged, probabilities, read, refused, sample};

#[test]
fn the_calibration_error_of_an_example_by_hand() {
    let found = reliability(&read(&probabilities()).unwrap(), Half::Test).unwrap();
    let names: Vec<&str> = found.groups.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, [ALL, "f", "g"]);
    assert!(found.groups.iter().all(|group| group.curves.len() == 1), "`other` has no probabilities");
    let [all, f, g] = [0, 1, 2].map(|group| &found.groups[group].curves[0]);
    assert_eq!(
        [(all.runs, all.of, all.edges), (f.runs, f.of, f.edges), (g.runs, g.of, g.edges)],
        [(3, 4, 200), (2, 2, 120), (1, 2, 80)]
    );
    // Bins are pooled before the comparison: 16 of 20 are correct at a sum of 16.6, and 172 of 180 at 178.
    assert!((all.error - (0.6 + 6.0) / 200.0).abs() < 1e-12, "{}", all.error);
    assert!((f.error - (0.6 + 2.0) / 120.0).abs() < 1e-12, "{}", f.error);
    assert!((g.error - 8.0 / 80.0).abs() < 1e-12, "{}", g.error);
    let close = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1e-12, "{value} {wanted}");
    close(all.points[0].probability, 0.83);
    close(all.points[0].correct, 0.8);
    close(all.points[1].correct, 172.0 / 180.0);
    assert_eq!((all.points[0].bin, all.points[1].bin, all.points[0].edges), (8, 9, 20));
    // Family f has two clusters with edges in bin 8: 7 of 10 and 9 of 10 are correct.
    assert_eq!(all.points[0].interval, Some((0.7, 0.9)));

    let text: String = calibration(&found).iter().map(Table::markdown).collect();
    for part in
        ["| all families | 3 of 4 |", "0.0330", "0.1000", "| 0.8 to 0.9 |", "0.800 [0.700, 0.900]", "–"]
    {
        assert!(text.replace("  ", " ").replace("  ", " ").contains(part), "{part}\n{text}");
    }
    let said = sentence(Some(&found), Half::Test);
    assert_eq!(
        said,
        "The expected calibration error of `judge` on the test half is 0.0330, over 200 edges of 3 runs. Over the 20 edges in doubt, with a probability of 0.1 to 0.9, it is 0.030; their odds are 0.82 times what the probabilities say."
    );
    // 16 of 20 are correct, odds 4; a mean probability of 0.83 has odds 0.83 / 0.17.
    let doubtful = all.doubtful.unwrap();
    assert_eq!(doubtful.edges, 20);
    close(doubtful.error, 0.03);
    assert!((doubtful.odds.unwrap() - 4.0 * 0.17 / 0.83).abs() < 1e-9, "{doubtful:?}");
    let panels = diagram(&found);
    assert_eq!(panels.len(), 3);
    assert_eq!(panels[0].lines[1].points.len(), 2);
    assert_eq!(panels[0].lines[1].legend.as_deref(), Some("judge: error 0.0330, 200 edges"));
    for format in ["svg", "png"] {
        assert!(charts(&panels, 3).unwrap().write(format).unwrap().len() > 1000);
    }
}

#[test]
fn without_records_of_calibration_there_is_nothing_to_report() {
    let benchmark = read(&sample("test")).unwrap();
    assert_eq!(reliability(&benchmark, Half::Test), None);
    let text: String = tables(&benchmark, Half::Test).iter().map(Table::markdown).collect();
    assert!(!text.contains("Calibration"), "{text}");
    // Neither a record of the other half nor one without edges counts for this half.
    let tuning = read(&probabilities().replace("\"half\":\"test\"", "\"half\":\"tuning\"")).unwrap();
    assert_eq!(reliability(&tuning, Half::Test), None);
    assert!(reliability(&tuning, Half::Tuning).is_some());
    let empty = judged(("test", "f", "a", 1), "judge", [(0, 0.0, 0), (0, 0.0, 0)]);
    assert_eq!(reliability(&read(&empty).unwrap(), Half::Test), None);
    assert!(sentence(None, Half::Test).contains("No result of the test half has probabilities"));
}

#[test]
fn a_record_of_calibration_that_cannot_be_is_refused() {
    let place = ("test", "f", "a", 1);
    let good = judged(place, "judge", [(10, 8.5, 7), (100, 98.0, 100)]);
    for (bad, part) in [
        (
            good.replace("[0,0,0,0,0,0,0,0,7,100]", "[0,7,100]"),
            "field `correct`: found [0,7,100], expected 10 numbers",
        ),
        (
            good.replace(",7,100]", ",11,100]"),
            "field `correct`, bin 8: found 11, expected at most the 10 edges",
        ),
        (
            good.replace(",8.5,98", ",9.5,98"),
            "field `probability`, bin 8: found 9.5 over 10 edges, expected 0.8 to 0.9",
        ),
        (good.replace(",8.5,98", ",null,98"), "field `probability`: found"),
        (good.replace(",10,100]", ",10,-1]"), "field `edges`: found"),
        (good.replace("\"calibration\":{", "\"calibration\":[],\"was\":{"), "field `calibration`: found []"),
    ] {
        assert_ne!(bad, good);
        let said = refused(&bad);
        assert!(said.contains("line 1") && said.contains(part), "{part}\n{said}");
    }
    let none = good.replace("\"calibration\":{", "\"calibration\":null,\"was\":{");
    assert_eq!(reliability(&read(&none).unwrap(), Half::Test), None);
}
