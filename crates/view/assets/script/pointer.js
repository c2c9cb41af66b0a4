// The pointer on the map: drag to pan, wheel or pinch to zoom, point at an edge or tap it.

const pointers = new Map();
let travelled = 0;

function placeOf(event) {
  const box = over.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

/** Distance of a point from the line of an edge, pixels; infinite if it has no place. */
function edgeDistance(edge, right, down) {
  const from = ends.from[edge], to = ends.to[edge];
  if (!drawn.placed(from) || !drawn.placed(to)) return Infinity;
  const [ax, ay] = camera.toScreen(drawn.x[from], drawn.y[from]), [bx, by] = camera.toScreen(drawn.x[to], drawn.y[to]);
  const [dx, dy] = [bx - ax, by - ay];
  const part = Math.max(0, Math.min(1, ((right - ax) * dx + (down - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(right - ax - part * dx, down - ay - part * dy);
}

/** The edge at a point, -1 for none. Edges that are drawn faintly must be nearer, because they are under the others. */
function edgeAt([right, down], reach) {
  const map = mapShown(), mode = rejectedMode(), near = new Set(nearEdges());
  let found = -1, least = reach;
  for (const edge of filter.shown) {
    const rejected = map.stateOf(edge).kind === "rejected";
    if (rejected && (mode === "none" || (mode === "near" && !near.has(edge)))) continue;
    const away = edgeDistance(edge, right, down) + (rejected ? 0.3 * reach : 0);
    if (away < least) [found, least] = [edge, away];
  }
  return found;
}

/** The node at a point, -1 for none. */
function nodeAt([right, down], reach) {
  const [x, y] = camera.toWorld(right, down);
  let found = -1, least = reach / camera.scale;
  for (let node = 0; node < nodeCount; node += 1) {
    if (Math.abs(drawn.x[node] - x) > least) continue;
    const away = awayFrom(node, x, y);
    if (away < least) [found, least] = [node, away];
  }
  return found;
}

function showTip(at, text) {
  const tip = byId("tip");
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  const left = Math.max(4, Math.min(at[0] + 14, camera.width - tip.offsetWidth - 8));
  const top = at[1] + 18 + tip.offsetHeight > camera.height ? at[1] - tip.offsetHeight - 12 : at[1] + 18;
  tip.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px)`;
}

/** An edge in a few words. */
function inShort(edge) {
  const map = mapShown(), parts = [`edge ${edgeIds[edge]}: ${map.stateOf(edge).name}`];
  const reason = map.word("verify_reason", edge) ?? map.word("pcm_role", edge), probability = map.column("verify_probability")?.text(edge);
  if (reason) parts.push(reason);
  if (probability) parts.push(`probability ${probability}`);
  return parts.join(" \u00b7 ");
}

function pointAt(at, reach = 9) {
  const edge = edgeAt(at, reach), node = edge < 0 ? nodeAt(at, reach) : -1;
  const broken = node < 0 ? null : data.broken.find((step) => step.from === node || step.to === node);
  over.classList.toggle("over-edge", edge >= 0);
  showTip(at, edge >= 0 ? inShort(edge) : broken ? `odometry ${broken.id}: ${broken.why}` : node >= 0 ? nodeName(node) : "");
  change({ hovered: edge });
  if (rejectedMode() === "near") repaintOverlay();
}

over.addEventListener("pointerdown", (event) => {
  if (event.button !== 0) return;
  if (!pointers.size) travelled = 0;
  pointers.set(event.pointerId, placeOf(event));
  over.setPointerCapture(event.pointerId);
  over.classList.add("dragging");
  showTip(null, "");
});

over.addEventListener("pointermove", (event) => {
  const now = placeOf(event), last = pointers.get(event.pointerId);
  if (event.pointerType === "mouse") pointerAt = now;
  if (!last) {
    if (event.pointerType === "mouse") pointAt(now);
    return;
  }
  const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
  pointers.set(event.pointerId, now);
  travelled += Math.hypot(now[0] - last[0], now[1] - last[1]);
  if (other) {
    const distance = (one) => Math.max(10, Math.hypot(one[0] - other[0], one[1] - other[1]));
    camera.zoomAt(distance(now) / distance(last), ...other);
  } else if (travelled > 4) {
    camera.pan(now[0] - last[0], now[1] - last[1]);
  }
});

for (const name of ["pointerup", "pointercancel"]) {
  over.addEventListener(name, (event) => {
    const tapped = pointers.delete(event.pointerId) && name === "pointerup" && !pointers.size && travelled < 8;
    if (!pointers.size) over.classList.remove("dragging");
    if (!tapped) return;
    pointerAt = placeOf(event);
    change({ selected: edgeAt(pointerAt, event.pointerType === "mouse" ? 9 : 20), hovered: -1 });
    if (event.pointerType !== "mouse") showTip(pointerAt, state.selected >= 0 ? inShort(state.selected) : "");
    repaintOverlay();
  });
}

over.addEventListener("pointerleave", (event) => {
  if (event.pointerType !== "mouse") return;
  pointerAt = null;
  showTip(null, "");
  change({ hovered: -1 });
  repaintOverlay();
});

over.addEventListener("wheel", (event) => {
  event.preventDefault();
  const lines = event.deltaMode ? 16 : 1;
  camera.zoomAt(Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0016)), ...placeOf(event));
  showTip(null, "");
}, { passive: false });

over.addEventListener("dblclick", (event) => camera.zoomAt(2, ...placeOf(event)));
