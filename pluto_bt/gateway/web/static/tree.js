// The live tree: one row a node, with a sign and a word for its status. Small trees stand open; large ones open where something runs.

import { age, byId, make, say } from "./dom.js";

const SIGNS = { IDLE: ["·", "idle"], RUNNING: ["▶", "running"], SUCCESS: ["✓", "success"], FAILURE: ["✕", "failure"], SKIPPED: ["↷", "skipped"] };
const PAUSED = ["‖", "paused"], SAME_TICK_S = 0.05;
const SMALL = 120, MOST_ROWS = 1500;

export class Tree {
  constructor(store) {
    Object.assign(this, { store, rows: [], shape: "", opened: new Map(), all: false, now_s: 0 });
    store.on("tree", (value) => this.take(value));
    store.on("mission/state", () => this.nodes && !byId("panel-tree").hidden && this.refresh());
    setInterval(() => this.nodes && !byId("panel-tree").hidden && !document.hidden && this.refresh(), 500);
    byId("tree-all").onclick = () => {
      this.all = !this.all;
      this.opened.clear();
      say(byId("tree-all"), this.all ? "Follow what runs" : "Expand all");
      this.build();
    };
  }

  take({ fields, stamp_s }) {
    const nodes = fields.nodes ?? [];
    this.now_s = stamp_s;
    const shape = nodes.map(({ path, kind, name }) => `${path} ${kind} ${name}`).join("\n"); // an errand has the paths of a mission
    this.nodes = nodes;
    if (byId("panel-tree").hidden) {
      this.shape = "";
      return;
    }
    if (shape !== this.shape || (nodes.length > SMALL && this.runningPaths() !== this.running)) {
      this.shape = shape;
      this.build();
    } else this.refresh();
    say(byId("tree-head"), nodes.length ? `${nodes[0].name} · ${nodes.length} node${nodes.length > 1 ? "s" : ""} · tick ${fields.tick}` : "No tree");
  }

  /** The panel has come into view. */
  woken() {
    this.build();
  }

  runningPaths() {
    return this.nodes.filter((node) => node.status === "RUNNING").map((node) => node.path).join("\n");
  }

  isOpen(i, onWay) {
    const { path } = this.nodes[i];
    return this.opened.get(path) ?? (this.all || this.nodes.length <= SMALL || onWay.has(i));
  }

  /** Numbers of the nodes that run or hold one that does. */
  onWay() {
    const found = new Set(), parents = [];
    this.nodes.forEach((node, i) => {
      parents.length = Number(node.depth) - 1;
      if (node.status === "RUNNING") for (const parent of [...parents, i]) if (parent !== undefined) found.add(parent);
      parents.push(i);
    });
    return found;
  }

  build() {
    if (!this.nodes) return;
    this.running = this.runningPaths();
    const onWay = this.onWay(), list = byId("tree"), rows = [];
    let closedAt = Infinity;
    this.nodes.forEach((node, i) => {
      const depth = Number(node.depth);
      if (depth > closedAt || rows.length >= MOST_ROWS) return;
      closedAt = Infinity;
      const isParent = i + 1 < this.nodes.length && Number(this.nodes[i + 1].depth) > depth, isOpen = this.isOpen(i, onWay);
      if (isParent && !isOpen) closedAt = depth;
      rows.push(this.row(node, i, depth, isParent, isOpen));
    });
    this.rows = rows;
    list.replaceChildren(...rows.map((row) => row.element));
    this.refresh();
  }

  row(node, i, depth, isParent, isOpen) {
    const sign = make("span", { class: "sign", "aria-hidden": "true" }), word = make("span", { class: "status" }), words = make("span", { class: "words" });
    const since = make("span", { class: "since" });
    const fold = make("button", { type: "button", class: "fold", "aria-label": "Children", "aria-expanded": String(isOpen), disabled: !isParent }, isOpen ? "▾" : "▸");
    fold.onclick = () => {
      this.opened.set(node.path, !isOpen);
      this.build();
    };
    const title = node.name && node.name !== node.kind ? [make("b", {}, node.name), " ", make("span", { class: "kind" }, node.kind)] : [make("b", {}, node.kind)];
    const element = make("li", {}, fold, sign, make("span", { class: "title" }, ...title, words), word, since);
    element.style.setProperty("--depth", String(Math.min(depth - 1, 14)));
    return { element, sign, word, words, since, i, seen: "" };
  }

  /** The run's time; a recording stands still. */
  time_s() {
    return this.clock?.() ?? this.now_s;
  }

  /** The mission is paused and no errand has come since: its nodes wait, and run no more. */
  isPaused() {
    const mission = this.store.get("mission/state");
    return mission?.fields.state === "paused" && (this.store.get("tree")?.stamp_s ?? 0) <= mission.stamp_s + SAME_TICK_S;
  }

  refresh() {
    const now_s = this.time_s(), isPaused = this.isPaused();
    byId("tree").classList.toggle("paused", isPaused);
    for (const row of this.rows) {
      const node = this.nodes[row.i];
      const [sign, word] = isPaused && node.status === "RUNNING" ? PAUSED : SIGNS[node.status] ?? ["?", node.status.toLowerCase()];
      if (row.seen !== node.status + word) {
        row.seen = node.status + word;
        row.element.dataset.status = node.status;
        say(row.sign, sign);
        say(row.word, word);
      }
      say(row.words, node.feedback);
      say(row.since, node.status === "IDLE" ? "" : age(Math.max(0, now_s - Number(node.since_s))));
    }
  }
}
