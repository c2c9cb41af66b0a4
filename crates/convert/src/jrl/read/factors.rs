//! Factors of a dataset: edges and priors, and which of them may be or are outliers.

use std::collections::{HashMap, HashSet};

use posecut_graph::{Dimension, Edge, EdgeKind};

use super::{Reader, pose, symbol};
use crate::ConvertError;
use crate::jrl::covariance::information;
use crate::jrl::document::{ByRobot, Entry, Factor, Factors, Nullable};
use crate::jrl::stamps::Stamps;

/// Robot, index of the entry, index in the entry.
type FactorId = (String, usize, usize);

/// What the dataset says about an edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Flags {
    /// It may be an outlier.
    pub(super) potential: bool,
    /// Whether it is one, if the dataset names it.
    pub(super) status: Option<bool>,
}

/// A prior on a pose.
pub(super) struct Prior {
    pub(super) place: String,
    pub(super) key: u64,
    pub(super) pose: Vec<f64>,
    /// Row by row; empty if the factor has none.
    pub(super) covariance: Vec<f64>,
}

/// The measurements of all robots.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) edges: Vec<Edge>,
    pub(super) flags: Vec<Flags>,
    pub(super) priors: Vec<Prior>,
    pub(super) stamps: Stamps,
    /// Whether the dataset lists its outliers, so that all other landmark edges are correct.
    pub(super) labelled: bool,
    /// The edges between two keys, each with the robot that has it, so that an edge in the lists of two robots is read once.
    by_ends: HashMap<(u64, u64), Vec<(usize, String)>>,
}

impl Reader<'_> {
    pub(super) fn factors(
        &mut self,
        measurements: Option<ByRobot<Nullable<Vec<Entry>>>>,
        potential: Option<Factors>,
        outliers: Option<Factors>,
    ) -> Result<Measured, ConvertError> {
        let robots: Vec<(String, Vec<Entry>)> = measurements
            .map_or_else(Vec::new, |robots| robots.0)
            .into_iter()
            .map(|(name, entries)| (name, entries.into_inner()))
            .collect();
        let mut measured = Measured { labelled: outliers.is_some(), ..Measured::default() };
        let mut lists = [HashSet::new(), HashSet::new()];
        for (list, (field, factors)) in
            lists.iter_mut().zip([("potential_outlier_factors", potential), ("outlier_factors", outliers)])
        {
            *list = self.factor_ids(field, factors, &robots)?;
        }
        for (name, entries) in robots {
            for (index, entry) in entries.into_iter().enumerate() {
                self.entry(&name, index, entry, &lists, &mut measured)?;
            }
        }
        Ok(measured)
    }

    /// The factors of a list, which must exist.
    fn factor_ids(
        &self,
        field: &str,
        factors: Option<Factors>,
        robots: &[(String, Vec<Entry>)],
    ) -> Result<HashSet<FactorId>, ConvertError> {
        let by_robot = match factors {
            None => Vec::new(),
            Some(Factors::ByRobot(lists)) => lists,
            Some(Factors::List(list)) if list.is_empty() => Vec::new(),
            Some(Factors::List(list)) => match robots {
                [(only, _)] => vec![(only.clone(), Nullable::of(list))],
                _ => {
                    return Err(self.refuse(
                        field,
                        &format!("the list names no robot, but the dataset has {}", robots.len()),
                        "give a list for each robot: {\"a\":[[0, 2], …], …}",
                    ));
                }
            },
        };
        let mut ids = HashSet::new();
        for (name, list) in by_robot {
            let entries =
                robots.iter().find(|(robot, _)| *robot == name).map_or(&[][..], |(_, entries)| entries);
            for (entry, index) in list.into_inner() {
                let exists = entries.get(entry).is_some_and(|entry| index < entry.measurements.len());
                if !exists {
                    return Err(self.refuse(
                        &format!("{field}.{name}"),
                        &format!("there is no factor [{entry}, {index}]"),
                        "a factor is the index of its entry and its index in that entry's measurements, from 0",
                    ));
                }
                ids.insert((name.clone(), entry, index));
            }
        }
        Ok(ids)
    }

    fn entry(
        &mut self,
        name: &str,
        at: usize,
        entry: Entry,
        [potential, outliers]: &[HashSet<FactorId>; 2],
        measured: &mut Measured,
    ) -> Result<(), ConvertError> {
        measured.stamps.begin(name, entry.stamp);
        let statuses: HashMap<usize, bool> = entry.potential_outlier_statuses.0.into_iter().collect();
        for (index, factor) in entry.measurements.into_inner().into_iter().enumerate() {
            let place = format!("measurements.{name}[{at}].measurements[{index}]");
            let keys = [factor.key, factor.key1, factor.key2];
            measured.stamps.name(name, keys.into_iter().flatten());
            let id = (name.to_owned(), at, index);
            let status = statuses.get(&index).copied().or_else(|| outliers.contains(&id).then_some(true));
            let flags = Flags { potential: status.is_some() || potential.contains(&id), status };
            self.factor(name, &place, &factor, flags, measured)?;
        }
        Ok(())
    }

    fn factor(
        &mut self,
        name: &str,
        place: &str,
        factor: &Factor,
        flags: Flags,
        measured: &mut Measured,
    ) -> Result<(), ConvertError> {
        match factor.kind.as_str() {
            "BetweenFactorPose2" => self.between(name, place, factor, flags, Dimension::Two, measured),
            "BetweenFactorPose3" => self.between(name, place, factor, flags, Dimension::Three, measured),
            "PriorFactorPose2" => self.prior(place, factor, Dimension::Two, measured),
            "PriorFactorPose3" => self.prior(place, factor, Dimension::Three, measured),
            other => self.skip(
                other,
                place,
                "factors of pose graphs are BetweenFactorPose2 and BetweenFactorPose3",
            ),
        }
    }

    fn prior(
        &mut self,
        place: &str,
        factor: &Factor,
        dimension: Dimension,
        measured: &mut Measured,
    ) -> Result<(), ConvertError> {
        let (Some(key), Some(value)) = (factor.key, &factor.prior) else {
            return Err(self.refuse(
                place,
                "the prior has no key or no prior",
                "a prior has key, prior and covariance",
            ));
        };
        self.agree(dimension, place)?;
        let pose =
            pose(value, dimension).map_err(|(problem, remedy)| self.refuse(place, &problem, remedy))?;
        let covariance = factor.covariance.clone().unwrap_or_default();
        measured.priors.push(Prior { place: place.to_owned(), key, pose, covariance });
        Ok(())
    }

    fn between(
        &mut self,
        name: &str,
        place: &str,
        factor: &Factor,
        flags: Flags,
        dimension: Dimension,
        measured: &mut Measured,
    ) -> Result<(), ConvertError> {
        let (Some(from), Some(to), Some(value), Some(covariance)) =
            (factor.key1, factor.key2, &factor.measurement, &factor.covariance)
        else {
            return Err(self.refuse(
                place,
                "the factor lacks a field",
                "a BetweenFactor has key1, key2, measurement and covariance",
            ));
        };
        if from == to {
            let problem = format!("the factor joins {} to itself", symbol(from));
            return Err(self.refuse(place, &problem, "delete the factor"));
        }
        self.agree(dimension, place)?;
        let measurement =
            pose(value, dimension).map_err(|(problem, remedy)| self.refuse(place, &problem, remedy))?;
        let information = information(dimension, covariance)
            .map_err(|problem| self.refuse(place, &problem, "correct the covariance at its source"))?;
        // A robot's own repetition is another edge; that of another robot is the same one.
        let known = measured.by_ends.entry((from, to)).or_default();
        let repeated = known.iter().find(|(index, owner)| {
            let edge = &measured.edges[*index];
            owner != name
                && edge.measurement.as_deref() == Some(&measurement)
                && edge.information.as_deref() == Some(&information)
        });
        if let Some((index, _)) = repeated {
            let merged = &mut measured.flags[*index];
            merged.potential |= flags.potential;
            merged.status = merged.status.or(flags.status);
            return Ok(());
        }
        known.push((measured.edges.len(), name.to_owned()));
        // The kind is set when all keys are known.
        let mut edge = Edge::new(EdgeKind::Landmark, measured.edges.len() as u64, from, to);
        edge.measurement = Some(measurement);
        edge.information = Some(information);
        measured.edges.push(edge);
        measured.flags.push(flags);
        Ok(())
    }
}
