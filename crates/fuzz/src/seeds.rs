//! Small sound inputs of every format, made from testdata and the project's own simulation.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use posecut_convert::tum::Poses;
use posecut_convert::{g2o, kitti, toro, tum};
use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use serde_json::Value;

/// Former findings and hand-written inputs, from `crates/fuzz/corpus/TARGET/`.
pub(crate) fn kept(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|entry| entry.path()).collect())
        .unwrap_or_default();
    files.sort();
    files.iter().filter_map(|file| std::fs::read(file).ok()).collect()
}

fn written(graph: &PoseGraph) -> Vec<u8> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).expect("a sound graph is written to memory");
    bytes
}

/// Some twenty nodes of testdata/graph.jsonl around four landmark edges: two correct and two incorrect ones.
fn planar() -> PoseGraph {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/graph.jsonl");
    let text = std::fs::read(file).expect("testdata/graph.jsonl belongs to the sources");
    let mut graph = PoseGraph::read("testdata/graph.jsonl", text.as_slice()).expect("testdata is sound");
    let landmarks = |correct| {
        let edges = graph.edges_of(EdgeKind::Landmark);
        edges.filter(move |edge| edge.truth_correct() == Some(correct)).step_by(20).take(2).cloned()
    };
    let chosen: Vec<_> = landmarks(true).chain(landmarks(false)).collect();
    let near = |id: u64| chosen.iter().any(|edge| edge.from.abs_diff(id) <= 1 || edge.to.abs_diff(id) <= 1);
    graph.nodes.retain(|node| near(node.id));
    let nodes: Vec<u64> = graph.nodes.iter().map(|node| node.id).collect();
    let there = |id: u64| nodes.binary_search(&id).is_ok();
    let used = |id: u64| chosen.iter().any(|edge| edge.id == id);
    graph.edges.retain(|edge| {
        used(edge.id) || (edge.kind == EdgeKind::Odometry && there(edge.from) && there(edge.to))
    });
    graph.header.provenance.truncate(1);
    graph
}

fn spatial() -> PoseGraph {
    let lift =
        |pose: &Option<Vec<f64>>| Some(SE2::from_components(pose.as_ref()?)?.to_spatial().components());
    let widen = |terms: &[f64]| {
        let mut wide = vec![0.0; 21];
        for (place, term) in [(0, 0), (6, 3), (11, 3), (15, 5), (18, 5), (20, 5)] {
            wide[place] = terms[term];
        }
        wide
    };
    let mut graph = planar();
    graph.header.dimension = Dimension::Three;
    for (_, model) in &mut graph.header.noise_models {
        model.information = widen(&model.information);
    }
    for node in &mut graph.nodes {
        node.pose = lift(&node.pose);
        if let Some(truth) = &mut node.truth {
            truth.pose = lift(&truth.pose);
        }
    }
    for edge in &mut graph.edges {
        edge.measurement = lift(&edge.measurement);
    }
    graph
}

/// Graphs in the plane and in space, with and without rejected edges, and the smallest possible graph.
pub(crate) fn graphs() -> Vec<Vec<u8>> {
    let mut marked = planar();
    for (place, edge) in marked.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark).enumerate() {
        edge.cost = Some(if place % 2 == 0 { 1.0 } else { -1.0 });
        edge.score = Some(0.5);
        if place % 2 == 1 {
            edge.reject("multicut");
        }
    }
    let least = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n\
        {\"kind\":\"node\",\"id\":0,\"session\":\"a\",\"frame\":0,\"pose\":[0,0,0],\"truth\":{\"pose\":[0,0,0]}}\n\
        {\"kind\":\"node\",\"id\":1,\"session\":\"a\",\"frame\":1,\"utime\":5,\"pose\":[1,0,0],\"mood\":{\"a\":[1,null]}}\n\
        {\"kind\":\"odometry\",\"id\":0,\"from\":0,\"to\":1,\"measurement\":[1,0,0],\"information\":[1,0,0,1,0,1]}\n\
        {\"kind\":\"landmark\",\"id\":1,\"from\":0,\"to\":1,\"truth\":{\"correct\":true}}\n\
        {\"kind\":\"gps\",\"at\":[1,2]}\n";
    vec![written(&planar()), written(&marked), written(&spatial()), least.as_bytes().to_vec()]
}

/// Graphs with marginals from the optimiser and edges that PCM rejected.
pub(crate) fn predicted() -> Vec<Vec<u8>> {
    let with_marginals = |mut graph: PoseGraph, identity: &[f64], covariance: &[f64]| {
        for node in &mut graph.nodes {
            node.pose.get_or_insert_with(|| identity.to_vec());
        }
        let landmarks = graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark);
        for (place, edge) in landmarks.enumerate() {
            let predicted = if place % 7 == 6 { Value::Null } else { covariance.into() };
            edge.extra.insert("predicted_covariance".to_owned(), predicted);
            if place % 2 == 1 {
                edge.reject("pcm");
            }
        }
        written(&graph)
    };
    let diagonal = |axes: usize| -> Vec<f64> {
        let entries = (0..axes).flat_map(|row| (row..axes).map(move |column| (row, column)));
        entries.map(|(row, column)| if row == column { 1e-3 } else { 0.0 }).collect()
    };
    vec![
        with_marginals(planar(), &[0.0; 3], &diagonal(3)),
        with_marginals(spatial(), &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &diagonal(6)),
    ]
}

pub(crate) fn g2o() -> Vec<Vec<u8>> {
    let by_hand = "# by hand\nVERTEX_SE2 0 0 0 0\nFIX 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 6989586621679009793 1 1 0 0 1 0 0 1 0 1\n";
    vec![g2o::write(&planar(), true).0, g2o::write(&spatial(), true).0, by_hand.as_bytes().to_vec()]
}

pub(crate) fn toro() -> Vec<Vec<u8>> {
    let written = |graph| toro::write(&graph, true).expect("no measured pitch is a right angle").0;
    vec![written(planar()), written(spatial())]
}

pub(crate) fn tum() -> Vec<Vec<u8>> {
    vec![tum::write(&spatial(), Poses::Truth, None).expect("the seed has times and truth")]
}

pub(crate) fn kitti() -> Vec<Vec<u8>> {
    vec![kitti::write(&spatial(), Poses::Estimate, None).expect("the seed has poses")]
}

/// Instances with conflicted cycles, parallel edges and self-loops.
pub(crate) fn instances() -> Vec<Vec<u8>> {
    let mut ring = "MULTICUT\n".to_owned();
    for i in 0..12 {
        ring += &format!(
            "{i} {} {}\n{i} {} {}\n",
            (i + 1) % 12,
            1 + i % 3,
            (i + 5) % 12,
            -1.5 + f64::from(i % 4)
        );
    }
    vec![ring.into_bytes(), b"MULTICUT\n0 1 -1\n1 2 2.5e-1\n2 0 1\n\n3 3 7\n0 1 1\n".to_vec()]
}

/// The instance to which the certificates belong.
pub(crate) fn instance() -> &'static posecut_multicut::Graph {
    static INSTANCE: OnceLock<posecut_multicut::Graph> = OnceLock::new();
    INSTANCE.get_or_init(|| {
        posecut_multicut::read_mc(instances()[0].as_slice()).expect("the seed is an instance")
    })
}

pub(crate) fn certificates() -> Vec<Vec<u8>> {
    let options = posecut_multicut::Options { certificate: true, time_limit: None, ..Default::default() };
    let solution = posecut_multicut::solve(instance(), &options);
    let mut bytes = Vec::new();
    solution
        .certificate
        .expect("a certificate was asked for")
        .write(&mut bytes)
        .expect("it is written to memory");
    vec![bytes]
}

pub(crate) fn matches() -> Vec<Vec<u8>> {
    vec![
        b"frame_i,frame_j,score,session_i,session_j\n0,5,0.7,a,b\n3,9,1e-3,a,b\n".to_vec(),
        b"# scores\n0,5,0.7\n3, 9\n".to_vec(),
    ]
}

pub(crate) fn results() -> Vec<Vec<u8>> {
    vec![
        br#"{"format":"posecut-result","version":1,"labels":{"session":"a","seed":1,"method":"pcm","pipeline":"paper"},"rmse":1.5,"components":1,"edges":{"true_positive":3,"false_positive":1,"false_negative":0,"true_negative":2}}"#
            .to_vec(),
    ]
}

pub(crate) fn published() -> Vec<Vec<u8>> {
    vec![b"source = \"somewhere\"\n[rmse.pcm]\n\"2012-01-22\" = 97.4\n[rmse.\"pcm+gc\"]\n\"2012-01-22\" = 19.4\n".to_vec()]
}

/// A simulated log cut to four scans of eight beams, compressed by gzip too, and a line of the other layout.
pub(crate) fn logs() -> Vec<Vec<u8>> {
    let mut text = String::new();
    for scan in 0..4 {
        let x = 0.6 * f64::from(scan);
        text += &format!(
            "TRUEPOS {x} 0 0 {x} 0 0 {scan}.5 nohost 0\nFLASER 12 2 2.1 2.3 2.6 3 3.1 3.2 3 2.6 2.3 2.1 81.91 {x} 0 0 {x} 0 0 {scan}.5 nohost 0\n"
        );
    }
    let other =
        "ROBOTLASER1 0 -1.5 3.1 0.5 20 0.01 0 3 1 2 3 0 0.1 0 0 0 0 0 0.3 0 0.5 0.4 1000 5 host 0.5\n";
    let moved = other.replace("0.1 0 0 0 0 0 0.3", "1.1 0 0 1 0 0 0.3").replace(" 5 host", " 6 host");
    vec![compressed(text.as_bytes()), text.into_bytes(), format!("# log\n{other}{moved}").into_bytes()]
}

pub(crate) fn relations() -> Vec<Vec<u8>> {
    vec![
        b"# t1 t2 x y z roll pitch yaw\n1327233600.0 1327233602.5 0.5 0.1 0 0 0 0.1\n1 2 0 0 0 0 0 0\n"
            .to_vec(),
        b"1327233600 0 0 0 0 0 0 1\n1327233700 1 0 0 0 0 0.1 1\n".to_vec(),
    ]
}

/// The start of a line that opens a file in an input of several files.
pub(crate) const OPENING: &str = "==== ";

/// A simulated session, cut to its first rows: once with all files, once with only the integrated odometry, and twice with only
/// wheels and an attitude.
pub(crate) fn sessions() -> Vec<Vec<u8>> {
    let options =
        posecut_simulate::Options { length: Some(60.0), rate: 5.0, ..posecut_simulate::Options::DEFAULT };
    let session = posecut_simulate::simulate("2012-01-22", &options).expect("a short session is simulated");
    let mut files: Vec<(String, String)> = session
        .files
        .into_iter()
        .map(|file| {
            let mut bytes = Vec::new();
            file.write(&mut bytes).expect("memory takes it");
            (file.name, String::from_utf8(bytes).expect("numbers are text"))
        })
        .collect();
    files.sort();
    let joined = |wanted: &dyn Fn(&str) -> bool, rows: usize| {
        let mut text = String::new();
        for (name, content) in files.iter().filter(|(name, _)| wanted(name)) {
            text += &format!("{OPENING}{name}\n");
            text.extend(content.split_inclusive('\n').take(rows));
        }
        text.into_bytes()
    };
    vec![
        joined(&|_| true, 25),
        joined(&|name| name.contains("100hz"), 40),
        joined(
            &|name| name.starts_with("wheels") || name.contains("euler") || name.starts_with("ground"),
            40,
        ),
        joined(&|name| name.starts_with("wheels") || name.starts_with("kvh"), 40),
    ]
}

/// The files of the last of these sessions as an uncompressed archive, and the same archive with a member whose name leads
/// outside.
pub(crate) fn archives() -> Vec<Vec<u8>> {
    let mut archive = tar::Builder::new(Vec::new());
    for (name, content) in sections(&sessions()[3]) {
        let mut header = tar::Header::new_ustar();
        header.set_size(content.len() as u64);
        header.set_mode(0o644);
        archive
            .append_data(&mut header, format!("2012-01-22/{name}"), content)
            .expect("an archive is written to memory");
    }
    let plain = archive.into_inner().expect("an archive is written to memory");
    let mut escaping = plain.clone();
    let name = b"../../../wheels.csv\0";
    escaping[..name.len()].copy_from_slice(name);
    let sum: u32 = escaping[..512]
        .iter()
        .enumerate()
        .map(|(i, &b)| if (148..156).contains(&i) { 32 } else { u32::from(b) })
        .sum();
    escaping[148..156].copy_from_slice(format!("{sum:06o}\0 ").as_bytes());
    vec![plain, escaping]
}

/// Splits an input of several files into these files.
pub(crate) fn sections(input: &[u8]) -> Vec<(String, &[u8])> {
    let mut files: Vec<(String, &[u8])> = Vec::new();
    let mut start = None;
    let mut place = 0;
    let mut name = String::new();
    for line in input.split_inclusive(|&byte| byte == b'\n') {
        if let Some(opened) = line.strip_prefix(OPENING.as_bytes()) {
            if let Some(start) = start {
                files.push((std::mem::take(&mut name), &input[start..place]));
            }
            name = String::from_utf8_lossy(opened).trim().replace(['/', '\0'], "_");
            start = Some(place + line.len());
        }
        place += line.len();
    }
    if let Some(start) = start {
        files.push((name, &input[start..]));
    }
    files
}

pub(crate) fn compressed(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write as _;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("memory takes it");
    encoder.finish().expect("memory takes it")
}

/// A file of planar scans with few returns.
pub(crate) fn planar_scans() -> Vec<Vec<u8>> {
    let mut bytes = Vec::new();
    for time in 1..4 {
        posecut_nclt_sensors::write_hokuyo_scan(time, &[2.0, 0.0, 29.0], &mut bytes)
            .expect("memory takes it");
    }
    vec![bytes]
}

/// Hits of a turn.
pub(crate) fn spatial_scans() -> Vec<Vec<u8>> {
    vec![(0..40_u8).flat_map(|hit| [hit, 80, 255 - hit, 78, hit, 78, 100, hit % 32]).collect()]
}
