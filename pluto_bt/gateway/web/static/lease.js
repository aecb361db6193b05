// The lease: who may drive. Taken by a deliberate act, renewed while the page lives, given back or lost with the link.

import { byId, say, show, toast } from "./dom.js";

const TTL_S = 3, RENEW_MS = 700, LOOK_MS = 1000;

export class Lease {
  constructor(link) {
    Object.assign(this, { link, isMine: false, holder: "", listeners: [] });
    byId("lease-take").onclick = () => this.take().catch((error) => toast(error.message));
    byId("lease-give").onclick = () => this.give();
    link.on("up", () => this.look());
    link.on("down", () => this.set(false, ""));
    setInterval(() => this.isMine && this.renew(), RENEW_MS);
    setInterval(() => !this.isMine && this.look(), LOOK_MS);
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  set(isMine, holder) {
    const wasMine = this.isMine;
    Object.assign(this, { isMine, holder });
    const chip = byId("lease-chip");
    say(chip, isMine ? "yours" : holder || (this.link.isUp ? "free" : "–"));
    byId("gauge-lease").dataset.state = isMine ? "mine" : holder ? "held" : "free";
    say(byId("lease-take"), holder && !isMine ? "Take over" : "Take lease");
    show(byId("lease-take"), !isMine);
    show(byId("lease-give"), isMine);
    if (wasMine && !isMine && holder) toast(`${holder} took the lease`);
    if (wasMine !== isMine) for (const listener of this.listeners) listener(isMine);
  }

  heard({ mine, holder }) {
    this.set(mine === "true", holder);
  }

  /** Take a free lease; one that somebody holds only if `byForce`. */
  async acquire(byForce = false) {
    this.heard(await this.link.ask("lease", { op: byForce ? "take" : "acquire", ttl_s: TTL_S, on_loss: "stop" }));
  }

  take() {
    return this.acquire(Boolean(this.holder));
  }

  async give() {
    await this.link.ask("lease", { op: "release" }).then((state) => this.heard(state)).catch((error) => toast(error.message));
  }

  renew() {
    this.link.ask("lease", { op: "renew" }).then((state) => this.heard(state)).catch(() => this.look());
  }

  look() {
    if (this.link.isUp) this.link.ask("lease", { op: "query" }).then((state) => this.heard(state)).catch(() => {});
  }
}
