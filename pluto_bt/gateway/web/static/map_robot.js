// What moves on the map: the robot, where it came from, what it was told and means to do. What is too old to trust is drawn grey.

import { ACCENT, ACCENT_DIM, ACCENT_FAINT, BAD, OLD, WARN } from "./colours.js";
import { outlineOf } from "./map_world.js";
import { list } from "./wire.js";

const SIGMAS_95 = 2.4477; // of a plane error
const TRAIL_POINTS = 4000, TRAIL_STEP_M = 0.05, JUMP_M = 1.0;
const TRUTH_S = 0.3; // truth and belief are compared only at about the same time
const NO_COMMAND = 0, GOTO = 2, MOVETO = 42;

/** The pose, [x, y, theta]. */
export function poseOf(store) {
  const pose = store.fields("Localization/Pose")?.pose;
  return pose ? [pose[0], pose[1], pose[3]] : null;
}

/** The pose at which a value was true: a recording knows the way and has few samples, a live robot has only one pose. */
export function poseWhen(store, value) {
  const found = store.track?.findLast((point) => point[2] <= value.stamp_s);
  return found ? [found[0], found[1], found[3]] : poseOf(store);
}

/** From a point in a frame to the map. */
export function placed([x, y, theta], px, py) {
  const c = Math.cos(theta), s = Math.sin(theta);
  return [x + c * px - s * py, y + s * px + c * py];
}

export class Trail {
  /** `track`: the whole way of a recording, [x, y, t, theta]; only what lies behind is drawn. */
  constructor(track = null) {
    this.track = track?.map(([x, y, t_s]) => [x, y, t_s, false]);
    this.points = [];
  }

  add(pose, stamp_s) {
    if (this.track) {
      this.points = this.track.filter((point) => point[2] <= stamp_s);
      return;
    }
    const last = this.points.at(-1);
    if (last && stamp_s < last[2]) this.points = []; // a recording went back, or another run began
    const far = last ? Math.hypot(pose[0] - last[0], pose[1] - last[1]) : Infinity;
    if (far < TRAIL_STEP_M) return;
    this.points.push([pose[0], pose[1], stamp_s, far > JUMP_M]);
    if (this.points.length > TRAIL_POINTS) this.points.splice(0, TRAIL_POINTS / 4);
  }

  draw(context, view) {
    view.inMetres(context);
    context.beginPath();
    for (const [x, y, , isNew] of this.points) isNew ? context.moveTo(x, y) : context.lineTo(x, y);
    context.strokeStyle = ACCENT_DIM;
    context.lineWidth = 1.5 / view.scale;
    context.stroke();
  }
}

export function drawRobot(context, view, store, robot) {
  const pose = poseOf(store);
  if (!pose) return;
  const colour = store.isStale("Localization/Pose") ? OLD : ACCENT;
  drawDoubt(context, view, pose, store.fields("Localization/Pose").covariance, colour);
  view.inMetres(context);
  context.translate(pose[0], pose[1]);
  context.rotate(pose[2]);
  const outline = outlineOf(robot.outline_m);
  context.fillStyle = "rgba(12, 15, 19, 0.75)";
  context.fill(outline);
  context.fillStyle = ACCENT_FAINT;
  context.fill(outline);
  context.lineWidth = 2 / view.scale;
  context.strokeStyle = colour;
  context.stroke(outline);
  const front = Math.max(...robot.outline_m.map((point) => point[0])), back = Math.min(...robot.outline_m.map((point) => point[0]));
  drawArrow(context, front, colour);
  const bumper = store.fields("ATRV2/Bumper");
  for (const [isPressed, at] of [[bumper?.front, front], [bumper?.back, back]]) if (isPressed) drawBumper(context, view, robot, at);
}

function drawArrow(context, front, colour) {
  const size = Math.max(0.12, 0.32 * front);
  context.beginPath();
  context.moveTo(front * 0.78, 0);
  context.lineTo(front * 0.78 - size, size * 0.6);
  context.lineTo(front * 0.78 - size * 0.7, 0);
  context.lineTo(front * 0.78 - size, -size * 0.6);
  context.closePath();
  context.fillStyle = colour;
  context.fill();
}

function drawBumper(context, view, robot, at) {
  const half = Math.max(...robot.outline_m.map((point) => point[1]));
  context.beginPath();
  context.moveTo(at, -half);
  context.lineTo(at, half);
  context.strokeStyle = BAD;
  context.lineWidth = 6 / view.scale;
  context.stroke();
}

/** The ellipse that holds the place with 95 %. */
function drawDoubt(context, view, pose, covariance, colour) {
  if (!Array.isArray(covariance)) return;
  const n = Math.round(Math.sqrt(covariance.length));
  const xx = covariance[0], xy = covariance[1], yy = covariance[n + 1];
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  const long = SIGMAS_95 * Math.sqrt(Math.max(mean + spread, 0)), short = SIGMAS_95 * Math.sqrt(Math.max(mean - spread, 0));
  if (!(long > 0)) return;
  view.inMetres(context);
  context.beginPath();
  context.ellipse(pose[0], pose[1], long, Math.max(short, 1e-3), 0.5 * Math.atan2(2 * xy, xx - yy), 0, 2 * Math.PI);
  context.setLineDash([4 / view.scale, 4 / view.scale]);
  context.strokeStyle = colour;
  context.lineWidth = 1 / view.scale;
  context.stroke();
  context.setLineDash([]);
}

/** Simulation: where it really is, if that is not where it believes to be. */
export function drawTruth(context, view, store, robot) {
  const truth = store.fields("world/state")?.pose_map_robot, pose = poseOf(store);
  const apart_s = truth && pose ? Math.abs(store.get("world/state").stamp_s - store.get("Localization/Pose").stamp_s) : Infinity;
  if (apart_s > TRUTH_S || Math.hypot(truth[0] - pose[0], truth[1] - pose[1]) < 0.15) return;
  view.inMetres(context);
  context.translate(truth[0], truth[1]);
  context.rotate(truth[2]);
  context.setLineDash([3 / view.scale, 3 / view.scale]);
  context.strokeStyle = OLD;
  context.lineWidth = 1.2 / view.scale;
  context.stroke(outlineOf(robot.outline_m));
  context.setLineDash([]);
}

export function drawPath(context, view, store) {
  const points = list(store.fields("map/path")?.points_m);
  if (points.length < 4) return;
  view.inMetres(context);
  context.beginPath();
  for (let i = 0; i < points.length; i += 2) context.lineTo(points[i], points[i + 1]);
  context.strokeStyle = ACCENT;
  context.globalAlpha = 0.8;
  context.lineWidth = 2 / view.scale;
  context.setLineDash([8 / view.scale, 5 / view.scale]);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** Where the chain is told to go: the goal of moveto, else that of a goto that is not stopped. */
export function goalOf(store) {
  const motion = store.fields("motion/command"), path = list(store.fields("map/path")?.points_m);
  if (path.length >= 2) return path.slice(-2);
  if (!motion || motion.flags === NO_COMMAND) return null;
  return motion.flags === MOVETO || (motion.flags > 0 && motion.flags < 40 && motion.flags % 10 === GOTO) ? motion.position : null;
}

export function drawGoal(context, view, store) {
  const goal = goalOf(store), pose = poseOf(store);
  if (!goal) return;
  view.inPixels(context);
  const [x, y] = view.toScreen(...goal);
  context.strokeStyle = ACCENT;
  context.lineWidth = 2;
  if (pose && list(store.fields("map/path")?.points_m).length < 4) {
    context.globalAlpha = 0.45;
    context.setLineDash([2, 5]);
    context.beginPath();
    context.moveTo(...view.toScreen(pose[0], pose[1]));
    context.lineTo(x, y);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }
  target(context, x, y, 8);
}

export function drawChosen(context, view, { x, y }) {
  view.inPixels(context);
  context.strokeStyle = WARN;
  context.lineWidth = 2;
  target(context, ...view.toScreen(x, y), 12);
}

function target(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  for (const [dx, dy] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) {
    context.moveTo(x + dx * radius * 0.5, y + dy * radius * 0.5);
    context.lineTo(x + dx * radius * 1.5, y + dy * radius * 1.5);
  }
  context.stroke();
}

export function drawRectangle(context, view, store) {
  const fields = store.fields("motion/rectangle");
  if (!fields || !(fields.base_m > 0)) return;
  const { base_m: b, height_m: h, home } = fields;
  view.inMetres(context);
  context.setLineDash([10 / view.scale, 6 / view.scale]);
  context.strokeStyle = ACCENT_DIM;
  context.lineWidth = 1.5 / view.scale;
  context.stroke(outlineOf([[0, -b], [h, -b], [h, b], [0, b]].map(([x, y]) => placed(home, x, y))));
  context.setLineDash([]);
}
