// Why the robot is, or is not, moving: the verdict, the first cause and what would help, then the way up to the mission.

import { age, byId, make, say } from "./dom.js";

const EVERY_MS = 500, OLD_MS = 2000; // an answer so old is none
const STILL = 0.005; // m/s and rad/s: below, the robot stands

export class Why {
  /** Without a link (a recording) it only shows what it is given. */
  constructor(link) {
    Object.assign(this, { link, seen: "", moves: null, isAsking: false, isLatched: () => {} });
    if (!link) return;
    this.told_ms = performance.now();
    setInterval(() => this.turn(), EVERY_MS);
    link.on("up", () => this.look());
    link.on("down", () => this.unknown("Without a link nobody here knows what the robot does."));
  }

  turn() {
    if (!this.link.isUp || document.hidden) {
      this.told_ms = performance.now();
      return;
    }
    const old_ms = performance.now() - this.told_ms;
    if (old_ms > OLD_MS) this.unknown(`The robot has not answered for ${age(old_ms / 1000)}.`);
    this.look();
  }

  look() {
    this.isAsking = true;
    this.link.ask("why").then((answer) => {
      this.told_ms = performance.now();
      this.isLatched(answer.rows.some(({ layer, code }) => layer === "operator" && code === "estop"));
      this.show(answer.moving === "true", answer.rows, this.now_s ?? 0);
    }).catch(() => {}).finally(() => { this.isAsking = false; });
  }

  /** The wheels tell sooner than the next turn whether the verdict still holds. */
  watch(store) {
    store.on("ATRV2/Drive/Raw", ({ fields: { velocity } }) => {
      const moves = velocity.some((share) => Math.abs(share) > STILL);
      if (this.link.isUp && !this.isAsking && !document.hidden && moves !== this.moves) this.look();
    });
  }

  unknown(text) {
    byId("verdict").dataset.state = "unknown";
    say(byId("verdict"), "Unknown");
    byId("causes").replaceChildren(make("li", {}, text));
    Object.assign(this, { seen: "", moves: null });
  }

  show(isMoving, causes, now_s) {
    this.moves = isMoving;
    byId("verdict").dataset.state = isMoving ? "moving" : "standing";
    say(byId("verdict"), isMoving ? "Moving" : "Standing");
    const seen = JSON.stringify(causes.map(({ layer, code, text, unblock }) => [layer, code, text, unblock]));
    const list = byId("causes");
    if (seen !== this.seen) {
      this.seen = seen;
      list.replaceChildren(...(causes.length ? causes.map(cause) : [make("li", {}, isMoving ? "Nothing hinders it." : "Nothing hinders it, and nobody tells it to move.")]));
    }
    if (causes.length) causes.forEach((one, i) => say(list.children[i].querySelector(".since"), `for ${age(Math.max(0, now_s - Number(one.since)))}`));
  }
}

function cause({ layer, code, text, unblock }, i) {
  const parts = [make("span", { class: "layer" }, layer), make("b", {}, text || code), make("span", { class: "since" })];
  if (unblock && i === 0) parts.push(make("span", { class: "unblock" }, unblock));
  return make("li", {}, ...parts);
}
