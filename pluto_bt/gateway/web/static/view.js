// Where the map is looked at from: metres to pixels and back, panning, zooming, following. y goes up.

const NEAREST = 400, FARTHEST = 2, FOLLOWED = 50; // pixels a metre
const ABOVE_PX = 54; // taken by figures and buttons
const SMALL_PX = 480, EDGE_PX = 12; // a map so low is shown whole, and they lie over it
const TAP_PX = 8, TAP_MS = 600;

export class View {
  /** `changed` is called when something must be drawn anew, `tapped(x_m, y_m)` for a tap; `below_px` of the canvas are covered at its foot. */
  constructor(canvas, changed, tapped, below_px) {
    Object.assign(this, { canvas, changed, tapped, below_px, x_m: 0, y_m: 0, scale: 40, width: 1, height: 1, isFollowing: false, cursor: null });
    this.pointers = new Map();
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.up(event, name === "pointerup"));
    canvas.addEventListener("pointerleave", () => { this.cursor = null; changed(); });
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); this.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY); }, { passive: false });
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.width = this.canvas.clientWidth || 1;
    this.height = this.canvas.clientHeight || 1;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
    if (this.box) this.fit(this.box);
    this.changed();
  }

  toScreen(x_m, y_m) {
    return [this.width / 2 + (x_m - this.x_m) * this.scale, this.height / 2 - (y_m - this.y_m) * this.scale];
  }

  toMap(x_px, y_px) {
    return [this.x_m + (x_px - this.width / 2) / this.scale, this.y_m - (y_px - this.height / 2) / this.scale];
  }

  /** Draw in metres from here on. */
  inMetres(context) {
    const s = this.scale * this.ratio;
    context.setTransform(s, 0, 0, -s, this.ratio * this.width / 2 - this.x_m * s, this.ratio * this.height / 2 + this.y_m * s);
  }

  inPixels(context) {
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }

  /** Show the whole of [x_min, y_min, x_max, y_max], again after each change of size until somebody looks elsewhere. */
  fit(box) {
    const [x0, y0, x1, y1] = box;
    this.box = box;
    this.x_m = (x0 + x1) / 2;
    const isSmall = this.height < SMALL_PX, above_px = isSmall ? EDGE_PX : ABOVE_PX, below_px = isSmall ? Math.max(EDGE_PX, this.below_px - 30) : this.below_px;
    const free_px = Math.max(this.height - above_px - below_px, 60);
    this.scale = clamp(0.94 * Math.min(this.width / Math.max(x1 - x0, 1), free_px / Math.max(y1 - y0, 1)));
    this.y_m = (y0 + y1) / 2 + (above_px - below_px) / 2 / this.scale;
    this.changed();
  }

  /** Follow what is followed from near enough to see it. */
  near() {
    this.box = null;
    this.scale = Math.max(this.scale, FOLLOWED);
    this.changed();
  }

  centre(x_m, y_m) {
    const [x, y] = this.toScreen(x_m, y_m);
    const isInside = Math.abs(x - this.width / 2) < this.width * 0.15 && Math.abs(y - this.height / 2) < this.height * 0.15;
    if (isInside) return; // the map stands still while the robot is well in sight
    this.x_m += (x_m - this.x_m) * 0.15;
    this.y_m += (y_m - this.y_m) * 0.15;
    this.changed();
  }

  zoom(factor, x_px = this.width / 2, y_px = this.height / 2) {
    const [x_m, y_m] = this.toMap(x_px, y_px);
    this.box = null;
    this.scale = clamp(this.scale * factor);
    const [x, y] = this.toMap(x_px, y_px);
    this.x_m += x_m - x;
    this.y_m += y_m - y;
    this.changed();
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    this.press = this.pointers.size === 1 ? { x: event.offsetX, y: event.offsetY, at: event.timeStamp } : null;
  }

  move(event) {
    this.cursor = event.pointerType === "mouse" ? this.toMap(event.offsetX, event.offsetY) : null;
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) {
      this.changed();
      return;
    }
    const before = [...this.pointers.values()].map((one) => ({ ...one }));
    Object.assign(pointer, { x: event.offsetX, y: event.offsetY });
    const after = [...this.pointers.values()];
    if (this.press && Math.hypot(pointer.x - this.press.x, pointer.y - this.press.y) <= TAP_PX) return;
    this.press = null;
    const middle = (points) => [points.reduce((sum, p) => sum + p.x, 0) / points.length, points.reduce((sum, p) => sum + p.y, 0) / points.length];
    const [x0, y0] = middle(before), [x1, y1] = middle(after);
    this.x_m -= (x1 - x0) / this.scale;
    this.y_m += (y1 - y0) / this.scale;
    this.box = null;
    this.moved?.();
    if (after.length === 2) {
      const far = (points) => Math.hypot(points[0].x - points[1].x, points[0].y - points[1].y);
      this.zoom(far(after) / Math.max(far(before), 1), x1, y1);
    }
    this.changed();
  }

  up(event, isTap) {
    this.pointers.delete(event.pointerId);
    if (isTap && this.press && event.timeStamp - this.press.at < TAP_MS) this.tapped(...this.toMap(event.offsetX, event.offsetY));
    this.press = null;
  }
}

const clamp = (scale) => Math.min(NEAREST, Math.max(FARTHEST, scale));
