//! arael in space: Levenberg-Marquardt, `LmConfig::well_conditioned`, its coupled pose parameter. The residual is
//! `[R_z^T (R_a^T (t_b - t_a) - t_z); skew part of R_z^T R_a^T R_b]`, the logarithm to first order.

use std::time::Instant;

use arael::matrix::matrix3d;
use arael::model::{CrossBlock, SelfBlock};
use arael::quatern::quaternd;
use arael::refs::{self, Ref};
use arael::simple_lm::{LmConfig, LmProblem};
use arael::transform::TransformParam;
use arael::vect::vect3d;
use nalgebra::{Matrix6, Quaternion, UnitQuaternion};

use crate::graph::{Graph, Outcome};

#[arael::model]
struct Frame {
    r2w: TransformParam,
    hb: SelfBlock<Frame>,
}

#[arael::model]
#[arael(constraint(hb, {
    let ra = a.r2w.rotation_matrix;
    let dt = link.rotation_transposed * (ra.transpose() * (b.r2w.translation - a.r2w.translation) - link.translation);
    let dr = link.rotation_transposed * (ra.transpose() * b.r2w.rotation_matrix);
    let c1 = dr * vect3sym::from_components(1.0, 0.0, 0.0);
    let c2 = dr * vect3sym::from_components(0.0, 1.0, 0.0);
    let c3 = dr * vect3sym::from_components(0.0, 0.0, 1.0);
    let r = vect3sym::from_components((c2.z - c3.y) * 0.5, (c3.x - c1.z) * 0.5, (c1.y - c2.x) * 0.5);
    let upper = link.u_tt * dt + link.u_tr * r;
    let lower = link.u_rr * r;
    [upper.x, upper.y, upper.z, lower.x, lower.y, lower.z]
}, parent = link))]
struct Link {
    #[arael(ref = root.frames)]
    a: Ref<Frame>,
    #[arael(ref = root.frames)]
    b: Ref<Frame>,
    translation: vect3d,
    rotation_transposed: matrix3d,
    u_tt: matrix3d,
    u_tr: matrix3d,
    u_rr: matrix3d,
    hb: CrossBlock<Frame, Frame>,
}

#[arael::model]
#[arael(root)]
struct World {
    frames: refs::Vec<Frame>,
    links: std::vec::Vec<Link>,
}

fn quaternion(m: &[f64]) -> quaternd {
    quaternd::new(m[6], vect3d::new(m[3], m[4], m[5]))
}

pub fn solve(graph: &Graph, _: &str) -> Outcome {
    let mut world = World { frames: refs::Vec::new(), links: Vec::new() };
    for (index, pose) in graph.poses.iter().enumerate() {
        let (position, rotation) = (vect3d::new(pose[0], pose[1], pose[2]), quaternion(pose));
        let r2w = if index == 0 {
            TransformParam::fixed(position, rotation)
        } else {
            TransformParam::new(position, rotation)
        };
        world.frames.push(Frame { r2w, hb: SelfBlock::new() });
    }
    for edge in &graph.edges {
        let information = Matrix6::from_fn(|row, column| edge.information[row][column]);
        let Some(factor) = information.cholesky() else { continue };
        let root = factor.l().transpose();
        let block = |row: usize, column: usize| {
            let e = |r: usize, c: usize| root[(row + r, column + c)];
            matrix3d::from_elements(
                e(0, 0), e(0, 1), e(0, 2), e(1, 0), e(1, 1), e(1, 2), e(2, 0), e(2, 1), e(2, 2),
            )
        };
        let m = &edge.measurement;
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(m[6], m[3], m[4], m[5]));
        let t = turn.inverse().to_rotation_matrix().into_inner();
        world.links.push(Link {
            a: world.frames.ref_at(edge.from as u32),
            b: world.frames.ref_at(edge.to as u32),
            translation: vect3d::new(m[0], m[1], m[2]),
            rotation_transposed: matrix3d::from_elements(
                t.m11, t.m12, t.m13, t.m21, t.m22, t.m23, t.m31, t.m32, t.m33,
            ),
            u_tt: block(0, 0),
            u_tr: block(0, 3),
            u_rr: block(3, 3),
            hb: CrossBlock::new(),
        });
    }
    let configuration = LmConfig::well_conditioned();
    let start = Instant::now();
    let result = world.solve_sparse(&configuration);
    let seconds = start.elapsed().as_secs_f64();
    let iterations = result.ok().map(|result| result.iterations);
    let pose = |frame: &Frame| {
        let (t, q) = (frame.r2w.translation, frame.r2w.rotation);
        vec![t.x, t.y, t.z, q.v.x, q.v.y, q.v.z, q.t]
    };
    Outcome { seconds, poses: world.frames.iter().map(pose).collect(), iterations }
}
