// The bar at the top and the figures on the map, all with the age of what they show.

import { age, byId, clock, degrees, say, show } from "./dom.js";
import { missionReason, missionWords } from "./mission.js";

const FAST = new Set(["ATRV2/Drive/Raw"]), MOMENT_S = 0.3;
const PLACELESS = new Set(["lost", "no-pose", "gyro-stale", "speed-stale"]); // the position must not be believed
const SILENT_MS = 1200; // the answer to a ping comes each second, if nothing else does

export class Bar {
  constructor(store, robot, link) {
    Object.assign(this, { store, robot, link, clock_s: null, clock_ms: performance.now() });
    link?.on("clock", (time_s) => this.tick(time_s));
    store.on("*", ({ stamp_s }) => (this.clock_s === null || stamp_s > this.now_s) && this.tick(stamp_s));
    setInterval(() => this.refresh(), 200);
  }

  tick(time_s) {
    Object.assign(this, { clock_s: time_s, clock_ms: performance.now() });
  }

  /** The run's clock as well as it is known: it is not let run on without news. */
  get now_s() {
    return this.clock_s + (this.link?.isUp ? Math.min((performance.now() - this.clock_ms) / 1000, 1.5) : 0);
  }

  refresh() {
    if (document.hidden) return;
    const { store } = this;
    say(byId("clock"), this.clock_s === null ? "–" : clock(this.now_s));
    this.gauge("speed", "ATRV2/Drive/Raw", ({ velocity }) => `${zero(velocity[0].toFixed(2))} m/s`);
    const turn = store.fields("ATRV2/Drive/Raw")?.velocity[1];
    say(byId("turn"), turn === undefined || this.isOld("ATRV2/Drive/Raw") ? "" : `${zero((turn * 57.3).toFixed(0))} °/s`);
    this.gauge("battery", "ATRV2/Battery", ({ voltage_v }) => this.battery(voltage_v));
    const mission = store.fields("mission/state");
    say(byId("mission-chip"), mission ? missionWords(mission) : "–");
    say(byId("mission-reason"), mission ? missionReason(mission) : "");
    byId("gauge-mission").dataset.state = mission?.state ?? "";
    this.pose();
    if (this.link) this.linkState();
  }

  /** A figure of a topic in words, with its age if that is too high. */
  gauge(id, topic, words) {
    const fields = this.store.fields(topic), isOld = this.isOld(topic), text = fields ? words(fields) : "–";
    say(byId(id), isOld && fields ? `${text} · ${age(this.store.age_s(topic))} old` : text);
    byId(`gauge-${id}`).classList.toggle("old", isOld);
  }

  /** Stale; in a recording, where most topics are thinned, also what was true so long before the moment shown that it may not be true then. */
  isOld(topic) {
    const isFromBefore = this.link === null && FAST.has(topic) && this.store.age_s(topic) > MOMENT_S;
    return isFromBefore || this.store.isStale(topic);
  }

  battery(volts) {
    const [empty, full] = this.robot.battery_v;
    const share = Math.max(0, Math.min(1, (volts - empty) / (full - empty)));
    byId("gauge-battery").dataset.state = share < 0.15 ? "low" : "";
    return `${volts.toFixed(1)} V${share < 0.15 ? " low" : ""}`;
  }

  pose() {
    const pose = this.store.fields("Localization/Pose")?.pose, isOld = this.store.isStale("Localization/Pose");
    if (pose) {
      say(byId("pose-x"), pose[0].toFixed(2));
      say(byId("pose-y"), pose[1].toFixed(2));
      say(byId("pose-theta"), degrees(Math.atan2(Math.sin(pose[3]), Math.cos(pose[3]))));
    }
    const element = byId("pose-age");
    const doubt = this.store.fields("Localization/Check")?.reason ?? "";
    say(element, isOld ? (pose ? `${age(this.store.age_s("Localization/Pose"))} old` : "no pose yet") : PLACELESS.has(doubt) ? doubt : "");
    element.parentElement.classList.toggle("old", isOld);
  }

  linkState() {
    const { link } = this, element = byId("link");
    document.body.dataset.link = link.isUp ? "up" : "none";
    const isSilent = link.isUp && link.silent_ms > SILENT_MS, trip = link.roundTrip_ms === null ? "…" : `${Math.max(1, link.roundTrip_ms).toFixed(0)} ms`;
    say(element, !link.isUp ? "▲ no link" : isSilent ? `▲ silent ${age(link.silent_ms / 1000)}` : `● ${trip}`);
    byId("gauge-link").dataset.state = link.isUp && !isSilent ? "up" : "none";
    show(byId("no-link"), !link.isUp);
    if (!link.isUp) say(byId("no-link"), `No link for ${age((performance.now() - link.lost_ms) / 1000)}${link.farewell ? ` (${link.farewell})` : ""}. What you see is old.`);
  }
}

/** No "-0". */
const zero = (text) => (Number(text) === 0 ? text.replace("-", "") : text);
