// What is shown. Whatever depends on a part of it says so, and is called again when that part changes.

const state = {
  map: 0, after: true, ghost: false, plane: data.plane, part: -1, rejected: "automatic", pair: "", probability: null, filters: {},
  selected: -1, hovered: -1, sort: null, descending: false, tab: "edges",
};
const watchers = [];

/** Calls `act` now and whenever one of these parts changes, in the order of these calls. */
function when(parts, act) {
  watchers.push([parts, act]);
  act();
}

function change(part) {
  const changed = Object.keys(part).filter((name) => state[name] !== part[name]);
  if (!changed.length) return;
  Object.assign(state, part);
  for (const [parts, act] of watchers) if (parts.some((name) => changed.includes(name))) act();
  if (changed.some((name) => name !== "hovered")) remember();
}

// The address keeps what is shown, so that a link leads to an edge.
const defaults = { map: 0, after: true, ghost: false, plane: data.plane, part: -1, rejected: "automatic", pair: "", sort: null, descending: false, tab: "edges" };
let restoring = false;

function remember() {
  if (restoring) return;
  const words = new URLSearchParams();
  if (state.selected >= 0) words.set("edge", String(edgeIds[state.selected]));
  for (const [name, usual] of Object.entries(defaults)) if (state[name] !== usual) words.set(name, String(state[name]));
  if (state.probability) words.set("probability", state.probability.join("-"));
  for (const [facet, chosen] of Object.entries(state.filters)) for (const key of chosen) words.append(`only.${facet}`, key);
  try {
    history.replaceState(null, "", `#${words}`);
  } catch {
    // A page inside another may have no address of its own.
  }
}

/** Takes what the address says; whatever this page does not have is left out. */
function restore() {
  const words = new URLSearchParams(location.hash.slice(1)), part = { ...defaults, selected: -1, probability: null, filters: {} };
  const whole = (name, count) => {
    const value = Number(words.get(name));
    if (words.has(name) && Number.isInteger(value) && value >= 0 && value < count) part[name] = value;
  };
  whole("map", data.maps.length);
  whole("plane", data.planes.length);
  whole("part", data.maps[part.map].parts.sizes.length);
  for (const name of ["after", "ghost", "descending"]) if (words.has(name)) part[name] = words.get(name) === "true";
  for (const name of ["rejected", "pair", "sort", "tab"]) if (words.has(name)) part[name] = words.get(name);
  const range = (words.get("probability") ?? "").split("-").map(Number);
  if (range.length === 2 && range.every((value) => value >= 0 && value <= 1)) part.probability = range;
  for (const [name, key] of words) {
    if (name.startsWith("only.")) part.filters[name.slice(5)] = [...(part.filters[name.slice(5)] ?? []), key];
  }
  part.selected = edgeOfId().get(words.get("edge")) ?? -1;
  restoring = true;
  change(part);
  restoring = false;
}
