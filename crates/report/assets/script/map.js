// Maps on canvases that can be moved and zoomed, several of them together.

/** What part of the world is seen; shared by the maps that move together. */
class Camera {
  constructor() {
    this.maps = [];
    this.home = { x: 0, y: 0, width: 1, height: 1 };
    this.reset();
  }
  /** Looks at all of a rectangle. */
  lookAt(home) {
    if (["x", "y", "width", "height"].every((name) => home[name] === this.home[name])) return;
    this.home = home;
    this.reset();
  }
  reset() {
    this.x = this.home.x;
    this.y = this.home.y;
    this.zoom = 1;
    this.paint();
  }
  /** Zooms about a point of the world that stays where it is. */
  zoomAt(factor, x = this.x, y = this.y) {
    const zoom = Math.max(0.5, Math.min(400, this.zoom * factor));
    const done = zoom / this.zoom;
    this.x = x + (this.x - x) / done;
    this.y = y + (this.y - y) / done;
    this.zoom = zoom;
    this.paint();
  }
  move(x, y) {
    this.x += x;
    this.y += y;
    this.paint();
  }
  paint() {
    for (const map of this.maps) map.schedule();
  }
}

const allMaps = [];

class MapView {
  /** `draw(context, toScreen, scale)` paints; `point(x, y, tolerance)` is told where the pointer is, in world units. */
  constructor(canvas, camera, unit) {
    Object.assign(this, { canvas, camera, unit, draw: null, point: null, pointers: new Map() });
    camera.maps.push(this);
    allMaps.push(this);
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    for (const name of ["pointerup", "pointercancel", "pointerleave"]) {
      canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    }
    canvas.addEventListener("dblclick", (event) => camera.zoomAt(2, ...this.world(event)));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }
  /** Pixels a unit of the world. */
  get scale() {
    const { home, zoom } = this.camera;
    return 0.92 * zoom * Math.min(this.canvas.clientWidth / home.width, this.canvas.clientHeight / home.height);
  }
  world(event) {
    const box = this.canvas.getBoundingClientRect();
    return [
      this.camera.x + (event.clientX - box.left - box.width / 2) / this.scale,
      this.camera.y - (event.clientY - box.top - box.height / 2) / this.scale,
    ];
  }
  wheel(event) {
    // A page must scroll past a map: the wheel zooms where the map has the focus, or with Ctrl (pinching on a touchpad).
    if (document.activeElement !== this.canvas && !event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    this.camera.zoomAt(Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0015)), ...this.world(event));
  }
  down(event) {
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.pointerType === "mouse") this.canvas.setPointerCapture(event.pointerId);
  }
  moved(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) {
      this.point?.(...this.world(event), 8 / this.scale);
      return;
    }
    const now = [event.clientX, event.clientY];
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, now);
    if (other) {
      const distance = (one) => Math.max(10, Math.hypot(one[0] - other[0], one[1] - other[1]));
      this.camera.zoomAt(distance(now) / distance(last), ...this.world({ clientX: other[0], clientY: other[1] }));
    } else {
      this.camera.move((last[0] - now[0]) / this.scale, (now[1] - last[1]) / this.scale);
    }
  }
  key(event) {
    const step = 60 / this.scale;
    const actions = {
      "+": () => this.camera.zoomAt(1.5), "=": () => this.camera.zoomAt(1.5), "-": () => this.camera.zoomAt(1 / 1.5),
      0: () => this.camera.reset(), ArrowLeft: () => this.camera.move(-step, 0), ArrowRight: () => this.camera.move(step, 0),
      ArrowUp: () => this.camera.move(0, step), ArrowDown: () => this.camera.move(0, -step),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  }
  schedule() {
    this.waiting ??= requestAnimationFrame(() => this.paint());
  }
  paint() {
    this.waiting = undefined;
    const { canvas, camera } = this;
    const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!this.draw || !width) return;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.lineJoin = context.lineCap = "round";
    const scale = this.scale;
    this.draw(context, (x, y) => [width / 2 + (x - camera.x) * scale, height / 2 - (y - camera.y) * scale], scale);
    this.ruler(context, width, height, scale);
  }
  /** A length to compare with. */
  ruler(context, width, height, scale) {
    const rough = 110 / scale, power = 10 ** Math.floor(Math.log10(rough));
    const length = [5, 2, 1].map((factor) => factor * power).find((candidate) => candidate <= rough);
    const [right, down] = [width - 14, height - 14];
    context.strokeStyle = context.fillStyle = colour("soft");
    context.lineWidth = 1.5;
    context.setLineDash([]);
    context.beginPath();
    context.moveTo(right - length * scale, down - 4);
    context.lineTo(right - length * scale, down);
    context.lineTo(right, down);
    context.lineTo(right, down - 4);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "right";
    context.fillText(`${short(length)} ${this.unit}`, right, down - 8);
  }
}

function mapButtons(place, camera) {
  const button = (text, label, press) => element("button", { type: "button", "aria-label": label, onclick: press }, text);
  place.replaceChildren(
    button("+", "Zoom in", () => camera.zoomAt(1.6)),
    button("−", "Zoom out", () => camera.zoomAt(1 / 1.6)),
    button("Whole", "Show the whole", () => camera.reset()));
}

/** The rectangle around points given as pairs of lists. */
function around(lists) {
  let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y } of lists) {
    for (let index = 0; index < x.length; index += 1) {
      left = Math.min(left, x[index]);
      right = Math.max(right, x[index]);
      low = Math.min(low, y[index]);
      high = Math.max(high, y[index]);
    }
  }
  if (!(right >= left)) return { x: 0, y: 0, width: 1, height: 1 };
  return { x: (left + right) / 2, y: (low + high) / 2, width: Math.max(1, right - left), height: Math.max(1, high - low) };
}

/** A line through the points `from` to `to` (not included). */
function trace(context, toScreen, track, from, to, style) {
  context.beginPath();
  for (let index = from; index < to; index += 1) {
    const [x, y] = toScreen(track.x[index], track.y[index]);
    if (index === from) context.moveTo(x, y);
    else context.lineTo(x, y);
  }
  strokeLine(context, style);
}

/** An edge between two points of the screen, with dots at its ends if the style has them. */
function strokeEdge(context, ends, style) {
  context.beginPath();
  context.moveTo(...ends[0]);
  context.lineTo(...ends[1]);
  strokeLine(context, style);
  if (!style.dot) return;
  context.fillStyle = style.colour;
  for (const [x, y] of ends) {
    context.beginPath();
    context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fill();
  }
}

function strokeLine(context, style) {
  context.strokeStyle = style.colour;
  context.lineWidth = style.width;
  context.setLineDash(style.dash ?? []);
  context.stroke();
}

/** Distance of a point from a stretch of line, all in world units. */
function distance(x, y, [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const part = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - ax - part * dx, y - ay - part * dy);
}
