// Which edges are shown: filters act on the map and on the table alike.

/** A group of filters: the key of each edge, and the keys in their order with names. Of none chosen, all are shown. */
class Facet {
  constructor(name, title, keys, keyOf) {
    Object.assign(this, { name, title, keys, keyOf });
  }
}

/** A field of words is a group of filters if it has at most this many. */
const mostWords = 8;

/** The groups of filters of the present map. */
function facetsOf(map) {
  const words = (column, heading) => new Facet(column.name, heading ?? title(column.name), column.words, (edge) => column.value(edge) ?? "");
  const found = [new Facet("state", "State", map.states.map((one) => one.name), (edge) => map.stateOf(edge).name)];
  const order = ["verify_reason", "pcm_role"];
  const fields = map.columns.filter((column) => !column.numeric && column.name !== "verify_verdict" && column.words.length > 1 && column.words.length <= mostWords);
  fields.sort((one, other) => order.includes(other.name) - order.includes(one.name));
  found.push(...fields.map((column) => words(column)));
  if (label()) found.push(words(label(), "Label"));
  const hypothesis = map.column("verify_hypothesis");
  if (hypothesis?.numeric && hypothesis.numbers.some((value) => value > 0)) {
    const keys = [...new Set(hypothesis.numbers.filter((value) => value !== null))].sort((one, other) => one - other);
    found.push(new Facet("verify_hypothesis", "Hypothesis", keys.slice(0, 12).map(String), (edge) => String(hypothesis.value(edge) ?? "")));
  }
  return found;
}

/** The pair of sessions that an edge joins, in the order of sessions. */
function pairOf(edge) {
  const [one, other] = [sessionOf()[ends.from[edge]], sessionOf()[ends.to[edge]]];
  return one <= other ? `${one}.${other}` : `${other}.${one}`;
}

const filter = { facets: [], shown: new Int32Array(0), passes: new Uint8Array(edgeCount), counts: new Map(), all: 0 };

/** The tests of an edge beside the groups: probability, sessions, component. */
function furtherTests(map) {
  const tests = [], probability = map.column("verify_probability");
  if (state.probability && probability?.numeric) {
    const [low, high] = state.probability;
    tests.push((edge) => probability.numbers[edge] !== null && probability.numbers[edge] >= low && probability.numbers[edge] <= high);
  }
  if (state.pair) tests.push((edge) => pairOf(edge) === state.pair);
  if (state.part >= 0 && map.part()) tests.push((edge) => map.part()[ends.from[edge]] === state.part || map.part()[ends.to[edge]] === state.part);
  return tests;
}

when(["map", "filters", "probability", "pair", "part"], () => {
  const map = mapShown(), facets = facetsOf(map), tests = furtherTests(map);
  const chosen = facets.map((facet) => {
    const keys = (state.filters[facet.name] ?? []).filter((key) => facet.keys.includes(key));
    return keys.length ? new Set(keys) : null;
  });
  const counts = facets.map(() => new Map()), shown = [];
  filter.passes.fill(0);
  filter.all = 0;
  for (let edge = 0; edge < edgeCount; edge += 1) {
    if (map.stateOf(edge).kind === "absent") continue;
    filter.all += 1;
    let fails = 0, failed = -1;
    const keys = facets.map((facet) => facet.keyOf(edge));
    for (let index = 0; index < facets.length; index += 1) {
      if (chosen[index] && !chosen[index].has(keys[index])) [fails, failed] = [fails + 1, index];
    }
    if (fails < 2 && !tests.every((test) => test(edge))) continue;
    if (fails === 0) {
      shown.push(edge);
      filter.passes[edge] = 1;
    }
    // A count says how many edges a choice of this key would show: all other filters hold.
    for (let index = 0; index < facets.length; index += 1) {
      if (fails === 0 || (fails === 1 && failed === index)) counts[index].set(keys[index], (counts[index].get(keys[index]) ?? 0) + 1);
    }
  }
  Object.assign(filter, { facets, shown: Int32Array.from(shown), counts });
});

/** Whether any filter is chosen. */
function isFiltered() {
  return Object.values(state.filters).some((keys) => keys.length) || Boolean(state.probability) || state.pair !== "" || state.part >= 0;
}
