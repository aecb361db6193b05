// STOP: heard from anyone at any time. What the button says is what is known: sent, zero commanded, standing.

import { byId, say, show, toast } from "./dom.js";

const STANDS_MPS = 0.01, STANDS_RADPS = 0.01, TOLD_MS = 6000;
const AT_REST = matchMedia("(pointer: coarse)").matches ? "for anyone, at any time" : "space bar";

export class Halt {
  constructor(link, store, lease) {
    Object.assign(this, { link, store, lease, begun_ms: null, phase: "" });
    byId("stop").onclick = () => this.stop();
    byId("estop").onclick = () => this.estop();
    byId("release").onclick = () => this.release();
    store.on("ATRV2/Drive/Command", () => this.look());
    store.on("ATRV2/Drive/Raw", () => this.look());
    link.on("up", () => this.tell(""));
    link.on("down", () => this.tell("no link: use the robot's own switch", "bad"));
    link.on("event", ({ code }) => { if (code === "estop" || code === "estop-released") this.held(code === "estop"); });
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
  }

  /** The space bar, wherever one is; only where text is typed it is a space. */
  key(event) {
    if (event.code !== "Space" || isTyping(event.target)) return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) this.stop();
  }

  stop() {
    this.order("stop", {});
  }

  estop() {
    this.order("estop", { reason: "console" });
  }

  async order(tag, given) {
    this.begun_ms = performance.now();
    this.phase = "sent";
    this.tell("sent …", "busy");
    try {
      await this.link.ask(tag, given);
    } catch (error) {
      this.phase = "";
      this.tell(error.message, "bad");
      return;
    }
    this.phase = "obeyed";
    this.look();
  }

  /** The newest command that the base took, and what its wheels do. */
  look() {
    if (this.phase === "obeyed" && isZero(this.store.fields("ATRV2/Drive/Command")?.velocity ?? [0, 0], 0, 0)) {
      this.phase = "zero";
      byId("stop").dataset.zeroMs = String(Math.round(performance.now() - this.begun_ms));
      this.tell(`zero commanded in ${byId("stop").dataset.zeroMs} ms`, "good");
    }
    if (this.phase === "zero" && isZero(this.store.fields("ATRV2/Drive/Raw")?.velocity ?? [1, 1], STANDS_MPS, STANDS_RADPS)) {
      this.phase = "";
      this.tell(`standing · zero in ${byId("stop").dataset.zeroMs} ms`, "good");
      clearTimeout(this.timer);
      this.timer = setTimeout(() => !this.phase && this.link.isUp && this.tell(""), TOLD_MS);
    }
  }

  tell(text, mood = "") {
    say(byId("stop-note"), text || AT_REST);
    byId("stop").dataset.mood = mood;
  }

  held(isHeld) {
    show(byId("estop"), !isHeld);
    show(byId("release"), isHeld);
    show(byId("estop-note"), isHeld);
    say(byId("estop-note"), "Emergency stop is latched. Nothing moves until the holder of the lease releases it.");
  }

  async release() {
    try {
      if (!this.lease.isMine) await this.lease.acquire();
      await this.link.ask("release", { what: "estop" });
      this.held(false);
      toast("Released. Nothing moves until it is commanded.", true);
    } catch (error) {
      toast(error.message);
    }
  }
}

const isZero = (velocity, speed, turn) => Math.abs(velocity[0]) <= speed && Math.abs(velocity[1]) <= turn;

export function isTyping(target) {
  return target instanceof HTMLElement && (target.isContentEditable || target.tagName === "TEXTAREA"
    || (target.tagName === "INPUT" && !["range", "checkbox", "button"].includes(target.type)));
}
