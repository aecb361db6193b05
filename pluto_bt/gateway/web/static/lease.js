// The lease: who may drive. Taken by a deliberate act, renewed while the page lives, given back or lost with the link.

import { byId, say, show, toast } from "./dom.js";

const TTL_S = 3, TTL_DRIVING_S = 1; // so long the robot goes on when the page is gone
const BEAT_MS = 250, LOOK_MS = 1000;

export class Lease {
  constructor(link) {
    Object.assign(this, { link, isMine: false, holder: "", listeners: [], ttl_s: TTL_S, renewed_ms: 0 });
    byId("lease-take").onclick = () => this.take().catch((error) => toast(error.message));
    byId("lease-give").onclick = () => this.give();
    link.on("up", () => this.look());
    link.on("down", () => this.set(false, ""));
    setInterval(() => this.isMine && performance.now() - this.renewed_ms >= this.ttl_s * BEAT_MS - 10 && this.renew(), BEAT_MS);
    setInterval(() => !this.isMine && this.look(), LOOK_MS);
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  set(isMine, holder) {
    const wasMine = this.isMine, isNews = wasMine !== isMine || this.holder !== holder;
    Object.assign(this, { isMine, holder });
    const chip = byId("lease-chip");
    say(chip, isMine ? "yours" : holder || (this.link.isUp ? "free" : "–"));
    say(byId("lease-who"), isMine ? "yours" : holder);
    byId("gauge-lease").dataset.state = isMine ? "mine" : holder ? "held" : "free";
    say(byId("lease-take"), holder && !isMine ? "Take over" : "Take lease");
    show(byId("lease-take"), !isMine);
    show(byId("lease-give"), isMine);
    if (wasMine && !isMine && holder) toast(`${holder} took the lease`);
    if (isNews) for (const listener of this.listeners) listener(isMine);
  }

  heard({ mine, holder }) {
    this.set(mine === "true", holder);
  }

  /** Take a free lease; one that somebody holds only if `byForce`. */
  async acquire(byForce = false) {
    this.renewed_ms = performance.now();
    this.heard(await this.link.ask("lease", { op: byForce ? "take" : "acquire", ttl_s: this.ttl_s, on_loss: "stop" }));
  }

  /** While somebody drives by hand the robot does not wait long for a page that is gone. */
  tighten(isDriving) {
    this.ttl_s = isDriving ? TTL_DRIVING_S : TTL_S;
    return this.isMine ? this.acquire() : Promise.resolve();
  }

  take() {
    return this.acquire(Boolean(this.holder));
  }

  async give() {
    await this.link.ask("lease", { op: "release" }).then((state) => this.heard(state)).catch((error) => toast(error.message));
  }

  renew() {
    this.renewed_ms = performance.now();
    this.link.ask("lease", { op: "renew" }).then((state) => this.heard(state)).catch(() => this.look());
  }

  look() {
    if (this.link.isUp) this.link.ask("lease", { op: "query" }).then((state) => this.heard(state)).catch(() => {});
  }
}
