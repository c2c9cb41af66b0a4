// Where the nodes are on the plane that is shown, and the paths through them.

/** The shown coordinates of all nodes; they move from one map to the next. */
const drawn = { x: new Float64Array(nodeCount), y: new Float64Array(nodeCount), placed: null, ghost: null, from: null, start: 0 };

/** Runs of nodes that odometry joins one after the other, of one session each. */
const paths = once(() => {
  const joined = bits(data.nodes.joined), found = [];
  for (let run = 0; run < runs.start.length; run += 1) {
    const end = runs.start[run + 1] ?? nodeCount, session = runs.session[run];
    // Odometry from one session into the next belongs to the later one.
    let start = runs.start[run] > 0 && joined(runs.start[run]) ? runs.start[run] - 1 : runs.start[run];
    for (let node = start + 1; node <= end; node += 1) {
      if (node < end && joined(node)) continue;
      if (node - start > 1) found.push({ start, end: node, session });
      start = node;
    }
  }
  return found;
});

/** Odometry between other nodes. */
const furtherSteps = once(() => ({ from: series(data.nodes.from), to: series(data.nodes.to) }));

/** Coordinates on the plane that is shown: to the right, upwards. */
function projected(places) {
  const { right, up } = data.planes[state.plane];
  const along = ({ axis, sign }) => (sign > 0 ? places.axes[axis] : places.axes[axis].map((value) => -value));
  return { x: along(right), y: along(up), placed: places.placed };
}

/** The rectangle around all nodes that have a place. */
function around({ x, y, placed }) {
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let node = 0; node < nodeCount; node += 1) {
    if (!placed(node)) continue;
    left = Math.min(left, x[node]);
    right = Math.max(right, x[node]);
    low = Math.min(low, y[node]);
    high = Math.max(high, y[node]);
  }
  if (!(right >= left)) return { x: 0, y: 0, width: 1, height: 1 };
  return { x: (left + right) / 2, y: (low + high) / 2, width: right - left, height: high - low };
}

/** The usual length of a step of odometry, metres; 0 without one. */
function usualStep() {
  const lengths = [];
  for (const { start, end } of paths()) {
    for (let node = start + 1; node < end && lengths.length < 2000; node += 1) lengths.push(Math.hypot(drawn.x[node] - drawn.x[node - 1], drawn.y[node] - drawn.y[node - 1]));
  }
  return lengths.sort((one, other) => one - other)[lengths.length >> 1] ?? 0;
}

/** A step of the motion from one set of poses to another. */
function morph(now) {
  if (!drawn.from) return;
  const time = Math.min(1, Math.max(0, (now - drawn.start) / 420)), part = time * time * (3 - 2 * time);
  const { from, to } = drawn;
  for (let node = 0; node < nodeCount; node += 1) {
    drawn.x[node] = from.x[node] + part * (to.x[node] - from.x[node]);
    drawn.y[node] = from.y[node] + part * (to.y[node] - from.y[node]);
  }
  if (time >= 1) drawn.from = null;
  else repaint();
}

let framedPlane = null;

when(["map", "after", "plane"], () => {
  const places = placesShown(), others = placesShown(true);
  drawn.ghost = others && projected(others);
  drawn.from = null;
  const target = places ? projected(places) : { x: new Float64Array(nodeCount), y: new Float64Array(nodeCount), placed: () => false };
  const moves = drawn.placed && framedPlane === state.plane && !prefersStill.matches && nodeCount <= 200000;
  drawn.placed = target.placed;
  if (moves) {
    Object.assign(drawn, { from: { x: drawn.x.slice(), y: drawn.y.slice() }, to: target, start: performance.now() });
  } else {
    drawn.x.set(target.x);
    drawn.y.set(target.y);
  }
  if (framedPlane !== state.plane) {
    framedPlane = state.plane;
    camera.framed = false;
  }
  repaint();
});

/** Shows everything. */
function showAll(flight = true) {
  const box = around(drawn.from ? { ...drawn.to } : drawn);
  camera.home.scale = camera.fitting(box.width, box.height);
  camera.show(box, flight);
}

/** The rectangle around the ends of edges; null if one has no place. */
function aroundEdges(edges) {
  const { x, y } = drawn.from ? drawn.to : drawn, nodes = edges.flatMap((edge) => [ends.from[edge], ends.to[edge]]);
  if (!nodes.every((node) => drawn.placed(node))) return null;
  const [left, right] = [Math.min(...nodes.map((node) => x[node])), Math.max(...nodes.map((node) => x[node]))];
  const [low, high] = [Math.min(...nodes.map((node) => y[node])), Math.max(...nodes.map((node) => y[node]))];
  return { x: (left + right) / 2, y: (low + high) / 2, width: right - left, height: high - low };
}

/** Flies to an edge and its witnesses, unless they are far away, with some of the path around it. */
function showEdge(edge) {
  const alone = aroundEdges([edge]), found = mapShown().witnesses(edge).map((id) => edgeOfId().get(id)).filter((one) => one !== undefined);
  if (!alone) return;
  const least = Math.max(alone.width, alone.height, 30 * usualStep(), 20 * data.step), all = aroundEdges([edge, ...found]);
  const box = all && Math.max(all.width, all.height) < 3 * least ? all : alone;
  const size = Math.max(1.25 * box.width, 1.25 * box.height, 30 * usualStep(), 20 * data.step);
  camera.show({ ...box, width: Math.max(size / 2, 1.25 * box.width), height: Math.max(size / 2, 1.25 * box.height) });
}
