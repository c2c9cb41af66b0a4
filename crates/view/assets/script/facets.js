// The legend, which is the filter by state, and the other groups of filters.

/** Chooses a key of a group, or takes the choice back. */
function toggle(facet, key) {
  const chosen = state.filters[facet.name] ?? [];
  const next = chosen.includes(key) ? chosen.filter((one) => one !== key) : [...chosen, key];
  const filters = { ...state.filters, [facet.name]: next };
  if (!next.length) delete filters[facet.name];
  change({ filters });
}

/** Most keys of a group that are offered; a file may name a stage on every edge. */
const mostKeys = 14;

function facetButton(facet, key, index, sample) {
  const count = filter.counts[index].get(key) ?? 0, pressed = (state.filters[facet.name] ?? []).includes(key);
  const button = element("button", { type: "button", "aria-pressed": String(pressed), "data-facet": facet.name, "data-key": key, onclick: () => toggle(facet, key) },
    sample, element("span", {}, facet.name === "verify_hypothesis" ? hypothesisName(key) : key), element("b", {}, number(count)));
  button.classList.toggle("none", !count && !pressed);
  return button;
}

function hypothesisName(key) {
  return key === "0" ? "0: the map" : key;
}

function facetGroup(facet, index) {
  const states = facet.name === "state", map = mapShown();
  const keys = facet.keys.map((key, place) => [key, place]).filter(([, place]) => !states || map.states[place].kind !== "absent");
  const buttons = keys.slice(0, mostKeys).map(([key, place]) => facetButton(facet, key, index, states ? swatch(map.style(place)) : null));
  const more = keys.length > mostKeys ? element("span", {}, `and ${keys.length - mostKeys} more`) : null;
  return [states ? null : element("h3", {}, facet.title), element("div", { class: states ? "facet rows" : "facet", role: "group", "aria-label": facet.title }, ...buttons, more)];
}

function drawFacets() {
  const focused = document.activeElement?.dataset ?? {}, { facet, key } = focused;
  byId("facets").replaceChildren(...filter.facets.flatMap(facetGroup).filter(Boolean));
  // The buttons are new: the one that was pressed keeps the focus.
  if (facet) [...document.querySelectorAll("[data-facet]")].find((one) => one.dataset.facet === facet && one.dataset.key === key)?.focus();
}

function drawCounts() {
  const shown = filter.shown.length;
  byId("shown").textContent = !edgeCount ? "none in this graph" : shown === filter.all ? `${number(shown)}` : `${number(shown)} of ${number(filter.all)}`;
  byId("clear").hidden = !isFiltered();
}

when(["map", "filters", "probability", "pair", "part"], () => {
  drawFacets();
  drawCounts();
});

byId("clear").addEventListener("click", () => change({ filters: {}, probability: null, pair: "", part: -1 }));

/** Pairs of sessions that edges join, most edges first. */
function pairs() {
  const found = new Map();
  for (let edge = 0; edge < edgeCount; edge += 1) found.set(pairOf(edge), (found.get(pairOf(edge)) ?? 0) + 1);
  return [...found].sort((one, other) => other[1] - one[1]).slice(0, 200);
}

const nameOfSession = (session) => sessions[session] ?? "no session";

if (sessions.length > 1 && edgeCount) {
  const choices = pairs().map(([pair, count]) => {
    const [one, other] = pair.split(".").map(Number);
    return [pair, `${one === other ? `within ${nameOfSession(one)}` : `${nameOfSession(one)} \u2013 ${nameOfSession(other)}`} (${number(count)})`];
  });
  when(["pair"], () => offer(byId("pair"), [["", "all"], ...choices], state.pair));
} else {
  byId("pair-label").hidden = true;
}
byId("pair").addEventListener("change", (event) => change({ pair: event.target.value }));

when(["map", "filters", "probability", "pair", "part", "rejected"], () => {
  byId("rejected-label").hidden = !mapShown().states.some((one) => one.kind === "rejected");
  const usual = grouped.rejected > mostFaint ? "near pointer" : "faint";
  offer(byId("rejected"), [["automatic", `automatic: ${usual}`], ["faint", "faint, under the map"], ["near", "near pointer"], ["full", "in full"], ["none", "hidden"]], state.rejected);
});
byId("rejected").addEventListener("change", (event) => change({ rejected: event.target.value }));

/** The legend of the paths. */
function drawPaths() {
  const shown = sessions.length > 1 ? sessions.slice(0, 10) : [];
  const lines = shown.map((name, session) => element("span", {}, swatch({ colour: sessionColour(session), width: 3 }), name));
  if (sessions.length < 2 && nodeCount) lines.push(element("span", {}, swatch({ colour: colour("path"), width: 3 }), sessions[0] && sessions[0] !== "0" ? `odometry of ${sessions[0]}` : "odometry"));
  if (sessions.length > shown.length && shown.length) lines.push(element("span", {}, `and ${sessions.length - shown.length} more sessions`));
  if (data.broken.length) lines.push(element("span", {}, swatch({ colour: colour("broken"), width: 4, dash: [3, 5] }), counted(data.broken.length, "odometry edge") + " not to be trusted"));
  byId("paths").replaceChildren(...lines);
}
drawPaths();
