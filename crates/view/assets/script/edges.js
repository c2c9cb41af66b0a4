// How edges are drawn: by state, with rejected ones below, faint, or only near the pointer.

/** The ends of the line between two nodes on the screen; null if they have no places or the line is elsewhere. */
function lineBetween(one, other, places = drawn) {
  if (!places.placed(one) || !places.placed(other)) return null;
  const [ax, ay] = camera.toScreen(places.x[one], places.y[one]), [bx, by] = camera.toScreen(places.x[other], places.y[other]);
  if (Math.max(ax, bx) < 0 || Math.min(ax, bx) > camera.width || Math.max(ay, by) < 0 || Math.min(ay, by) > camera.height) return null;
  return [ax, ay, bx, by];
}

/** Adds the line between two nodes. */
function segment(context, one, other, places = drawn) {
  const line = lineBetween(one, other, places);
  if (!line) return;
  context.moveTo(line[0], line[1]);
  context.lineTo(line[2], line[3]);
}

/** The edges that pass the filters, by state. */
const grouped = { groups: [], rejected: 0 };

when(["map", "filters", "probability", "pair", "part"], () => {
  const map = mapShown();
  grouped.groups = map.states.map(() => []);
  for (const edge of filter.shown) grouped.groups[map.state[edge]].push(edge);
  grouped.rejected = grouped.groups.reduce((sum, list, index) => sum + (map.states[index].kind === "rejected" ? list.length : 0), 0);
  repaint();
});

/** Above this many, rejected edges are drawn only near the pointer, unless the reader chooses otherwise. */
const mostFaint = 400;

/** How rejected edges are drawn: `faint`, `near`, `full` or `none`. */
function rejectedMode() {
  return state.rejected === "automatic" ? (grouped.rejected > mostFaint ? "near" : "faint") : state.rejected;
}

/** Draws edges of one state, a few hundred at a time: one line through thousands takes long. Short ones become dots. */
function strokeEdges(context, edges, style) {
  const dots = [], cover = new Cover();
  for (let first = 0; first < edges.length; first += 400) {
    context.beginPath();
    for (const edge of edges.slice(first, first + 400)) {
      const line = lineBetween(ends.from[edge], ends.to[edge]);
      if (!line) continue;
      const [ax, ay, bx, by] = line;
      if (Math.abs(ax - bx) + Math.abs(ay - by) < 6) {
        if (cover.take((ax + bx) / 2, (ay + by) / 2)) dots.push([(ax + bx) / 2, (ay + by) / 2]);
      } else {
        context.moveTo(ax, ay);
        context.lineTo(bx, by);
      }
    }
    strokeIn(context, style);
  }
  const radius = dots.length > 1500 ? 1.9 : 2.4;
  context.fillStyle = style.colour;
  context.globalAlpha = Math.min(1, 1.5 * (style.alpha ?? 1));
  context.beginPath();
  for (const [x, y] of dots) {
    context.moveTo(x + radius, y);
    context.arc(x, y, radius, 0, 7);
  }
  context.fill();
  context.globalAlpha = 1;
}

/** Small marks at the ends of edges that are drawn near the pointer only. */
function markEnds(context, edges, style) {
  const cover = new Cover();
  context.fillStyle = style.colour;
  context.globalAlpha = 0.4;
  for (const edge of edges) {
    for (const node of [ends.from[edge], ends.to[edge]]) {
      if (!drawn.placed(node)) continue;
      const [x, y] = camera.toScreen(drawn.x[node], drawn.y[node]);
      if (cover.take(x, y)) context.fillRect(x - 1.25, y - 1.25, 2.5, 2.5);
    }
  }
  context.globalAlpha = 1;
}

function paintEdges(context, kinds) {
  const map = mapShown(), mode = rejectedMode();
  grouped.groups.forEach((edges, index) => {
    const { kind } = map.states[index];
    if (!edges.length || !kinds.includes(kind)) return;
    const style = map.style(index), many = edges.length / 3000;
    if (kind !== "rejected") strokeEdges(context, edges, { ...style, width: Math.max(1, style.width - many), alpha: Math.max(0.65, 1 - many / 2) });
    else if (mode === "near") markEnds(context, edges, style);
    else if (mode !== "none") strokeEdges(context, edges, { ...style, width: grouped.rejected > 60 && mode !== "full" ? 1 : style.width, alpha: mode === "full" ? 0.8 : Math.max(0.16, Math.min(0.5, 24 / grouped.rejected)), dash: grouped.rejected > 2000 ? null : style.dash });
  });
}
