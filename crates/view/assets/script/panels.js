// The other tables: what was found, the calibration, the history.

function tableOf(heads, rows, left = false) {
  return element("div", { class: "wide" }, element("table", { class: left ? "left" : null },
    element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", { scope: "col" }, head)))),
    element("tbody", {}, ...rows.map(([first, ...rest]) => element("tr", {}, element("th", { scope: "row" }, first), ...rest.map((cell) => element("td", {}, cell)))))));
}

function finding(severity, kind, heading, text, remedy) {
  return element("div", { class: `finding ${severity}` }, element("h3", {}, element("em", {}, `${kind}: `), heading),
    text ? element("p", {}, text) : null, remedy ? element("p", { class: "soft" }, `Remedy: ${remedy}`) : null);
}

const severities = { error: 0, warning: 1, note: 2 };

function findings() {
  const own = data.doubts.map((one) => finding("warning", `doubt of ${one.stage}`, one.doubt, one.meaning, one.remedy));
  const remarks = [...data.remarks].sort((one, other) => severities[one.severity] - severities[other.severity]);
  own.push(...remarks.map((one) => finding(one.severity, one.severity, one.title, one.text, one.remedy)));
  if (!own.length) own.push(element("p", {}, "The stages in the history of this graph raised no doubts."));
  return own;
}

const factor = (value) => (value === null ? "" : `× ${brief(value)}`);

function calibration() {
  const found = data.verification, parts = [];
  if (!found) return [element("p", {}, "To see the calibration here, run posecut-verify with --stats FILE, and posecut-view with --verify-stats FILE.")];
  if (found.calibration) {
    const { chains, landmark, share, evidence, on_prior: onPrior } = found.calibration;
    parts.push(element("h3", {}, "Factors on covariances"), element("p", { class: "soft" }, "By how much posecut-verify takes the claimed covariances to be wrong: above 1 they are too small, below 1 too large. A coherent error grows in proportion to the distance travelled, like that of a wrong wheel size."));
    if (onPrior) parts.push(finding("warning", "doubt", "calibration-on-prior", "The edges have too little information for an estimate: covariances are used as claimed.", ""));
    const shown = chains.slice(0, 300).map((chain) => [chain.name, factor(chain.odometry), chain.coherent === null ? "" : `${brief(100 * chain.coherent)} %`]);
    parts.push(tableOf(["session or chain", "odometry", "coherent error"], [...shown, ["landmark edges", factor(landmark), ""]]));
    if (chains.length > shown.length) parts.push(element("p", { class: "soft" }, `and ${chains.length - shown.length} more chains`));
    const facts = [];
    if (share !== null) facts.push(["estimated share of candidates that measure what is there", `${brief(100 * share)} %`]);
    if (evidence !== null) facts.push(["evidence of loops, above that of shuffled ones", `${brief(evidence)} nats`]);
    if (facts.length) parts.push(tableOf(["", ""], facts));
  }
  if (found.rivals.length) {
    parts.push(element("h3", {}, "Rival hypotheses"), element("p", { class: "soft" }, "Other ways to join two sessions, with at least half the evidence of the edges in use there. posecut-verify --hypothesis N applies one."));
    parts.push(tableOf(["hypothesis", "edges", "its evidence, nats", "of the edges in use, nats"], found.rivals.map((rival) => [rival.hypothesis, rival.edges, rival.evidence, rival.accepted].map((value) => (value === null ? "" : brief(value))))));
  }
  if (found.counts.length) parts.push(element("h3", {}, "Counts"), tableOf(["", ""], found.counts.map(([name, value]) => [name, number(value)])));
  return parts;
}

function historyOf() {
  const rows = data.stages.map((stage) => [`${stage.name} ${stage.version}`, stage.arguments, stage.doubts]);
  const inputs = data.stages.flatMap((stage) => stage.inputs.map(([name, digest]) => [`${stage.name}: ${name}`, element("code", {}, digest)]));
  const parts = [rows.length ? tableOf(["stage", "arguments", "doubts"], rows, true) : element("p", {}, "The graph does not say which stages made it.")];
  if (inputs.length) parts.push(element("h3", {}, "Files that they read, SHA-256"), tableOf(["stage and role", "digest"], inputs, true));
  const rounded = `Drawn positions are rounded to ${brief(data.step)} m.`;
  const hidden = data.edges.hidden ? ` ${counted(data.edges.hidden, "field")} of landmark edges, such as lists, not shown.` : "";
  parts.push(element("p", { class: "soft" }, `Made by posecut-view ${data.version} from the graph alone: the same graph gives the same page. ${rounded}${hidden}`));
  return parts;
}

const tabs = {
  edges: () => `Edges ${filter.shown.length === filter.all ? number(filter.all) : `${number(filter.shown.length)} of ${number(filter.all)}`}`,
  findings: () => `Findings ${number(data.doubts.length + data.remarks.length)}`,
  calibration: () => "Calibration",
  history: () => "History",
};
const panels = { findings, calibration, history: historyOf };

when(["tab", "map", "filters", "probability", "pair", "part"], () => {
  if (!(state.tab in tabs)) state.tab = "edges";
  const focused = document.activeElement?.dataset?.tab;
  const buttons = Object.entries(tabs).map(([name, text]) => element("button", {
    type: "button", role: "tab", id: `tab-${name}`, "data-tab": name, "aria-selected": String(name === state.tab), "aria-controls": "body",
    tabindex: name === state.tab ? 0 : -1, onclick: () => change({ tab: name }) }, text()));
  byId("tabs").replaceChildren(...buttons);
  byId("body").setAttribute("aria-labelledby", `tab-${state.tab}`);
  if (focused) byId(`tab-${state.tab}`).focus();
});

when(["tab"], () => {
  if (state.tab === "edges") return;
  byId("body").replaceChildren(element("div", { class: "text" }, ...panels[state.tab]()));
  byId("body").scrollTop = 0;
});

byId("tabs").addEventListener("keydown", (event) => {
  const names = Object.keys(tabs), step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (step) change({ tab: names[(names.indexOf(state.tab) + step + names.length) % names.length] });
});
