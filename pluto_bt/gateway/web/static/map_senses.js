// What the robot senses: laser, sonars, and what a job has seen and covered. What is too old to trust is drawn grey.

import { CELLS, ECHO, LASER, OLD, SEEN } from "./colours.js";
import { placed, poseWhen } from "./map_robot.js";
import { list } from "./wire.js";

const FARTHEST_M = 40; // of free ground that is drawn

export function drawLaser(context, view, store, robot) {
  const scan = store.get("sick/scan"), at = store.fields("Localization/Laser_Pose")?.pose;
  if (!scan || !at) return;
  const { angle_min, angle_step } = scan.fields, ranges = list(scan.fields.ranges);
  const [x, y, , theta, tilt] = at, isOld = store.isStale("sick/scan"); // theta holds the pan of the wrist already
  const seen = new Path2D(), points = [], level = Math.cos(tilt), c = Math.cos(theta), s = Math.sin(theta);
  seen.moveTo(x, y);
  ranges.forEach((range, i) => {
    if (!(range > 0)) return;
    const angle = angle_min + i * angle_step, far = Math.min(range, FARTHEST_M);
    const ahead = far * Math.cos(angle) * level, left = far * Math.sin(angle);
    const px = x + c * ahead - s * left, py = y + s * ahead + c * left;
    seen.lineTo(px, py);
    if (range < robot.laser_max_m - 0.01) points.push([px, py]);
  });
  view.inMetres(context);
  context.fillStyle = isOld ? "rgba(102, 114, 126, 0.05)" : SEEN;
  context.fill(seen);
  view.inPixels(context);
  context.fillStyle = isOld ? OLD : LASER;
  for (const [px, py] of points) {
    const [sx, sy] = view.toScreen(px, py);
    context.fillRect(sx - 1, sy - 1, 2, 2);
  }
}

export function drawSonar(context, view, store, robot) {
  const value = store.get("ATRV2/Sonar"), ranges = list(value?.fields.ranges_m), pose = value ? poseWhen(store, value) : null;
  if (!pose) return;
  view.inMetres(context);
  context.strokeStyle = store.isStale("ATRV2/Sonar") ? OLD : ECHO;
  context.lineWidth = 2.5 / view.scale;
  robot.sonars.forEach(([x, y, theta], i) => {
    const range = ranges[i];
    if (!(range >= 0) || range >= robot.sonar_max_m - 0.01) return;
    const [px, py] = placed(pose, x, y), angle = pose[2] + theta;
    context.beginPath();
    context.arc(px, py, Math.max(range, 0.02), angle - robot.sonar_cone_rad / 2, angle + robot.sonar_cone_rad / 2);
    context.stroke();
  });
}

/** What a job has seen and covered; its frame is dead reckoning, so it is placed by the two poses of now. */
export function drawCells(context, view, store) {
  const value = store.get("map/local"), map = store.fields("Localization/Pose")?.pose, own = store.fields("Localization/Dead-Reckoning")?.pose;
  if (!value || !map || !own || !value.fields.rows || store.fields("motion/job")?.state !== "running") return;
  const { rows, columns, x_m, y_m, cell_m } = value.fields;
  value.picture ??= cellPicture(value.fields);
  const turn = map[3] - own[3];
  view.inMetres(context);
  context.translate(map[0], map[1]);
  context.rotate(turn);
  context.translate(x_m - own[0], y_m - own[1]);
  context.transform(0, cell_m, cell_m, 0, 0, 0); // the picture's x are columns (y of the map), its y are rows (x)
  context.imageSmoothingEnabled = false;
  context.drawImage(value.picture, 0, 0, columns, rows);
}

function cellPicture({ cells, rows, columns }) {
  const bytes = Uint8Array.from(atob(cells), (letter) => letter.charCodeAt(0));
  const canvas = document.createElement("canvas");
  canvas.width = columns;
  canvas.height = rows;
  const context = canvas.getContext("2d"), image = context.createImageData(columns, rows);
  bytes.forEach((cell, i) => image.data.set(CELLS[cell] ?? CELLS[0], 4 * i));
  context.putImageData(image, 0, 0);
  return canvas;
}
