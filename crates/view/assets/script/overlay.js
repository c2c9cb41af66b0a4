// The layer above the map: what is pointed at, what is selected, and its witnesses.

const over = byId("map");

/** Where the pointer is, pixels; null if it is elsewhere. On a touch screen, where it was last. */
let pointerAt = null;

/** Rejected edges with an end this near are drawn, pixels. */
const nearby = 24;
const mostNearby = 80;

/** The rejected edges with an end near the pointer, the nearest first. */
function nearEdges() {
  if (!pointerAt || rejectedMode() !== "near") return [];
  const map = mapShown(), [x, y] = camera.toWorld(...pointerAt), reach = nearby / camera.scale, found = [];
  grouped.groups.forEach((edges, index) => {
    if (map.states[index].kind !== "rejected") return;
    for (const edge of edges) {
      const one = awayFrom(ends.from[edge], x, y), other = awayFrom(ends.to[edge], x, y);
      if (Math.min(one, other) <= reach) found.push([Math.min(one, other), edge]);
    }
  });
  return found.sort((one, other) => one[0] - other[0] || one[1] - other[1]).slice(0, mostNearby).map(([, edge]) => edge);
}

/** Distance of a node from a point, metres; infinite without a place. */
function awayFrom(node, x, y) {
  return drawn.placed(node) ? Math.hypot(drawn.x[node] - x, drawn.y[node] - y) : Infinity;
}

/** A line with its ends, above everything else. */
function highlight(context, edge, style) {
  const nodes = [ends.from[edge], ends.to[edge]];
  if (!nodes.every((node) => drawn.placed(node))) return;
  context.beginPath();
  segment(context, ...nodes);
  strokeIn(context, { colour: colour("halo"), width: style.width + 4 });
  strokeIn(context, style);
  nodes.forEach((node, index) => {
    const [x, y] = camera.toScreen(drawn.x[node], drawn.y[node]);
    context.beginPath();
    context.arc(x, y, 4.2, 0, 7);
    // The measurement is in the frame of the first node: it is filled, the second is a ring.
    context.fillStyle = index ? colour("sheet") : style.colour;
    context.fill();
    strokeIn(context, { colour: style.colour, width: 2 });
  });
}

/** A text beside the middle of an edge. */
function tag(context, edge, text, ink) {
  const from = ends.from[edge], to = ends.to[edge];
  if (!drawn.placed(from) || !drawn.placed(to)) return;
  const [x, y] = camera.toScreen((drawn.x[from] + drawn.x[to]) / 2, (drawn.y[from] + drawn.y[to]) / 2);
  context.font = "600 12px system-ui, sans-serif";
  context.textAlign = "left";
  context.lineWidth = 4;
  context.setLineDash([]);
  context.strokeStyle = colour("halo");
  context.strokeText(text, x + 9, y - 8);
  context.fillStyle = ink;
  context.fillText(text, x + 9, y - 8);
}

/** The edge whose details are shown: the one pointed at, or the selected one. */
function edgeInFocus() {
  return state.hovered >= 0 ? state.hovered : state.selected;
}

function paintOverlay() {
  const context = prepared(over), map = mapShown(), focus = edgeInFocus();
  if (!drawn.placed) return;
  const near = nearEdges();
  for (const edge of near) {
    context.beginPath();
    segment(context, ends.from[edge], ends.to[edge]);
    strokeIn(context, { ...map.style(map.state[edge]), alpha: near.length > 40 ? 0.4 : 0.75 });
  }
  if (focus < 0) return;
  for (const id of map.witnesses(focus)) {
    const witness = edgeOfId().get(id);
    if (witness === undefined) continue;
    highlight(context, witness, { colour: colour("witness"), width: 3 });
    tag(context, witness, id, colour("witness"));
  }
  for (const edge of new Set([state.selected, focus])) {
    if (edge < 0) continue;
    const own = map.style(map.state[edge]);
    highlight(context, edge, { ...own, width: 3.2, dash: edge === focus ? own.dash && own.dash.map((part) => 1.6 * part) : own.dash });
    tag(context, edge, String(edgeIds[edge]), own.colour);
  }
}

when(["hovered", "selected"], repaintOverlay);
when(["rejected", "ghost"], repaint);
