// What stages mean by the words that they write on edges.

/** Reasons of posecut-verify. */
const reasons = {
  supported: "other edges and the odometry predict what it measures",
  contradicted: "its measurement is far from what the map predicts",
  chance: "it agrees with the map no better than a random edge would; a second edge within a few metres of it would decide",
  vague: "the map is too uncertain there to show whether its measurement is somewhat wrong; a second edge within a few metres of it would decide",
  alone: "no other edge is near enough to support or contradict it; a second edge within a few metres of it would decide",
  "other-hypothesis": "it belongs to a group of edges that agree with each other and not with the map",
};

/** Roles of posecut-pcm. */
const roles = {
  clique: "it is in the largest set of edges that agree with each other in pairs",
  grown: "it was added to the largest set of edges that agree in pairs",
  chance: "it agrees with the others, but no better than chance",
  outside: "it is outside the largest set of edges that agree with each other in pairs",
};

/** Titles of known fields: of a column, and of a group of filters. */
const titles = {
  verify_reason: "reason", verify_probability: "probability", verify_hypothesis: "hypothesis", verify_verdict: "verdict",
  pcm_role: "PCM: role", pcm_degree: "PCM: degree", pcm_false_alarms: "PCM: false alarms", pcm_innovation: "innovation", cost: "cost of cutting",
};

function title(name) {
  return titles[name] ?? name;
}

function number(value) {
  return value.toLocaleString("en").replaceAll(",", "\u202f");
}

function counted(value, noun) {
  return `${number(value)} ${noun}${value === 1 ? "" : "s"}`;
}

/** A value with four significant digits. */
function brief(value) {
  if (Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}

function inMetres(value) {
  return Number.isNaN(value) ? "unknown" : value < 1e5 ? `${metres(value)} m` : `${brief(value)} m`;
}

function inDegrees(value) {
  return Number.isNaN(value) ? "" : `${value.toFixed(1)}°`;
}

/** Why an edge is in its state, in a sentence. */
function story(edge) {
  const map = mapShown(), of = map.stateOf(edge), own = of.name;
  const said = own.charAt(0).toUpperCase() + own.slice(1);
  const reason = map.word("verify_reason", edge), role = map.word("pcm_role", edge);
  const byVerify = reason && (of.kind !== "rejected" || own === "rejected by verify");
  if (byVerify) return `${said}. Reason: ${reason}${reasons[reason] ? ` \u2013 ${reasons[reason]}` : ""}.`;
  if (own === "rejected by pcm" && role) return `${said}. Role: ${role}${roles[role] ? ` \u2013 ${roles[role]}` : ""}.`;
  return `${said}.`;
}
