//! Published instances compared with their proven optima; skipped if the data are missing.
use std::path::PathBuf;

use posecut_multicut::{Options, read_mc, solve, verify};

/// Instance, optimum, and tolerance by the published digits.
const OPTIMA: [(&str, f64, f64); 20] = [
    ("sn_cloister", -45.0, 0.0),
    ("sn_gahuku", -27.0, 0.0),
    ("sn_congress", -89.0, 0.0),
    ("sn_bitcoinalpha", -432.0, 0.0),
    ("sn_bitcoinotc", -1849.0, 0.0),
    ("mod_karate", -0.419_789_612_1, 1e-9),
    ("mod_lesmis", -0.560_008_370_0, 1e-9),
    ("ogm_imageseg50", -4_227.513_695_083, 1e-6),
    ("ogm_knott150_50", -14_786.005_795_875, 1e-6),
    ("ogm_knott300_50", -11_915.077_196_887, 1e-6),
    ("ogm_knott450_50", -9_428.235_371_090, 1e-6),
    ("pace_exact005", -47.0, 0.0),
    ("pace_exact011", -63.0, 0.0),
    ("pace_exact021", -31.0, 0.0),
    ("pace_exact031", -534.0, 0.0),
    ("pace_exact041", -1_502.0, 0.0),
    ("pace_exact061", -7_527.0, 0.0),
    ("pace_exact121", -15_063.0, 0.0),
    // Nobody proved these optima before: the solver proves them, and the verifier confirms the proofs.
    ("em_SNEMI3D_test", -910_618.578_982, 1e-4),
    ("em_CREMI-C_train", -917_272.164_272_683, 1e-4),
];

fn data() -> Option<PathBuf> {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("POSECUT_SHARED_DATA").map_or_else(default, PathBuf::from).join("multicut");
    folder.is_dir().then_some(folder)
}

#[test]
fn published_optima_are_found_and_proved() {
    let Some(folder) = data() else {
        println!("skipped: no data: multicut");
        return;
    };
    for (name, optimum, tolerance) in OPTIMA {
        let graph = read_mc(std::fs::File::open(folder.join(name).with_extension("mc")).unwrap()).unwrap();
        let options = Options { time_limit: None, certificate: true, ..Options::default() };
        let solution = solve(&graph, &options);
        assert!(solution.optimal, "{name}");
        assert!((solution.objective - optimum).abs() <= tolerance, "{name}: {}", solution.objective);
        let mut text = Vec::new();
        solution.certificate.unwrap().write(&mut text).unwrap();
        assert!(verify(&graph, text.as_slice()).unwrap().optimal, "{name}");
    }
}

/// Instances of CP-Lib that are proved quickly, and others whose published optimum a little work reaches.
const PROVED: [&str; 16] = [
    "abr_bridges",
    "abr_cars",
    "abr_cetacea",
    "abr_companies",
    "abr_hayes-roth",
    "abr_lung-cancer",
    "abr_lymphography",
    "abr_micro",
    "abr_soybean-21",
    "abr_ta-evaluation",
    "abr_uno_1a",
    "abr_uno_2b",
    "abr_uno_3a",
    "abr_wildcats",
    "abr_workers",
    "abr_zoo",
];
const REACHED: [&str; 8] = [
    "abr_soup",
    "clusedit_ce50-40",
    "clusedit_ce50-60",
    "clusedit_ce60-20",
    "clusedit_ce60-40",
    "clusedit_ce70-20",
    "clusedit_ce80-20",
    "clusedit_ce80-60",
];

#[test]
fn complete_graphs_of_cp_lib_reach_their_optima() {
    let Some(folder) = data().map(|folder| folder.join("cplib")).filter(|folder| folder.is_dir()) else {
        println!("skipped: no data: multicut/cplib");
        return;
    };
    let optima = std::fs::read_to_string(folder.join("optima.txt")).unwrap();
    let optimum = |name: &str| -> f64 {
        let mut words = optima
            .lines()
            .map(|line| line.split(' '))
            .find(|words| words.clone().next() == Some(name))
            .unwrap();
        words.nth(2).unwrap().parse().unwrap()
    };
    for (names, work, proved) in [(&PROVED[..], None, true), (&REACHED[..], Some(100_000_000), false)] {
        for name in names {
            let graph =
                read_mc(std::fs::File::open(folder.join(name).with_extension("mc")).unwrap()).unwrap();
            let options =
                Options { time_limit: None, work_limit: work, certificate: true, ..Options::default() };
            let solution = solve(&graph, &options);
            assert!(solution.optimal || !proved, "{name}");
            assert!((solution.objective - optimum(name)).abs() < 1e-9, "{name}: {}", solution.objective);
            let mut text = Vec::new();
            solution.certificate.unwrap().write(&mut text).unwrap();
            assert_eq!(verify(&graph, text.as_slice()).unwrap().optimal, solution.optimal, "{name}");
        }
    }
}
