// STOP: heard from anyone at any time. What the button says is what is known: sent, heard, zero commanded, standing; and it is taken back
// as soon as it is no longer true.

import { askOnce } from "./doorbell.js";
import { byId, say, show, toast } from "./dom.js";

const STANDS_MPS = 0.01, STANDS_RADPS = 0.01, MOVES_MPS = 0.03, MOVES_RADPS = 0.05, TOLD_MS = 6000;
const AT_REST = matchMedia("(pointer: coarse)").matches ? "for anyone, at any time" : "space bar";

export class Halt {
  /** From the first moment on: a stop needs no token, no scenery and no link that stands. */
  constructor() {
    Object.assign(this, { link: null, store: null, lease: null, why: null, begun_ms: null, phase: "" });
    byId("stop").onclick = () => this.stop();
    byId("estop").onclick = () => this.estop();
    byId("release").onclick = () => this.release();
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    this.tell("");
  }

  /** From here on the link carries the orders, and what it brings is told. That the robot is latched is known from the answer to `why`. */
  join(link, store, lease, why) {
    Object.assign(this, { link, store, lease, why });
    why.isLatched = (isHeld) => this.held(isHeld);
    store.on("ATRV2/Drive/Command", () => this.look());
    store.on("ATRV2/Drive/Raw", () => this.look());
    link.on("up", () => this.takeBack());
    link.on("down", () => {
      this.phase = "";
      this.tell("no link: use the robot's own switch", "bad");
    });
    link.on("event", ({ code }) => { if (code === "estop" || code === "estop-released") why.look(); });
  }

  /** The space bar, wherever one is; only where text is typed it is a space, and in a recording it plays. */
  key(event) {
    if (event.code !== "Space" || isTyping(event.target) || document.body.dataset.mode === "box") return;
    event.preventDefault();
    event.stopPropagation();
    if (!event.repeat) this.stop();
  }

  stop() {
    this.order("stop", {});
  }

  estop() {
    this.order("estop", { reason: `${this.link?.name ?? "somebody at the console"} pressed E-STOP` });
  }

  async order(tag, given) {
    this.begun_ms = performance.now();
    this.phase = "sent";
    this.tell("sent …", "busy");
    try {
      await (this.link?.isUp ? this.link.ask(tag, given) : askOnce(tag, given));
    } catch (error) {
      this.phase = "";
      this.tell(error.message, "bad");
      return;
    }
    this.reached("heard", "sent, and heard", "busy");
    if (this.store) this.look();
  }

  /** The newest command that the base took, and what its wheels do; what is not known is not said. */
  look() {
    const commanded = this.store.fields("ATRV2/Drive/Command")?.velocity;
    const driven = this.store.isStale("ATRV2/Drive/Raw") ? undefined : this.store.fields("ATRV2/Drive/Raw").velocity;
    if (this.phase === "heard" && isZero(commanded, 0, 0)) {
      byId("stop").dataset.zeroMs = String(Math.round(performance.now() - this.begun_ms));
      this.reached("zero", `zero commanded in ${byId("stop").dataset.zeroMs} ms`);
    } else if (["zero", "standing"].includes(this.phase) && !isZero(commanded, 0, 0)) this.takeBack();
    if (this.phase === "zero" && isZero(driven, STANDS_MPS, STANDS_RADPS)) {
      this.reached("standing", `standing · zero in ${byId("stop").dataset.zeroMs} ms`);
    } else if (this.phase === "standing" && !isZero(driven, MOVES_MPS, MOVES_RADPS)) this.takeBack();
  }

  /** So far the order has come; told for a while. */
  reached(phase, text, mood = "good") {
    this.phase = phase;
    this.tell(text, mood);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.phase === phase && this.takeBack(), TOLD_MS);
  }

  takeBack() {
    this.phase = "";
    this.tell("");
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
      this.why.look();
      toast("Released. Nothing moves until it is commanded.", true);
    } catch (error) {
      toast(error.message);
    }
  }
}

/** False for a velocity that is not known. */
const isZero = (velocity, speed, turn) => velocity !== undefined && Math.abs(velocity[0]) <= speed && Math.abs(velocity[1]) <= turn;

export function isTyping(target) {
  return target instanceof HTMLElement && (target.isContentEditable || target.tagName === "TEXTAREA"
    || (target.tagName === "INPUT" && !["range", "checkbox", "button"].includes(target.type)));
}
