//! Reading and writing speed in bytes per second, one core.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, NodeTruth, PoseGraph};

fn chain(nodes: u64) -> PoseGraph {
    let mut graph = PoseGraph::new(Header::new(Dimension::Three));
    for id in 0..nodes {
        let angle = id as f64 * 0.001;
        let pose = vec![
            angle.sin() * 321.0,
            angle.cos() * 123.0,
            angle * 0.1,
            0.0,
            0.0,
            (angle / 2.0).sin(),
            (angle / 2.0).cos(),
        ];
        graph.nodes.push(Node {
            id,
            session: Some("2012-01-22/a".to_owned()),
            frame: Some(id as i64),
            utime: Some(1_327_194_947_000_000 + id as i64 * 2_000_000),
            truth: Some(NodeTruth { pose: Some(pose.clone()), ..NodeTruth::default() }),
            pose: Some(pose.clone()),
            ..Node::default()
        });
        if id > 0 {
            let mut edge = Edge::new(EdgeKind::Odometry, id - 1, id - 1, id);
            edge.measurement = Some(pose);
            edge.information = Some(
                (0..21)
                    .map(|term| if [0, 6, 11, 15, 18, 20].contains(&term) { 11.111_111_1 } else { 0.0 })
                    .collect(),
            );
            graph.edges.push(edge);
        }
    }
    graph
}

fn json_lines(criterion: &mut Criterion) {
    let graph = chain(20_000);
    let mut bytes = Vec::new();
    graph.write(&mut bytes).expect("the chain is finite");
    let mut group = criterion.benchmark_group("json_lines");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("read", |bencher| bencher.iter(|| PoseGraph::read("bench", bytes.as_slice())));
    group.bench_function("write", |bencher| {
        bencher.iter(|| {
            let mut out = Vec::with_capacity(bytes.len());
            graph.write(&mut out).map(|()| out)
        });
    });
    group.finish();
}

criterion_group!(benches, json_lines);
criterion_main!(benches);
