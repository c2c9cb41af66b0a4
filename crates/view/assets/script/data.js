// The data of the page: nodes, landmark edges, and what all maps share.

const data = JSON.parse(byId("data").textContent);
const nodeCount = data.nodes.count, edgeCount = data.edges.count;

/** Calls a function once, when its result is first needed. */
function once(make) {
  let made, done = false;
  return () => {
    if (!done) [made, done] = [make(), true];
    return made;
  };
}

/** Whole numbers; those beyond 2^53 need big integers. */
function whole(part) {
  if (!part.wide) return series(part.series);
  const values = [], bytes = bytesOf(part.series);
  const clip = part.wide === "signed" ? BigInt.asIntN : BigInt.asUintN;
  let last = 0n, rest = 0n, shift = 0n;
  for (const byte of bytes) {
    rest += BigInt(byte & 0x7f) << shift;
    shift += 7n;
    if (byte >= 0x80) continue;
    last = clip(64, last + (rest & 1n ? -(rest + 1n) / 2n : rest / 2n));
    values.push(last);
    [rest, shift] = [0n, 0n];
  }
  return values;
}

/** Lengths in metres and angles in degrees; NaN where one is missing. */
function motions(part) {
  if (!part) return null;
  const known = (text, step) => series(text, step).map((value) => (value < 0 ? NaN : value));
  return { metres: known(part.metres, data.steps[0]), degrees: known(part.degrees, data.steps[1]) };
}

const ends = { from: Int32Array.from(series(data.edges.from)), to: Int32Array.from(series(data.edges.to)) };
const edgeIds = whole(data.edges.id);
const measured = once(() => motions(data.edges.measured));
const edgeOfId = once(() => new Map(Array.from(edgeIds, (id, edge) => [String(id), edge])));
const nodeIds = once(() => (data.nodes.id ? whole(data.nodes.id) : null));
const frames = once(() => (data.nodes.frame ? whole(data.nodes.frame) : null));
const framed = once(() => (data.nodes.framed ? bits(data.nodes.framed) : () => true));

/** Runs of nodes of one session: where each begins, and its session, -1 for none. */
const runs = { start: series(data.nodes.starts), session: series(data.nodes.session).map((number) => number - 1) };
const sessions = data.nodes.sessions;

/** For each node its session, -1 for none. */
const sessionOf = once(() => {
  const found = new Int32Array(nodeCount).fill(-1);
  for (let run = 0; run < runs.start.length; run += 1) {
    found.fill(runs.session[run], runs.start[run], runs.start[run + 1] ?? nodeCount);
  }
  return found;
});

function nodeId(node) {
  return String(nodeIds()?.[node] ?? node);
}

/** A node for a reader: its session and frame, or its id. */
function nodeName(node) {
  const session = sessions[sessionOf()[node]];
  const frame = frames() && framed()(node) ? `frame ${frames()[node]}` : null;
  const names = [sessions.length > 1 ? session : null, frame].filter(Boolean);
  return names.length ? names.join(", ") : `node ${nodeId(node)}`;
}
