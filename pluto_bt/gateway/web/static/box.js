// A black box instead of a robot: the same page asks what was true at a time, and the slider says at which.

import { byId, clock, make, say, show } from "./dom.js";
import { attributes, elements, value } from "./wire.js";

const STEP_MS = 100, STEP_S = 0.1;

export class Box {
  constructor(store, { start_s, end_s, track, marks }) {
    Object.assign(this, { store, start_s, end_s, at_s: start_s, isPlaying: false, isAsking: false, isUp: true, listeners: new Map(), wanted_s: start_s });
    Object.assign(store, { frozen_s: start_s, track });
    this.showMarks(marks);
    const slider = byId("time");
    Object.assign(slider, { min: start_s, max: end_s, step: 0.05, value: start_s });
    slider.oninput = () => this.seek(Number(slider.value));
    byId("play").onclick = () => this.play(!this.isPlaying);
    byId("back").onclick = () => this.seek(this.at_s - STEP_S);
    byId("forth").onclick = () => this.seek(this.at_s + STEP_S);
    window.addEventListener("keydown", (event) => this.key(event));
    setInterval(() => this.step(), STEP_MS);
  }

  on(tag, listener) {
    if (!this.listeners.has(tag)) this.listeners.set(tag, []);
    this.listeners.get(tag).push(listener);
  }

  tell(tag, message) {
    for (const listener of this.listeners.get(tag) ?? []) listener(message);
  }

  /** Warnings and errors above the slider; a click leads there. */
  showMarks(marks) {
    byId("marks").replaceChildren(...marks.map(([t_s, level, text]) => {
      const mark = make("button", { type: "button", title: `${clock(t_s)} ${text}`, "data-level": level, "aria-label": `${level} at ${clock(t_s)}: ${text}` });
      mark.style.left = `${100 * (t_s - this.start_s) / Math.max(this.end_s - this.start_s, 1e-9)}%`;
      mark.onclick = () => this.seek(t_s);
      return mark;
    }));
  }

  key(event) {
    const tag = event.target.tagName;
    if (tag === "SELECT" || (tag === "INPUT" && event.target.type === "search") || event.target.getAttribute?.("role") === "tab") return;
    if (event.code === "Space") this.play(!this.isPlaying);
    else if (event.key === "ArrowLeft") this.seek(this.at_s - STEP_S * (event.shiftKey ? 10 : 1));
    else if (event.key === "ArrowRight") this.seek(this.at_s + STEP_S * (event.shiftKey ? 10 : 1));
    else if (event.key === "Home") this.seek(this.start_s);
    else if (event.key === "End") this.seek(this.end_s);
    else return;
    event.preventDefault();
  }

  play(isPlaying) {
    if (isPlaying && this.at_s >= this.end_s) this.seek(this.start_s);
    this.isPlaying = isPlaying;
    this.played_ms = performance.now();
    say(byId("play"), isPlaying ? "❚❚" : "▶");
    byId("play").setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }

  step() {
    if (!this.isPlaying) return;
    const now_ms = performance.now();
    const to_s = this.wanted_s + (now_ms - this.played_ms) / 1000 * Number(byId("pace").value);
    this.played_ms = now_ms;
    this.seek(to_s);
    if (to_s >= this.end_s) this.play(false);
  }

  /** Show this time; while an answer is awaited only the newest wish is kept. */
  async seek(to_s) {
    this.wanted_s = Math.min(this.end_s, Math.max(this.start_s, to_s));
    byId("time").value = String(this.wanted_s);
    say(byId("time-shown"), `${clock(this.wanted_s)} of ${clock(this.end_s)}`);
    if (this.isAsking) return;
    this.isAsking = true;
    try {
      while (this.at_s !== this.wanted_s || !this.isShown) {
        const at_s = this.wanted_s;
        const answer = await fetch(`/moment?at=${at_s.toFixed(3)}`);
        if (!answer.ok) throw new Error(await answer.text());
        this.show(await answer.text());
        this.at_s = at_s;
        this.isShown = true;
      }
      show(byId("no-link"), false);
    } catch {
      this.play(false);
      show(byId("no-link"), true);
      say(byId("no-link"), "The recording is not served any more.");
    } finally {
      this.isAsking = false;
    }
  }

  show(text) {
    const before = new Set(this.store.values.keys()), events = [];
    this.tell("moment");
    for (const element of elements(text)) {
      if (element.tagName === "value") {
        const one = value(element);
        before.delete(one.topic);
        this.store.put(one);
      } else if (element.tagName === "event") events.push(attributes(element));
      else this.tell(element.tagName, { ...attributes(element), rows: [...element.children].map(attributes) });
    }
    for (const topic of before) this.store.drop(topic);
    this.tell("events", events);
  }
}
