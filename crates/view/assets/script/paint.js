// The map below: grid, paths and edges. It is painted again when the view or the filters change.

const base = byId("base");
/** Makes a canvas as fine as the screen, up to twice: finer costs time and shows nothing. */
function prepared(canvas) {
  const ratio = Math.min(2, devicePixelRatio || 1);
  const [width, height] = [Math.round(camera.width * ratio), Math.round(camera.height * ratio)];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, camera.width, camera.height);
  context.lineJoin = context.lineCap = "round";
  return context;
}

function paint(now) {
  waiting = null;
  const wholeMap = !overlayOnly;
  overlayOnly = true;
  morph(now);
  camera.step(now);
  if (wholeMap) paintBase();
  paintOverlay();
}

function strokeIn(context, style) {
  context.strokeStyle = style.colour;
  context.lineWidth = style.width;
  context.globalAlpha = style.alpha ?? 1;
  context.setLineDash(style.dash ?? []);
  context.stroke();
  context.globalAlpha = 1;
}

function grid(context) {
  const step = roundUp(80 / camera.scale), [left, low] = camera.toWorld(0, camera.height), [right, high] = camera.toWorld(camera.width, 0);
  context.beginPath();
  for (let x = Math.ceil(left / step) * step; x <= right; x += step) {
    const at = Math.round(camera.toScreen(x, 0)[0]) + 0.5;
    context.moveTo(at, 0);
    context.lineTo(at, camera.height);
  }
  for (let y = Math.ceil(low / step) * step; y <= high; y += step) {
    const at = Math.round(camera.toScreen(0, y)[1]) + 0.5;
    context.moveTo(0, at);
    context.lineTo(camera.width, at);
  }
  strokeIn(context, { colour: colour("grid"), width: 1 });
}

/** Which parts of the screen, two pixels wide, are covered already. What would cover nothing new need not be drawn. */
class Cover {
  constructor() {
    this.columns = Math.ceil(camera.width / 2) + 1;
    this.cells = new Uint8Array(this.columns * (Math.ceil(camera.height / 2) + 1));
  }
  /** Covers a point; returns whether it was free and on the screen. */
  take(right, down) {
    if (right < 0 || down < 0 || right > camera.width || down > camera.height) return false;
    const cell = (down >> 1) * this.columns + (right >> 1);
    if (this.cells[cell]) return false;
    this.cells[cell] = 1;
    return true;
  }
}

/** Above this many nodes, paths are drawn more coarsely: many of them lie on each other. */
const manyNodes = 20000;

/**
 * Adds the line through a run of nodes. Points closer than a pixel are left out, and so is what lies off the screen, or, with a
 * cover, short pieces between points that are covered.
 */
function trace(context, { x, y, placed }, { start, end }, cover) {
  const { width, height, scale } = camera, shiftX = width / 2 - camera.x * scale, shiftY = height / 2 + camera.y * scale;
  const least = cover ? 1.8 : 1;
  let lastX = 0, lastY = 0, lastSide = 0, pen = false, ink = false;
  for (let node = start; node < end; node += 1) {
    if (!placed(node)) {
      pen = false;
      continue;
    }
    const right = shiftX + x[node] * scale, down = shiftY - y[node] * scale, away = Math.max(Math.abs(right - lastX), Math.abs(down - lastY));
    if (pen && node < end - 1 && away < least) continue;
    const side = (right < 0 ? 1 : 0) | (right > width ? 2 : 0) | (down < 0 ? 4 : 0) | (down > height ? 8 : 0);
    const covered = cover ? !cover.take(right, down) && away < 6 : false;
    if (!pen || side & lastSide || covered) ink = false;
    else {
      if (!ink) context.moveTo(lastX, lastY);
      context.lineTo(right, down);
      ink = true;
    }
    [lastX, lastY, lastSide, pen] = [right, down, side, true];
  }
}

/** All paths, by session if they have colours of their own. */
function tracePaths(context, places, style, bySession = true) {
  const found = new Map();
  for (const path of paths()) {
    const key = bySession ? sessionColour(path.session) : style.colour;
    if (!found.has(key)) found.set(key, []);
    found.get(key).push(path);
  }
  for (const [own, list] of found) {
    const cover = nodeCount > manyNodes ? new Cover() : null;
    context.beginPath();
    for (const path of list) trace(context, places, path, cover);
    strokeIn(context, { ...style, colour: own });
  }
  const { from, to } = furtherSteps();
  if (!from.length) return;
  context.beginPath();
  for (let step = 0; step < from.length; step += 1) segment(context, from[step], to[step], places);
  strokeIn(context, { ...style, colour: bySession ? colour("path") : style.colour });
}

function paintBase() {
  const context = prepared(base);
  grid(context);
  if (!drawn.placed) return;
  const halo = nodeCount <= manyNodes;
  if (state.ghost && drawn.ghost) tracePaths(context, drawn.ghost, { colour: colour("ghost"), width: 4 }, false);
  paintEdges(context, ["rejected"]);
  if (halo) tracePaths(context, drawn, { colour: colour("halo"), width: 4.5 }, false);
  const part = state.part >= 0 && mapShown().part();
  tracePaths(context, drawn, { width: 2, alpha: part ? 0.25 : 1 });
  if (part) tracePaths(context, { ...drawn, placed: (node) => drawn.placed(node) && part[node] === state.part }, { width: 2 });
  paintEdges(context, ["undecided"]);
  paintEdges(context, ["kept"]);
  paintBroken(context);
  paintRuler(context);
}

/** Odometry that is not to be trusted: a thick line with a gap. */
function paintBroken(context) {
  for (const step of data.broken) {
    context.beginPath();
    segment(context, step.from, step.to);
    strokeIn(context, { colour: colour("broken"), width: 5, dash: [3, 6] });
    const [x, y] = camera.toScreen((drawn.x[step.from] + drawn.x[step.to]) / 2, (drawn.y[step.from] + drawn.y[step.to]) / 2);
    context.beginPath();
    context.arc(x, y, 7, 0, 7);
    strokeIn(context, { colour: colour("broken"), width: 1.6 });
  }
}

/** A length to compare with, and the directions of the axes. */
function paintRuler(context) {
  const rough = 120 / camera.scale, power = 10 ** Math.floor(Math.log10(rough));
  const length = [5, 2, 1].map((factor) => factor * power).find((candidate) => candidate <= rough) * camera.scale;
  const right = camera.width - 16, low = camera.height - 16, { right: across, up } = data.planes[state.plane];
  context.fillStyle = colour("soft");
  context.font = "12px system-ui, sans-serif";
  context.beginPath();
  context.moveTo(right - length, low - 5);
  context.lineTo(right - length, low);
  context.lineTo(right, low);
  context.lineTo(right, low - 5);
  context.moveTo(16, low - 34);
  context.lineTo(16, low);
  context.lineTo(50, low);
  context.moveTo(12.5, low - 29);
  context.lineTo(16, low - 34);
  context.lineTo(19.5, low - 29);
  context.moveTo(45, low - 3.5);
  context.lineTo(50, low);
  context.lineTo(45, low + 3.5);
  strokeIn(context, { colour: colour("soft"), width: 1.3 });
  context.textAlign = "right";
  context.fillText(`${brief(length / camera.scale)} m`, right, low - 9);
  context.textAlign = "left";
  context.fillText(across.name, 55, low + 4);
  context.fillText(up.name, 11, low - 41);
}
