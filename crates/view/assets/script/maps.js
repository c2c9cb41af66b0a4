// The maps: the main one, and those of other hypotheses. Each has poses, and its own marks and fields of all edges.

/** Coordinates of all nodes along the axes of space, and which nodes have any. */
function placesOf(positions) {
  const axis = (text) => (text ? series(text, data.step) : new Float64Array(nodeCount));
  return { axes: [positions.x, positions.y, positions.z].map(axis), placed: positions.placed ? bits(positions.placed) : () => true };
}

/** A field of all edges: numbers, or words from a list. */
class Column {
  constructor(raw) {
    Object.assign(this, { name: raw.name, numbers: raw.numbers, words: raw.words?.words, numeric: Boolean(raw.numbers) });
    if (!this.numeric) this.index = series(raw.words.index);
  }
  /** A number, a text, or null. */
  value(edge) {
    return (this.numeric ? this.numbers[edge] : this.words[this.index[edge] - 1]) ?? null;
  }
  text(edge) {
    const value = this.value(edge);
    return value === null ? "" : this.numeric ? (this.name === "verify_probability" ? value.toFixed(3) : brief(value)) : value;
  }
}

const label = once(() => (data.edges.label ? new Column(data.edges.label) : null));
const before = data.before && {
  places: once(() => placesOf(data.before.positions)),
  residuals: once(() => motions(data.before.residuals)),
};

class GraphMap {
  constructor(raw) {
    let rejected = 0;
    Object.assign(this, {
      name: raw.name, optimised: raw.optimised, parts: raw.parts, states: raw.states, state: Uint16Array.from(series(raw.state)),
      places: once(() => (raw.positions ? placesOf(raw.positions) : null)),
      residuals: once(() => motions(raw.residuals)),
      columns: raw.columns.map((column) => new Column(column)),
      part: once(() => (raw.parts.index ? series(raw.parts.index) : null)),
    });
    this.rank = raw.states.map((one) => (one.kind === "rejected" ? rejected++ : 0));
    this.hasPoses = Boolean(raw.positions);
    const first = once(() => {
      const counts = raw.witnesses ? series(raw.witnesses.count) : [];
      const firsts = [0];
      for (const count of counts) firsts.push(firsts.at(-1) + count);
      return firsts;
    });
    const ids = once(() => (raw.witnesses ? whole(raw.witnesses.id) : []));
    /** The ids of the edges that decided about an edge. */
    this.witnesses = (edge) => Array.from(ids().slice(first()[edge], first()[edge + 1]), String);
  }
  column(name) {
    return this.columns.find((column) => column.name === name);
  }
  stateOf(edge) {
    return this.states[this.state[edge]];
  }
  word(name, edge) {
    const column = this.column(name);
    return column && !column.numeric ? column.value(edge) : null;
  }
  style(index) {
    return stateStyle(this.states[index], this.rank[index]);
  }
}

const madeMaps = [];

/** The map of that number, read when it is first shown. */
function mapAt(index) {
  return (madeMaps[index] ??= new GraphMap(data.maps[index]));
}

function mapShown() {
  return mapAt(state.map);
}

/** Whether the poses shown are those before: by choice, or because the map has no others. */
function showsBefore() {
  return Boolean(before) && (!state.after || !mapShown().hasPoses);
}

/** The places shown, or the others; null without any. */
function placesShown(others = false) {
  const wantsBefore = showsBefore() !== others;
  return wantsBefore ? before && before.places() : mapShown().places();
}

/** The residuals of all edges at the poses shown; null without poses. */
function residualsShown() {
  return showsBefore() ? before.residuals() : mapShown().residuals();
}
