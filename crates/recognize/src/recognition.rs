//! From keyframes to landmark edges: look up, judge, measure.

use std::collections::BTreeMap;

use posecut_graph::PoseGraph;
use posecut_scan::Scans;
use rayon::prelude::*;

use crate::appearance::{Appearance, Detector, Evidence};
use crate::hypotheses::{Measured, odds, rivals};
use crate::measure::{Extents, Measurement, Reference};
use crate::places::{Context, Places, Resemblance};
use crate::scan_context::ScanContext;
use crate::tf_idf::TfIdf;
use crate::{Routes, Settings, Submaps, Words, vocabulary};

/// Two keyframes that may see the same place.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The reference, the one with the lower index.
    pub from: usize,
    /// The query.
    pub to: usize,
    /// The probability that the query sees the place of the reference, from their words alone.
    pub appearance: f64,
    /// Where the query is in the frame of the reference; `None` without scans.
    pub measurement: Option<Measurement>,
    /// The sum of the odds of measurements that put one of the two elsewhere.
    pub rivals: f64,
}

impl Candidate {
    /// The probability that the candidate is correct: of its measurement, from the agreement beside that of its rivals, or of the place,
    /// from the words, where there is no measurement.
    pub fn probability(&self) -> f64 {
        match &self.measurement {
            Some(measurement) => {
                let odds = odds(measurement.agreement);
                odds / (1.0 + odds + self.rivals)
            }
            None => self.appearance,
        }
    }
}

/// What recognition found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recognition {
    /// The candidates in the order of their keyframes.
    pub candidates: Vec<Candidate>,
    /// Pairs of keyframes that looked alike, before the scans were matched.
    pub proposed: usize,
    /// Those for which no match of the scans was found.
    pub unmatched: usize,
    /// Those that were dropped because too little agrees.
    pub disagreeing: usize,
    /// Those that were dropped because their probability is too low.
    pub improbable: usize,
}

/// Keyframes that are looked up for each.
pub const SHORTLIST: usize = 50;

/// Places within this path length of each other, metres, are one place.
const ONE_PLACE: f64 = 3.0;

/// Extents of matched maps as shares of the submap length: the reference, the query when searched, and when aligned.
const EXTENTS: [f64; 3] = [1.0, 0.5, 1.0 / 6.0];

/// Finds candidates of a graph in the plane. Words are learnt from the scans unless others are given. With those, the graph may have no
/// scans: its candidates have no measurements then.
/// O(n^7/4 + candidates) with lengths of routes and scans as factors.
///
/// # Errors
///
/// An odometry edge has a measurement that cannot be used.
pub fn recognize(
    graph: &PoseGraph,
    scans: &Scans,
    words: Option<Words>,
    settings: &Settings,
) -> anyhow::Result<Recognition> {
    let routes = Routes::of_graph(graph)?;
    let submaps = submaps_of(graph, &routes, scans);
    let with_scans: Vec<usize> = (0..graph.nodes.len()).filter(|&node| submaps.has_scan(node)).collect();
    let places = Places::new(&submaps, with_scans, settings.submap_length, settings.radius);
    Ok(recognize_places(&routes, &submaps, &places, words, settings))
}

/// The same with the contexts of three-dimensional scans, by the position of the node, in place of the polar contexts of submaps.
/// Candidates are measured with the planar scans. Keyframes whose contexts have a larger distance than `settings.context.context_distance`
/// are not proposed.
///
/// # Errors
///
/// As for [`recognize`].
pub fn recognize_in_space(
    graph: &PoseGraph,
    scans: &Scans,
    contexts: Vec<Option<ScanContext>>,
    words: Option<Words>,
    settings: &Settings,
) -> anyhow::Result<Recognition> {
    let routes = Routes::of_graph(graph)?;
    let submaps = submaps_of(graph, &routes, scans);
    let described = contexts.into_iter().enumerate().filter_map(|(node, context)| Some((node, context?)));
    let (nodes, contexts) =
        described.filter(|(node, context)| submaps.has_scan(*node) && !context.is_empty()).unzip();
    let mut places = Places::of_contexts(nodes, contexts);
    places.least_similarity = 1.0 - settings.context.context_distance;
    Ok(recognize_places(&routes, &submaps, &places, words, settings))
}

fn submaps_of<'a>(graph: &PoseGraph, routes: &'a Routes, scans: &'a Scans) -> Submaps<'a> {
    Submaps::new(routes, graph.nodes.iter().map(|node| scans.at(node.id)).collect())
}

/// Looks up, judges and measures, whatever places are described by.
fn recognize_places<C: Context>(
    routes: &Routes,
    submaps: &Submaps,
    places: &Places<C>,
    words: Option<Words>,
    settings: &Settings,
) -> Recognition {
    let keyframes = routes.len();
    let foreign = words.is_some();
    let words = words.unwrap_or_else(|| words_of_scans(submaps, keyframes, settings));
    let detector = Detector { seen: settings.seen, imagined: settings.imagined };
    let lookup = Lookup {
        routes,
        settings,
        appearance: Appearance::new(&words, detector),
        by_words: foreign.then(|| TfIdf::new(&words)),
        places,
    };
    let proposals = lookup.proposals(keyframes);
    let mut found = Recognition { proposed: proposals.len(), ..Recognition::default() };
    if submaps.is_empty() {
        found.candidates = proposals.into_iter().map(Proposal::without_measurement).collect();
    } else {
        let measured = measure_all(submaps, &proposals, settings);
        keep(routes, proposals, measured, settings, &mut found);
    }
    let before = found.candidates.len();
    found.candidates.retain(|candidate| candidate.probability() >= settings.least_score);
    found.improbable = before - found.candidates.len();
    found
}

/// The words by which the scans of keyframes are compared. O(shapes * vocabulary).
pub fn words_of_scans(submaps: &Submaps, keyframes: usize, settings: &Settings) -> Words {
    let extent = EXTENTS[1] * settings.submap_length;
    vocabulary::words(submaps, keyframes, extent, settings.vocabulary, settings.seed)
}

/// A pair to be measured.
struct Proposal {
    from: usize,
    to: usize,
    appearance: f64,
    headings: Vec<f64>,
}

impl Proposal {
    fn without_measurement(self) -> Candidate {
        Candidate {
            from: self.from,
            to: self.to,
            appearance: self.appearance,
            measurement: None,
            rivals: 0.0,
        }
    }
}

/// What is needed to find pairs.
struct Lookup<'a, C> {
    routes: &'a Routes,
    settings: &'a Settings,
    appearance: Appearance<'a>,
    /// The index of words that came from elsewhere.
    by_words: Option<TfIdf<'a>>,
    places: &'a Places<C>,
}

impl<C: Context> Lookup<'_, C> {
    /// The pairs in the order of their keyframes, each once.
    fn proposals(&self, keyframes: usize) -> Vec<Proposal> {
        let all: Vec<Vec<Proposal>> =
            (0..keyframes).into_par_iter().map(|keyframe| self.proposals_of(keyframe)).collect();
        let mut pairs: BTreeMap<(usize, usize), Proposal> = BTreeMap::new();
        for proposal in all.into_iter().flatten() {
            let pair = pairs.entry((proposal.from, proposal.to));
            // Both may have proposed the other: the surer one counts.
            pair.and_modify(|known| known.appearance = known.appearance.max(proposal.appearance))
                .or_insert(proposal);
        }
        pairs.into_values().collect()
    }

    fn proposals_of(&self, keyframe: usize) -> Vec<Proposal> {
        let (shortlist, resemblances) = self.shortlist(keyframe);
        if shortlist.is_empty() {
            return Vec::new();
        }
        let elsewhere =
            |other: usize| self.routes.path_length(keyframe, other) > self.settings.exclusion_length;
        let evidence = self.appearance.evidence(keyframe, elsewhere);
        let mut order: Vec<usize> = (0..shortlist.len()).collect();
        // By words, the order of the shortlist stands.
        if let Some(resemblances) = &resemblances {
            let similarity = |at: usize| resemblances[at].similarity;
            order.sort_by(|&one, &other| similarity(other).total_cmp(&similarity(one)).then(one.cmp(&other)));
        }
        let mut kept: Vec<usize> = Vec::new();
        for at in order {
            let apart = |&other: &usize| self.routes.path_length(shortlist[other], shortlist[at]) > ONE_PLACE;
            if kept.len() < self.settings.candidates && kept.iter().all(apart) {
                kept.push(at);
            }
        }
        let others = self.places_elsewhere(keyframe);
        let proposal = |at: usize| {
            let other = shortlist[at];
            let appearance = self.appearance_of(other, &shortlist, &evidence, others);
            let headings = resemblances.as_ref().map_or_else(Vec::new, |found| found[at].headings.clone());
            // The edge leads from the lower keyframe: from the other end, the heading has the other sign.
            if other < keyframe {
                Proposal { from: other, to: keyframe, appearance, headings }
            } else {
                let headings = headings.into_iter().map(|heading| -heading).collect();
                Proposal { from: keyframe, to: other, appearance, headings }
            }
        };
        kept.into_iter().map(proposal).collect()
    }

    /// The keyframes that look like one, and how, where both have scans.
    fn shortlist(&self, keyframe: usize) -> (Vec<usize>, Option<Vec<Resemblance>>) {
        let apart = self.settings.exclusion_length;
        let position = self.places.position(keyframe);
        if let Some(index) = &self.by_words {
            let elsewhere = |other: usize| self.routes.path_length(keyframe, other) > apart;
            let nearest = index.nearest(keyframe, SHORTLIST, elsewhere);
            let looks = |other: usize| Some(self.places.resemblance(position?, self.places.position(other)?));
            let resemblances: Vec<Resemblance> = nearest.iter().filter_map(|&other| looks(other)).collect();
            let all = resemblances.len() == nearest.len();
            return (nearest, all.then_some(resemblances));
        }
        let Some(position) = position else { return (Vec::new(), None) };
        let nearest = self.places.nearest(position, SHORTLIST, self.routes, apart);
        let resemblances: Vec<Resemblance> =
            nearest.into_iter().map(|other| self.places.resemblance(position, other)).collect();
        let resemblances: Vec<Resemblance> = resemblances
            .into_iter()
            .filter(|found| found.similarity >= self.places.least_similarity)
            .collect();
        (resemblances.iter().map(|found| found.node).collect(), Some(resemblances))
    }

    /// The number of keyframes that are hypotheses for one.
    fn places_elsewhere(&self, keyframe: usize) -> f64 {
        let beside = self.routes.within(keyframe, self.settings.exclusion_length).len();
        (self.routes.len() - beside).max(1) as f64
    }

    /// The posterior probability of a place. The hypotheses are a new place, and each keyframe elsewhere with equal prior
    /// probability; those outside the shortlist count as average places. Neighbouring keyframes see one place: their probabilities
    /// add up.
    fn appearance_of(&self, place: usize, shortlist: &[usize], evidence: &Evidence, others: f64) -> f64 {
        let known = (1.0 - self.settings.new_place) / others;
        let rest = (others - shortlist.len() as f64).max(0.0);
        let mut total = self.settings.new_place + rest * known;
        let mut here = 0.0;
        for &other in shortlist {
            // Above 600 nats the exponential would overflow; the probability is 1 long before.
            let weight = known * evidence.ratio(other).min(600.0).exp();
            total += weight;
            if self.routes.path_length(place, other) <= ONE_PLACE {
                here += weight;
            }
        }
        if total > 0.0 { here / total } else { 0.0 }
    }
}

/// Matches the scans of all pairs, by reference, so that each local map is prepared once.
fn measure_all(submaps: &Submaps, proposals: &[Proposal], settings: &Settings) -> Vec<Option<Measurement>> {
    let [reference, searched, aligned] = EXTENTS.map(|share| share * settings.submap_length);
    let extents = Extents { reference, searched, aligned };
    let groups: Vec<&[Proposal]> = proposals.chunk_by(|one, other| one.from == other.from).collect();
    let measured: Vec<Vec<Option<Measurement>>> = groups
        .par_iter()
        .map(|group| {
            let Some(first) = group.first() else { return Vec::new() };
            let prepared = Reference::new(submaps, first.from, &extents);
            let measure =
                |proposal: &Proposal| prepared.measure(submaps, proposal.to, &proposal.headings, &extents);
            group.iter().map(measure).collect()
        })
        .collect();
    measured.into_iter().flatten().collect()
}

/// Keeps what agrees enough. What does not is a rival all the same, so that no probability depends on the threshold.
fn keep(
    routes: &Routes,
    proposals: Vec<Proposal>,
    measurements: Vec<Option<Measurement>>,
    settings: &Settings,
    found: &mut Recognition,
) {
    let measured: Vec<Measured<'_>> = proposals
        .iter()
        .zip(&measurements)
        .filter_map(|(&Proposal { from, to, .. }, measurement)| {
            measurement.as_ref().map(|measurement| Measured { from, to, measurement })
        })
        .collect();
    let mut rivals = rivals(routes, &measured).into_iter();
    for (proposal, measurement) in proposals.into_iter().zip(measurements) {
        let Some(measurement) = measurement else {
            found.unmatched += 1;
            continue;
        };
        let rivals = rivals.next().unwrap_or(0.0);
        if measurement.agreement < settings.least_agreement {
            found.disagreeing += 1;
        } else {
            let candidate = proposal.without_measurement();
            found.candidates.push(Candidate { measurement: Some(measurement), rivals, ..candidate });
        }
    }
}
