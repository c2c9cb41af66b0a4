//! A pose graph that arrives record by record.

use std::collections::HashMap;
use std::time::Instant;

use anyhow::{Context as _, bail};
use posecut_graph::{Edge, Node, PoseGraph};
use posecut_optimize::pose_graph::{is_fixed, measured_edge};
use posecut_optimize::stage::{KernelOptions, refuse_unless_finite};
use serde::Serialize;

use super::lag::{BeyondLag, LagOptions, TimeWindow};
use crate::{EdgeId, IncrementalError, IncrementalGroup, IncrementalOptions, IncrementalSolver};

/// A record of a session.
#[derive(Clone, Debug)]
pub(super) enum Arrival {
    /// A pose.
    Node(Node),
    /// An edge; if it has a field `retract`, the edge named there is retracted first.
    Edge(Edge),
    /// An earlier edge is retracted.
    Retract(u64),
    /// An edge that was retracted, or arrived rejected, is used from now on.
    Readmit(u64),
}

/// An edge that has arrived.
#[derive(Clone, Copy, Debug)]
struct Standing {
    place: usize,
    /// The line on which it arrived.
    line: u64,
    /// Its number in the solver, if it is in use.
    used: Option<EdgeId>,
}

/// What happened in a step: a pose and the records up to the next one.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Step {
    /// Id of the newest node.
    pub(super) node: u64,
    /// Variables whose point of linearisation was moved.
    pub(super) relinearised: usize,
    /// Variables eliminated again.
    pub(super) eliminated: usize,
    /// Variables solved for.
    pub(super) solved: usize,
    /// Wall time of the step, seconds.
    pub(super) seconds: f64,
}

/// A component that was split off.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct SplitOff {
    /// Id of the newest node at that time.
    pub(super) at: u64,
    /// Id of the node that is held fixed from then on.
    pub(super) gauge: u64,
    /// Number of nodes.
    pub(super) nodes: usize,
}

/// The graph so far and the solver that follows it.
pub(super) struct Session<G, const DOF: usize> {
    pub(super) graph: PoseGraph,
    pub(super) solver: IncrementalSolver<G, DOF>,
    kernels: KernelOptions,
    lag: LagOptions,
    window: TimeWindow,
    /// Number in the solver, and line, of each pose.
    nodes: HashMap<u64, (usize, u64)>,
    edges: HashMap<u64, Standing>,
    /// The latest time of each session.
    times: HashMap<Option<String>, i64>,
    started: Option<Instant>,
    pub(super) steps: Vec<Step>,
    pub(super) splits: Vec<SplitOff>,
    pub(super) unmeasured: usize,
    pub(super) retracted: usize,
    pub(super) readmitted: usize,
    pub(super) restarts: usize,
    /// Edges rejected because one of their nodes was marginalised.
    pub(super) beyond_lag: usize,
    pub(super) most_live: usize,
}

/// The value of `rejected_by` of a retracted edge.
const RETRACT: &str = "retract";
/// The same of an edge that reaches a marginalised node.
const LAG: &str = "lag";

impl<G: IncrementalGroup<DOF>, const DOF: usize> Session<G, DOF> {
    /// A session without poses; `graph` has only a header.
    pub(super) fn new(
        graph: PoseGraph,
        options: IncrementalOptions,
        kernels: KernelOptions,
        lag: LagOptions,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            graph,
            solver: IncrementalSolver::new(options)?,
            kernels,
            lag,
            window: TimeWindow::new(lag.lag_time),
            nodes: HashMap::new(),
            edges: HashMap::new(),
            times: HashMap::new(),
            started: None,
            steps: Vec::new(),
            splits: Vec::new(),
            unmeasured: 0,
            retracted: 0,
            readmitted: 0,
            restarts: 0,
            beyond_lag: 0,
            most_live: 0,
        })
    }

    /// Applies the record of a line. Errors name the record, cause and remedy; the caller adds file and line.
    pub(super) fn take(&mut self, arrival: Arrival, line: u64) -> anyhow::Result<()> {
        self.started.get_or_insert_with(Instant::now);
        match arrival {
            Arrival::Node(node) => self.take_node(node, line),
            Arrival::Edge(edge) => self.take_edge(edge, line),
            Arrival::Retract(id) => self.retract(id).with_context(|| format!("retract {id}")),
            Arrival::Readmit(id) => self.readmit(id).with_context(|| format!("readmit {id}")),
        }
    }

    fn take_node(&mut self, node: Node, line: u64) -> anyhow::Result<()> {
        let name = format!("node {}", node.id);
        if let Some((_, earlier)) = self.nodes.get(&node.id) {
            bail!(
                "{name}, field \"id\": line {earlier} already has a node with this id; give every node an id of its own"
            );
        }
        if let Some(time) = node.utime {
            let last = self.times.entry(node.session.clone()).or_insert(time);
            if time < *last {
                bail!(
                    "{name}, field \"utime\": {time} lies before {last}, the time of an earlier pose of the same session; sort the poses of a session by time"
                );
            }
            *last = time;
        }
        self.window.add(&node)?;
        let pose = G::from_components(&node.pose_or_identity(self.graph.header.dimension))
            .with_context(|| format!("{name}: its pose cannot be used"))?;
        let place =
            if is_fixed(&node)? { self.solver.add_held_pose(pose) } else { self.solver.add_pose(pose) }
                .with_context(|| name)?;
        self.nodes.insert(node.id, (place, line));
        self.graph.nodes.push(node);
        Ok(())
    }

    fn take_edge(&mut self, edge: Edge, line: u64) -> anyhow::Result<()> {
        let name = edge.name();
        if let Some(Standing { line: earlier, .. }) = self.edges.get(&edge.id) {
            bail!(
                "{name}, field \"id\": line {earlier} already has an edge with this id; give every edge an id of its own"
            );
        }
        let end = |field: &str, id: u64| {
            self.nodes.get(&id).map(|&(place, _)| place).with_context(|| {
                format!("{name}, field \"{field}\": there is no node {id} so far; put the record of a node before those of its edges")
            })
        };
        let ends = (end("from", edge.from)?, end("to", edge.to)?);
        let replaces = match edge.extra.get(RETRACT) {
            None | Some(serde_json::Value::Null) => None,
            Some(value) => Some(value.as_u64().with_context(|| {
                format!("{name}, field \"retract\": expected the id of an earlier edge, found {value}; give a whole number")
            })?),
        };
        if let Some(id) = replaces {
            self.retract(id).with_context(|| format!("{name}, field \"retract\""))?;
        }
        let place = self.graph.edges.len();
        let (id, is_used) = (edge.id, edge.in_use());
        let measures = edge.measurement.is_some();
        self.graph.edges.push(edge);
        self.edges.insert(id, Standing { place, line, used: None });
        if is_used && measures {
            if self.refuse_past(place, ends)? {
                self.graph.edges[place].reject(LAG);
            } else {
                self.use_edge(id, place, ends)?;
            }
        } else if is_used && replaces.is_none() {
            self.unmeasured += 1;
        }
        Ok(())
    }

    /// Whether an edge reaches into the marginalised past and is to be rejected for that; an error if it is to be refused.
    fn refuse_past(&mut self, place: usize, ends: (usize, usize)) -> anyhow::Result<bool> {
        let Some(pose) = [ends.0, ends.1].into_iter().find(|&pose| self.solver.is_marginalised(pose)) else {
            return Ok(false);
        };
        if self.lag.beyond_lag == BeyondLag::Refuse {
            bail!(
                "{}: node {} was marginalised and takes no more edges; increase the lag, keep keyframes (--keep-landmark-poses, --keep-every), or reject such edges (--beyond-lag reject)",
                self.graph.edges[place].name(),
                self.graph.nodes[pose].id
            );
        }
        self.beyond_lag += 1;
        Ok(true)
    }

    fn use_edge(&mut self, id: u64, place: usize, ends: (usize, usize)) -> anyhow::Result<()> {
        let edge = &self.graph.edges[place];
        let Some(mut measured) = measured_edge::<G, DOF>(&self.graph, edge, ends.0, ends.1)? else {
            bail!("it has no measurement and cannot be used; give it one");
        };
        measured.kernel = self.kernels.of(measured.kind);
        let used = self.solver.add_edge(measured).with_context(|| edge.name())?;
        self.edges.entry(id).and_modify(|standing| standing.used = Some(used));
        Ok(())
    }

    fn retract(&mut self, id: u64) -> anyhow::Result<()> {
        let Some(Standing { place, used, .. }) = self.edges.get(&id).copied() else {
            bail!(
                "edge {id} is unknown and cannot be retracted; put an edge before the record that retracts it"
            );
        };
        let edge = &mut self.graph.edges[place];
        let Some(used) = used else {
            match edge.rejected_by.as_deref() {
                Some(RETRACT) => {
                    bail!("edge {id} was retracted before; retract it once, or readmit it first")
                }
                Some(stage) => {
                    bail!("edge {id} is rejected by {stage} and was never used; retract only edges in use")
                }
                None => bail!("edge {id} has no measurement and was never used; retract only edges in use"),
            }
        };
        if let Err(error) = self.solver.remove_edge(used) {
            if let IncrementalError::AbsorbedEdge { .. } = error {
                bail!(
                    "{} from node {} to node {} is part of the marginalised past and cannot be retracted; increase the lag, or retract edges before their nodes leave it",
                    edge.name(),
                    edge.from,
                    edge.to
                );
            }
            return Err(error.into());
        }
        edge.reject(RETRACT);
        self.edges.entry(id).and_modify(|standing| standing.used = None);
        self.retracted += 1;
        Ok(())
    }

    fn readmit(&mut self, id: u64) -> anyhow::Result<()> {
        let Some(Standing { place, used, .. }) = self.edges.get(&id).copied() else {
            bail!(
                "edge {id} is unknown and cannot be readmitted; put an edge before the record that readmits it"
            );
        };
        if used.is_some() {
            bail!(
                "edge {id} is in use and cannot be readmitted; readmit only edges that were retracted or arrived rejected"
            );
        }
        let edge = &self.graph.edges[place];
        let ends = (self.nodes[&edge.from].0, self.nodes[&edge.to].0);
        if self.refuse_past(place, ends)? {
            return Ok(());
        }
        self.use_edge(id, place, ends)?;
        self.graph.edges[place].readmit();
        self.readmitted += 1;
        Ok(())
    }

    /// Ends a step: brings the estimate up to date. Returns false if no record has arrived since the last step.
    pub(super) fn end_step(&mut self) -> bool {
        let (Some(started), Some(node)) = (self.started.take(), self.graph.nodes.last()) else {
            return false;
        };
        let report = self.solver.update();
        self.most_live = self.most_live.max(self.solver.live_poses().len() + report.marginalised);
        if let Some(end) = self.window.due() {
            self.solver.marginalise_before(end);
        }
        let at = node.id;
        for split in &report.splits {
            let gauge = self.graph.nodes[split.gauge].id;
            self.splits.push(SplitOff { at, gauge, nodes: split.nodes });
        }
        self.restarts += usize::from(report.restarted);
        self.steps.push(Step {
            node: at,
            relinearised: report.relinearised,
            eliminated: report.eliminated,
            solved: report.solved,
            seconds: started.elapsed().as_secs_f64(),
        });
        true
    }

    /// Refuses an estimate whose cost is not finite.
    pub(super) fn refuse_unless_finite(&self) -> anyhow::Result<()> {
        let cost = self.solver.cost();
        if cost.is_finite() {
            return Ok(());
        }
        let (ids, edges): (Vec<EdgeId>, Vec<_>) = self.solver.edges().into_iter().unzip();
        let name = |index: usize| {
            let standing = self.edges.values().find(|standing| standing.used == Some(ids[index]));
            standing.map(|standing| self.graph.edges[standing.place].name()).unwrap_or_default()
        };
        refuse_unless_finite(cost, &edges, name)
    }

    /// Writes the estimates to the nodes.
    pub(super) fn write_poses(&mut self) {
        for (node, pose) in self.graph.nodes.iter_mut().zip(self.solver.estimates()) {
            node.pose = Some(pose.components());
        }
    }
}
