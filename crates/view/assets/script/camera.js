// What part of the world is seen.

const still = { x: 0, y: 0, scale: 1 };

/** The middle of the view in the world, and pixels a metre. */
const camera = {
  ...still, width: 1, height: 1, home: { ...still }, moving: null,
  /** The scale at which a rectangle fits. */
  fitting(width, height) {
    return 0.92 * Math.min(this.width / Math.max(width, data.step), this.height / Math.max(height, data.step));
  },
  limit(scale) {
    return Math.max(this.home.scale / 4, Math.min(Math.max(4 / data.step, this.home.scale), scale));
  },
  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  },
  toWorld(right, down) {
    return [this.x + (right - this.width / 2) / this.scale, this.y - (down - this.height / 2) / this.scale];
  },
  /** Zooms about a point of the screen that stays where it is. */
  zoomAt(factor, right = this.width / 2, down = this.height / 2) {
    this.moving = null;
    const [x, y] = this.toWorld(right, down);
    this.scale = this.limit(this.scale * factor);
    const [nowX, nowY] = this.toWorld(right, down);
    this.x += x - nowX;
    this.y += y - nowY;
    repaint();
  },
  pan(right, down) {
    this.moving = null;
    this.x -= right / this.scale;
    this.y += down / this.scale;
    repaint();
  },
  /** Goes there, in a quarter of a second if motion is welcome. */
  fly(x, y, scale) {
    const from = { x: this.x, y: this.y, scale: this.scale }, to = { x, y, scale: this.limit(scale) };
    if (prefersStill.matches) {
      Object.assign(this, to);
      repaint();
      return;
    }
    this.moving = { from, to, start: performance.now() };
    repaint();
  },
  /** A step of a flight. Zooming is exponential, and the point between both views keeps its place. */
  step(now) {
    if (!this.moving) return;
    const { from, to, start } = this.moving, time = Math.min(1, Math.max(0, (now - start) / 260)), part = time * time * (3 - 2 * time);
    const ratio = to.scale / from.scale;
    this.scale = from.scale * ratio ** part;
    const way = Math.abs(ratio - 1) < 1e-6 ? part : (1 - ratio ** -part) / (1 - 1 / ratio);
    this.x = from.x + (to.x - from.x) * way;
    this.y = from.y + (to.y - from.y) * way;
    if (time >= 1) Object.assign(this, to, { moving: null });
    else repaint();
  },
  /** Shows all of a rectangle, at once or in a flight. */
  show(box, flight = true) {
    const scale = this.fitting(box.width, box.height);
    if (flight) this.fly(box.x, box.y, scale);
    else {
      Object.assign(this, { x: box.x, y: box.y, scale, moving: null });
      repaint();
    }
  },
};
