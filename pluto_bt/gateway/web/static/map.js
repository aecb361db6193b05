// The map: draws what stands in the scenery and in the store, and only when something has changed.

import { drawGrid, drawWorld, drawPicture, drawScale } from "./map_world.js";
import { Trail, drawChosen, drawGoal, drawPath, drawRectangle, drawRobot, drawTruth } from "./map_robot.js";
import { drawCells, drawLaser, drawSonar } from "./map_senses.js";
import { GROUND } from "./colours.js";
import { View } from "./view.js";

const LAYERS = { laser: "Laser", sonar: "Sonar", trail: "Trail", plan: "Path, goal", names: "Names" };
const DRAWN = ["Localization/Pose", "sick/scan", "ATRV2/Sonar", "ATRV2/Bumper", "map/path", "motion/rectangle", "map/local", "motion/command", "avoidance/command", "world/state"];

const BELOW_PX = 42, BELOW_BOX_PX = 112; // legend; player and legend
const NEWS_MS = 100; // what the robot says is drawn so often at most; who moves the map sees every frame

export class MapView {
  constructor(canvas, store, scenery, chosen) {
    Object.assign(this, { store, scenery, picture: null, goal: null, isDirty: true, hasNews: false, drawn_ms: 0, seen: "" });
    this.context = canvas.getContext("2d", { alpha: false });
    this.still = document.createElement("canvas"); // what stands still, drawn anew only when the view changes
    this.layers = Object.fromEntries(Object.keys(LAYERS).map((name) => [name, true]));
    this.trail = new Trail(scenery.track);
    this.view = new View(canvas, () => { this.isDirty = true; }, (x_m, y_m) => chosen(...this.snapped(x_m, y_m)),
      scenery.mode === "box" ? BELOW_BOX_PX : BELOW_PX);
    for (const topic of DRAWN) store.on(topic, () => { this.hasNews = true; });
    store.on("Localization/Pose", ({ fields, stamp_s }) => this.trail.add(fields.pose, stamp_s));
    this.view.resize();
    this.view.fit(padded(scenery.world.bounds_m));
    this.frame = this.frame.bind(this);
    requestAnimationFrame(this.frame);
  }

  /** Buttons for the layers. */
  legend(make) {
    return Object.entries(LAYERS).map(([name, label]) => {
      const button = make("button", { type: "button", class: "layer", "aria-pressed": "true" }, label);
      button.onclick = () => {
        this.layers[name] = !this.layers[name];
        button.setAttribute("aria-pressed", String(this.layers[name]));
        this.isDirty = true;
      };
      return button;
    });
  }

  /** A tap near a goal of the map means that goal. */
  snapped(x_m, y_m) {
    const near_m = 16 / this.view.scale;
    const goal = this.scenery.world.goals.find((one) => Math.hypot(one.x - x_m, one.y - y_m) < near_m);
    return goal ? [goal.x, goal.y, goal] : [x_m, y_m, null];
  }

  choose(place) {
    this.goal = place;
    this.isDirty = true;
  }

  fit() {
    this.view.fit(padded(this.scenery.world.bounds_m));
  }

  frame() {
    requestAnimationFrame(this.frame);
    const pose = this.store.fields("Localization/Pose")?.pose;
    if (this.view.isFollowing && pose && this.view.box === null) this.view.centre(pose[0], pose[1]);
    const now_ms = performance.now();
    if (document.hidden || !(this.isDirty || (this.hasNews && now_ms - this.drawn_ms >= NEWS_MS))) return;
    Object.assign(this, { isDirty: false, hasNews: false, drawn_ms: now_ms });
    this.draw();
  }

  drawStill() {
    const { view, scenery, layers, still } = this, { width, height } = this.context.canvas;
    const seen = [view.x_m, view.y_m, view.scale, width, height, layers.names, Boolean(this.picture)].join();
    if (seen === this.seen) return;
    this.seen = seen;
    Object.assign(still, { width, height });
    const context = still.getContext("2d", { alpha: false });
    context.fillStyle = GROUND;
    context.fillRect(0, 0, width, height);
    drawGrid(context, view);
    if (this.picture) drawPicture(context, view, this.picture, scenery.grid);
    drawWorld(context, view, scenery.world, layers.names);
  }

  draw() {
    const { context, view, store, scenery, layers } = this;
    this.drawStill();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.still, 0, 0);
    drawCells(context, view, store);
    if (layers.plan) drawRectangle(context, view, store);
    if (layers.laser) drawLaser(context, view, store, scenery.robot);
    if (layers.sonar) drawSonar(context, view, store, scenery.robot);
    if (layers.trail) this.trail.draw(context, view);
    if (layers.plan) {
      drawPath(context, view, store);
      drawGoal(context, view, store);
    }
    drawTruth(context, view, store, scenery.robot);
    drawRobot(context, view, store, scenery.robot);
    if (this.goal) drawChosen(context, view, this.goal);
    drawScale(context, view);
  }
}

function padded([x0, y0, x1, y1]) {
  return [x0 - 0.5, y0 - 0.5, x1 + 0.5, y1 + 0.5];
}
