//! Seeded graphs for tests and benches: two sessions along one route, with correct landmark edges between positions that
//! meet, and false ones.

use nalgebra::SVector;
use posecut_geometry::LieGroup;
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, Header, Node, NoiseModel, PoseGraph};
use posecut_random::{ChaCha8Rng, random};
use rand::RngExt as _;
use rand_distr::{Distribution, StandardNormal};

/// What false edges look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Falsehood {
    /// Each joins two places anywhere and claims that they are near each other.
    Uniform,
    /// Runs of 5 to 15 along both sessions that claim one common alignment: perceptual aliasing.
    Grouped,
    /// Correct edges moved by 0.5 to 3 m.
    NearMiss,
}

/// A random graph to generate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenario {
    /// The number of landmark edges.
    pub candidates: usize,
    /// The share of false edges among them.
    pub outliers: f64,
    /// What the false edges look like.
    pub falsehood: Falsehood,
    /// The seed; equal seeds give equal graphs on every machine.
    pub seed: u64,
}

/// Standard deviations of a step of odometry: metres, radians.
const STEP: (f64, f64) = (0.03, 0.003);
/// Standard deviations of a landmark edge: metres, radians.
const LANDMARK: (f64, f64) = (0.1, 0.02);

impl Scenario {
    /// The number of nodes in a session: one for every four candidates, between 200 and 5000, one metre apart.
    pub fn nodes(&self) -> usize {
        (self.candidates / 4).clamp(200, 5000)
    }

    /// Generates the graph. Both sessions follow one winding route; the noise matches the covariances. O(candidates).
    pub fn draw<G: LieGroup<DOF>, const DOF: usize>(&self) -> PoseGraph {
        let mut draw = Draw { random: random(self.seed, "pcm scenario") };
        let count = self.nodes();
        let dimension = if DOF == 3 { Dimension::Two } else { Dimension::Three };
        let mut header = Header::new(dimension);
        header.noise_models = vec![
            ("odometry".to_owned(), noise_model::<DOF>(STEP)),
            ("landmark".to_owned(), noise_model::<DOF>(LANDMARK)),
        ];
        let mut graph = PoseGraph::new(header);
        let route: Vec<G> = draw.route(count);
        let mut truth = route.clone();
        truth.extend(route.iter().map(|pose| pose.compose(&draw.around::<G, DOF>((0.5, 0.1)))));
        for id in 0..truth.len() {
            let session = if id < count { "a" } else { "b" };
            graph.nodes.push(Node { id: id as u64, session: Some(session.to_owned()), ..Node::default() });
            if id % count != 0 {
                let motion = truth[id - 1].between(&truth[id]).compose(&draw.around(STEP));
                push(&mut graph, EdgeKind::Odometry, (id - 1, id), &motion, None);
            }
        }
        let false_count = (self.candidates as f64 * self.outliers).round() as usize;
        let mut claims = Vec::with_capacity(self.candidates);
        while claims.len() < self.candidates - false_count {
            let (i, k) = draw.meeting(count);
            let measurement = truth[i].between(&truth[k]).compose(&draw.around(LANDMARK));
            claims.push((i, k, measurement, true));
        }
        while claims.len() < self.candidates {
            let left = self.candidates - claims.len();
            self.add_false(&mut draw, &truth, left, &mut claims);
        }
        claims.sort_by_key(|&(i, k, _, correct)| (i, k, correct));
        for (i, k, measurement, correct) in claims {
            push(&mut graph, EdgeKind::Landmark, (i, k), &measurement, Some(correct));
        }
        graph
    }

    fn add_false<G: LieGroup<DOF>, const DOF: usize>(
        &self,
        draw: &mut Draw,
        truth: &[G],
        left: usize,
        claims: &mut Vec<(usize, usize, G, bool)>,
    ) {
        let count = truth.len() / 2;
        match self.falsehood {
            Falsehood::Uniform => {
                let (i, k) = draw.apart(count);
                claims.push((i, k, draw.around((1.5, 0.3)), false));
            }
            Falsehood::NearMiss => {
                let (i, k) = draw.meeting(count);
                let mut moved: SVector<f64, DOF> = draw.normal((1.0, 0.0));
                moved *= draw.random.random_range(0.5..3.0) / moved.norm();
                let measurement =
                    truth[i].between(&truth[k]).compose(&G::exp(&moved)).compose(&draw.around(LANDMARK));
                claims.push((i, k, measurement, false));
            }
            Falsehood::Grouped => {
                let (i, k) = draw.apart(count);
                let alignment = truth[i].compose(&draw.around((1.5, 0.3))).compose(&truth[k].inverse());
                let length = draw.random.random_range(5..=15_usize).min(left);
                for step in 0..length {
                    let (i, k) = ((i + step).min(count - 1), (k + step).min(2 * count - 1));
                    let exact = truth[i].inverse().compose(&alignment).compose(&truth[k]);
                    claims.push((i, k, exact.compose(&draw.around(LANDMARK)), false));
                }
            }
        }
    }
}

struct Draw {
    random: ChaCha8Rng,
}

impl Draw {
    /// A tangent vector with the given standard deviations of translation and rotation.
    fn normal<const DOF: usize>(&mut self, sigma: (f64, f64)) -> SVector<f64, DOF> {
        SVector::from_fn(|axis, _| {
            let unit: f64 = StandardNormal.sample(&mut self.random);
            unit * if is_rotation::<DOF>(axis) { sigma.1 } else { sigma.0 }
        })
    }

    fn around<G: LieGroup<DOF>, const DOF: usize>(&mut self, sigma: (f64, f64)) -> G {
        G::exp(&self.normal(sigma))
    }

    /// One metre forward a step, heading by a random walk.
    fn route<G: LieGroup<DOF>, const DOF: usize>(&mut self, count: usize) -> Vec<G> {
        let mut poses = vec![G::identity()];
        let mut turn = 0.0;
        for _ in 1..count {
            let kick: f64 = StandardNormal.sample(&mut self.random);
            turn = 0.9 * turn + 0.05 * kick;
            let mut motion = SVector::<f64, DOF>::zeros();
            motion[0] = 1.0;
            motion[DOF - 1] = turn;
            if DOF == 6 {
                motion[3] = 0.3 * turn;
            }
            poses.push(poses[poses.len() - 1].compose(&G::exp(&motion)));
        }
        poses
    }

    /// Two positions that meet: at most two steps apart.
    fn meeting(&mut self, count: usize) -> (usize, usize) {
        let i = self.random.random_range(0..count);
        let k = self.random.random_range(i.saturating_sub(2)..(i + 3).min(count));
        (i, count + k)
    }

    /// Two positions more than 20 steps apart.
    fn apart(&mut self, count: usize) -> (usize, usize) {
        loop {
            let (i, k) = (self.random.random_range(0..count), self.random.random_range(0..count));
            if i.abs_diff(k) > 20 {
                return (i, count + k);
            }
        }
    }
}

fn is_rotation<const DOF: usize>(axis: usize) -> bool {
    axis >= if DOF == 3 { 2 } else { 3 }
}

/// The packed information of independent axes.
fn noise_model<const DOF: usize>(sigma: (f64, f64)) -> NoiseModel {
    let mut information = nalgebra::SMatrix::<f64, DOF, DOF>::zeros();
    for axis in 0..DOF {
        let sigma = if is_rotation::<DOF>(axis) { sigma.1 } else { sigma.0 };
        information[(axis, axis)] = 1.0 / (sigma * sigma);
    }
    NoiseModel {
        information: posecut_geometry::covariance::pack_upper_triangle(&information),
        extra: posecut_graph::Extra::new(),
    }
}

fn push<G: LieGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    kind: EdgeKind,
    (from, to): (usize, usize),
    measurement: &G,
    correct: Option<bool>,
) {
    let mut edge = Edge::new(kind, graph.edges.len() as u64, from as u64, to as u64);
    edge.measurement = Some(measurement.components());
    edge.noise = Some(kind.name().to_owned());
    edge.truth = correct.map(|correct| EdgeTruth { correct: Some(correct), ..EdgeTruth::default() });
    graph.edges.push(edge);
}
