//! arael in the plane: Levenberg-Marquardt, `LmConfig::well_conditioned`, the model of its own Manhattan example with
//! information matrices.

use std::time::Instant;

use arael::model::{CrossBlock, Param, SelfBlock};
use arael::refs::{self, Ref};
use arael::simple_lm::{LmConfig, LmProblem};
use arael::vect::{vect2d, vect3d};
use nalgebra::Matrix3;

use crate::graph::{Graph, Outcome};

#[arael::model]
struct Pose2 {
    pos: Param<vect2d>,
    th: Param<f64>,
    hb: SelfBlock<Pose2>,
}

#[arael::model]
#[arael(constraint(p.hb, {
    [p.pos.x - prior.pos.x,
     p.pos.y - prior.pos.y,
     p.th - prior.th]
}))]
struct Prior {
    #[arael(ref = root.poses)]
    p: Ref<Pose2>,
    pos: vect2d,
    th: f64,
}

/// `s0`, `s1`, `s2` are the rows of the information's root.
#[arael::model]
#[arael(constraint(hb, {
    let local = matrix2sym::rotation(edge.dth).transpose()
        * (matrix2sym::rotation(a.th).transpose() * (b.pos - a.pos) - edge.delta);
    let rr = rad_diff(b.th, a.th + edge.dth);
    [edge.s0.x * local.x + edge.s0.y * local.y + edge.s0.z * rr,
     edge.s1.x * local.x + edge.s1.y * local.y + edge.s1.z * rr,
     edge.s2.x * local.x + edge.s2.y * local.y + edge.s2.z * rr]
}))]
struct Edge {
    #[arael(ref = root.poses)]
    a: Ref<Pose2>,
    #[arael(ref = root.poses)]
    b: Ref<Pose2>,
    delta: vect2d,
    dth: f64,
    s0: vect3d,
    s1: vect3d,
    s2: vect3d,
    hb: CrossBlock<Pose2, Pose2>,
}

#[arael::model]
#[arael(root)]
struct Model {
    poses: refs::Vec<Pose2>,
    edges: std::vec::Vec<Edge>,
    prior: Option<Prior>,
}

pub fn solve(graph: &Graph, _: &str) -> Outcome {
    let mut model = Model { poses: refs::Vec::new(), edges: Vec::new(), prior: None };
    for pose in &graph.poses {
        let position = vect2d::new(pose[0], pose[1]);
        let own = Pose2 { pos: Param::new(position), th: Param::new(pose[2]), hb: SelfBlock::new() };
        let reference = model.poses.push(own);
        if model.prior.is_none() {
            model.prior = Some(Prior { p: reference, pos: position, th: pose[2] });
        }
    }
    for edge in &graph.edges {
        let information = Matrix3::from_fn(|row, column| edge.information[row][column]);
        let Some(factor) = information.cholesky() else { continue };
        let root = factor.l().transpose();
        let row = |index: usize| vect3d::new(root[(index, 0)], root[(index, 1)], root[(index, 2)]);
        let m = &edge.measurement;
        model.edges.push(Edge {
            a: model.poses.ref_at(edge.from as u32),
            b: model.poses.ref_at(edge.to as u32),
            delta: vect2d::new(m[0], m[1]),
            dth: m[2],
            s0: row(0),
            s1: row(1),
            s2: row(2),
            hb: CrossBlock::new(),
        });
    }
    let configuration = LmConfig::well_conditioned();
    let start = Instant::now();
    let result = model.solve_sparse(&configuration);
    let seconds = start.elapsed().as_secs_f64();
    let iterations = result.ok().map(|result| result.iterations);
    let poses = model.poses.iter().map(|pose| vec![pose.pos.value.x, pose.pos.value.y, pose.th.value]).collect();
    Outcome { seconds, poses, iterations }
}
