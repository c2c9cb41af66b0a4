//! Properties of the tables for random records.

use posecut_report::figure::plotting::lanes;
use posecut_report::figure::regret::{figure, regrets};
use posecut_report::trust::Half;
use posecut_report::trust::summary::summary;
use posecut_report::trust::tables::{Table, tables};
use proptest::prelude::*;

use super::{done, failed, read};

/// Records of two methods, and of a third that may fail, on up to three families, clusters and seeds.
fn any_lines() -> impl Strategy<Value = Vec<String>> {
    let run =
        (0..3_usize, 0..3_usize, prop::bool::ANY, prop::array::uniform3(0.0..100.0_f64), prop::bool::ANY);
    prop::collection::vec(run, 1..12).prop_map(|runs| {
        let mut lines = Vec::new();
        for (seed, (family, cluster, test, rmse, fails)) in runs.into_iter().enumerate() {
            let half = if test { "test" } else { "tuning" };
            let place =
                (half, ["f", "g", "h"][family], ["a", "b", "c"][cluster], u32::try_from(seed).unwrap());
            for (method, error) in ["one", "two", "three"].into_iter().zip(rmse) {
                if fails && method == "three" {
                    lines.push(failed(place, method));
                } else {
                    lines.push(done(
                        place,
                        method,
                        error,
                        [u32::try_from(seed).unwrap() % 4, 1, seed as u32 % 2],
                    ));
                }
            }
        }
        lines
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn regret_is_never_negative_and_the_best_has_none(lines in any_lines()) {
        let benchmark = read(&lines.concat()).unwrap();
        for run in &benchmark.runs {
            let regrets: Vec<f64> = (0..3).filter_map(|method| run.regret(method)).collect();
            prop_assert!(regrets.iter().all(|regret| *regret >= 0.0));
            prop_assert!(regrets.contains(&0.0));
            for method in 0..3 {
                prop_assert!(run.regret(method) != Some(0.0) || run.within(method), "the best is within the bound");
            }
        }
    }

    #[test]
    fn intervals_contain_what_they_are_of_or_are_absent(lines in any_lines()) {
        let benchmark = read(&lines.concat()).unwrap();
        for method in 0..benchmark.methods.len() {
            let own = summary(&benchmark, Half::Test, None, method);
            let clusters: std::collections::BTreeSet<_> =
                benchmark.of(Half::Test, None).map(|run| (&run.family, &run.cluster)).collect();
            let several = clusters.iter().any(|one| clusters.iter().any(|other| one.0 == other.0 && one.1 != other.1));
            if let Some(share) = own.share {
                prop_assert_eq!(share.interval.is_some(), several);
                if let Some((low, high)) = share.interval {
                    prop_assert!(0.0 <= low && low <= high && high <= 1.0);
                }
            }
        }
    }

    #[test]
    fn the_order_of_lines_changes_nothing(
        (lines, shuffled) in any_lines().prop_flat_map(|lines| (Just(lines.clone()), Just(lines).prop_shuffle()))
    ) {
        let all = |lines: &[String]| {
            let benchmark = read(&lines.concat()).unwrap();
            let half = benchmark.runs.iter().map(|run| run.half).max().unwrap();
            let text: String = tables(&benchmark, half).iter().map(Table::markdown).collect();
            let drawing = lanes(&figure(&regrets(&benchmark, half)), 3).unwrap().write("svg").unwrap();
            (text, drawing)
        };
        prop_assert_eq!(all(&lines), all(&shuffled));
    }
}
