// What stands still on the map: the grid of metres, the scanned map, walls, areas, goals, the scale.

import { AREAS, LABEL, MAJOR, MINOR, SOLID, WALL } from "./colours.js";

const FONT = "500 11px system-ui, sans-serif";
const AREA_FONT = "600 10px system-ui, sans-serif";
const HALF_LINE_PX = 6;
let hatching = null;

export function drawGrid(context, view) {
  view.inPixels(context);
  const step_m = view.scale >= 22 ? 1 : view.scale >= 5 ? 5 : 25;
  const [x0, y1] = view.toMap(0, 0), [x1, y0] = view.toMap(view.width, view.height);
  for (const [is_major, colour] of [[false, MINOR], [true, MAJOR]]) {
    context.beginPath();
    for (let i = Math.ceil(x0 / step_m); i * step_m <= x1; i++) {
      if ((i % 5 === 0) !== is_major) continue;
      const x = Math.round(view.toScreen(i * step_m, 0)[0]) + 0.5;
      context.moveTo(x, 0);
      context.lineTo(x, view.height);
    }
    for (let i = Math.ceil(y0 / step_m); i * step_m <= y1; i++) {
      if ((i % 5 === 0) !== is_major) continue;
      const y = Math.round(view.toScreen(0, i * step_m)[1]) + 0.5;
      context.moveTo(0, y);
      context.lineTo(view.width, y);
    }
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.stroke();
  }
}

export function drawPicture(context, view, picture, grid) {
  const [x, y, theta] = grid.origin;
  view.inMetres(context);
  context.translate(x, y);
  context.rotate(theta);
  context.scale(grid.cell_m, -grid.cell_m); // the picture's first row is the highest y
  context.imageSmoothingEnabled = view.scale * grid.cell_m < 1;
  context.drawImage(picture, 0, -grid.rows);
}

export function drawWorld(context, view, world, withNames) {
  const path = world.paths ??= pathsOf(world);
  view.inMetres(context);
  context.lineJoin = "round";
  for (const { area, path: outline } of path.areas) drawArea(context, view, area, outline);
  context.fillStyle = SOLID;
  context.fill(path.solids);
  context.strokeStyle = WALL;
  context.lineWidth = 2 / view.scale;
  context.stroke(path.solids);
  context.stroke(path.walls);
  context.setLineDash([4 / view.scale, 3 / view.scale]);
  context.stroke(path.holes);
  for (const line of world.lines) {
    context.strokeStyle = AREAS[line.kind] ?? WALL;
    context.stroke(outlineOf(line.points, false));
  }
  context.setLineDash([]);
  drawNames(context, view, world, withNames);
}

function drawArea(context, view, area, outline) {
  context.strokeStyle = AREAS[area.kind] ?? LABEL;
  if (area.kind === "forbidden") {
    context.save();
    context.clip(outline);
    view.inPixels(context);
    context.globalAlpha = 0.28;
    context.fillStyle = hatching ??= hatch(context, AREAS.forbidden);
    context.fillRect(0, 0, view.width, view.height);
    context.restore();
    view.inMetres(context);
  }
  context.lineWidth = 1.2 / view.scale;
  context.setLineDash([7 / view.scale, 5 / view.scale]);
  context.globalAlpha = 0.7;
  context.stroke(outline);
  context.globalAlpha = 1;
  context.setLineDash([]);
}

function hatch(context, colour) {
  const tile = document.createElement("canvas");
  tile.width = tile.height = 8;
  const lines = tile.getContext("2d");
  lines.strokeStyle = colour;
  lines.lineWidth = 1.5;
  lines.beginPath();
  for (const at of [-8, 0, 8]) {
    lines.moveTo(at, 8);
    lines.lineTo(at + 8, 0);
  }
  lines.stroke();
  return context.createPattern(tile, "repeat");
}

function drawNames(context, view, world, withNames) {
  view.inPixels(context);
  context.font = FONT;
  context.textBaseline = "middle";
  const { home } = world, isGoal = home && world.goals.some((goal) => Math.hypot(goal.x - home.x, goal.y - home.y) < 0.2);
  const places = [...world.goals.map((goal) => [goal, goal.id]), ...(home && !isGoal ? [[home, "home"]] : [])];
  const taken = [];
  for (const [place, name] of places) {
    const [x, y] = view.toScreen(place.x, place.y);
    context.strokeStyle = LABEL;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x + 5, y);
    context.lineTo(x, y + 5);
    context.lineTo(x - 5, y);
    context.closePath();
    context.stroke();
    if (place.theta !== null && place.theta !== undefined) {
      context.beginPath();
      context.moveTo(x + 5 * Math.cos(place.theta), y - 5 * Math.sin(place.theta));
      context.lineTo(x + 12 * Math.cos(place.theta), y - 12 * Math.sin(place.theta));
      context.stroke();
    }
    if (withNames) labelIfFree(context, taken, name, x + 10, y, LABEL);
  }
  if (!withNames) return;
  context.font = AREA_FONT;
  for (const area of world.areas) {
    const [px, py] = view.toScreen(...corner(area.points));
    labelIfFree(context, taken, area.id.toUpperCase(), px + 8, py + 13, AREAS[area.kind] ?? LABEL);
  }
}

/** A name, unless it would lie over one that was drawn before; nearer there is room for both. */
function labelIfFree(context, taken, text, x, y, colour) {
  const box = [x - 2, y - HALF_LINE_PX, x + context.measureText(text).width + 2, y + HALF_LINE_PX];
  if (taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) return;
  taken.push(box);
  label(context, text, x, y, colour);
}

function label(context, text, x, y, colour) {
  context.fillStyle = colour;
  context.fillText(String(text), x, y);
}

export function drawScale(context, view) {
  view.inPixels(context);
  const wanted_m = 90 / view.scale;
  const power = 10 ** Math.floor(Math.log10(wanted_m));
  const length_m = power * (wanted_m / power >= 5 ? 5 : wanted_m / power >= 2 ? 2 : 1);
  const x = 16, y = view.height - 18, far = length_m * view.scale;
  context.strokeStyle = LABEL;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - 4);
  context.lineTo(x, y);
  context.lineTo(x + far, y);
  context.lineTo(x + far, y - 4);
  context.stroke();
  context.font = FONT;
  context.textBaseline = "bottom";
  label(context, length_m >= 1 ? `${length_m} m` : `${Math.round(length_m * 100)} cm`, x + 5, y - 3, LABEL);
  if (view.cursor) {
    label(context, `${view.cursor[0].toFixed(2)}, ${view.cursor[1].toFixed(2)} m`, x + far + 14, y + 4, LABEL);
  }
}

export function outlineOf(points, isClosed = true) {
  const path = new Path2D();
  points.forEach(([x, y], i) => (i ? path.lineTo(x, y) : path.moveTo(x, y)));
  if (isClosed) path.closePath();
  return path;
}

function pathsOf(world) {
  const solids = new Path2D(), walls = new Path2D(), holes = new Path2D();
  for (const shape of world.shapes) {
    if (shape.kind === "circle") {
      const circle = new Path2D();
      circle.arc(...shape.points[0], shape.radius_m, 0, 2 * Math.PI);
      solids.addPath(circle);
    } else if (shape.kind === "wall") walls.addPath(outlineOf(shape.points, false));
    else (shape.kind === "hole" ? holes : solids).addPath(outlineOf(shape.points));
  }
  return { solids, walls, holes, areas: world.areas.map((area) => ({ area, path: outlineOf(area.points) })) };
}

/** The corner at the upper left, where a name does not cover what lies inside. */
function corner(points) {
  return points.reduce((best, point) => (point[1] - point[0] > best[1] - best[0] ? point : best));
}
