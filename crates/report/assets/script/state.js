// What is shown: experiment, session, seed. Every figure redraws when it changes.

const figures = [];
const state = { experiment: 0, session: null, seed: null };

function experiment() {
  return page.experiments[state.experiment];
}

function session() {
  return experiment()?.sessions.find((one) => one.name === state.session);
}

function seed() {
  return session()?.seeds.find((one) => one.name === state.seed);
}

/** Adds a figure: `draw` is called now and whenever something changes. */
function figure(draw) {
  figures.push(draw);
}

/** Keeps the choice among what there is, and fills the selects. */
function settle() {
  const sessions = experiment()?.sessions ?? [];
  if (!sessions.some((one) => one.name === state.session)) state.session = sessions[0]?.name ?? null;
  const seeds = session()?.seeds ?? [];
  if (!seeds.some((one) => one.name === state.seed)) state.seed = seeds[0]?.name ?? null;
  offer(byId("experiment"), page.experiments.map((one, index) => [index, one.name]), state.experiment);
  offer(byId("session"), sessions.map((one) => [one.name, one.name]), state.session);
  offer(byId("seed"), seeds.map((one) => [one.name, one.name]), state.seed);
}

function redraw() {
  const parts = [experiment()?.name, state.session, state.seed === null ? null : `seed ${state.seed}`];
  for (const place of document.querySelectorAll(".chosen")) place.textContent = parts.filter(Boolean).join(" \u00b7 ");
  for (const draw of figures) draw();
}

function choose(part) {
  Object.assign(state, part);
  settle();
  redraw();
}

/** The landmark edges of a method by truth and fate. */
function edgesOf(seed, method) {
  const { edges } = seed;
  return edges.id.map((id, index) => ({
    id, index, from: edges.from[index], to: edges.to[index], frames: edges.frames[index],
    truth: edges.truth[index], kept: method.state[index] === "+",
    stage: method.state[index] === "-" ? "a stage that dropped it" : method.stages[method.state.charCodeAt(index) - 97],
  }));
}

/** A landmark edge in a sentence. */
function told(edge) {
  const truth = { t: "correct", f: "incorrect", "?": "of unknown truth" }[edge.truth];
  const fate = edge.kept ? "kept" : `rejected by ${edge.stage}`;
  return `Landmark edge ${edge.id}, frames ${edge.frames[0]} and ${edge.frames[1]}: ${truth}, ${fate}.`;
}
