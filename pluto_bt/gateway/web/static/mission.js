// The mission: what it does, and another one in its place.

import { byId, make, say, toast } from "./dom.js";
import { InputForm, inputsOf } from "./inputs.js";

const ASKED_MS = 6000; // so long a button waits for the click that confirms
const MISSION_SIGNS = { idle: "○", running: "▶", paused: "❚❚", stopping: "■", succeeded: "✓", failed: "✕", aborted: "■" };
const ON = ["running", "paused", "stopping"];

export function missionWords({ state }) {
  return `${MISSION_SIGNS[state] ?? "?"} ${state}`;
}

export function missionReason({ state, reason }) {
  return reason && state !== "running" ? ` · ${reason}` : "";
}

export class Mission {
  constructor(link, store, lease) {
    Object.assign(this, { link, store, lease });
    store.on("mission/state", ({ fields }) => this.take(fields));
    for (const button of byId("mission-ops").children) button.onclick = () => this.order({ op: button.dataset.op });
    this.form = new InputForm(() => this.ready());
    byId("mission-start").onclick = () => this.begin(byId("mission-choice").value);
    byId("mission-choice").onchange = () => this.choose();
    link.on("up", () => this.list());
  }

  take(fields) {
    say(byId("mission-state"), missionWords(fields) + missionReason(fields));
    say(byId("mission-step"), [fields.name, fields.step].filter(Boolean).join(" · "));
    const can = { pause: fields.state === "running", resume: fields.state === "paused", abort: ON.includes(fields.state) };
    for (const button of byId("mission-ops").children) button.disabled = !can[button.dataset.op];
  }

  async list() {
    const { rows } = await this.link.ask("mission", { op: "list" }).catch(() => ({ rows: [] }));
    const choice = byId("mission-choice"), before = choice.value;
    choice.replaceChildren(make("option", { value: "" }, "Choose a mission …"), ...rows.map(({ name }) => make("option", { value: name }, name)));
    if (rows.some(({ name }) => name === before)) choice.value = before;
    else await this.choose();
  }

  /** A mission was chosen: ask for what it wants to be given. */
  async choose() {
    const name = byId("mission-choice").value;
    this.ask("");
    byId("mission-faults").replaceChildren();
    this.form.show([]);
    if (!name) return;
    const { rows } = await this.link.ask("mission", { op: "fetch", name }).catch(() => ({ rows: [] }));
    const document = rows.find(({ tag }) => tag === "document");
    if (document && byId("mission-choice").value === name) this.form.show(inputsOf(document.text));
  }

  ready() {
    const { missing } = this.form;
    byId("mission-start").disabled = !byId("mission-choice").value || missing.length > 0;
    say(byId("mission-note"), missing.length ? `${missing.join(" and ")} must be given` : "");
  }

  /** A mission that goes on needs no lease; one that is still held would stop it when this page is closed. */
  async order(given) {
    try {
      await this.link.ask("mission", given);
      if (this.lease.isMine && ["start", "resume"].includes(given.op)) await this.lease.give();
      return true;
    } catch (error) {
      toast(error.message);
      return false;
    }
  }

  /** One that goes on is replaced only by a second click. */
  begin(name) {
    const { state, name: running } = this.store.fields("mission/state") ?? {};
    if (ON.includes(state) && this.asked !== name) this.ask(name, `End ${running}, start ${name}`);
    else {
      this.ask("");
      this.start(name);
    }
  }

  ask(name, words = "Load and start") {
    this.asked = name;
    say(byId("mission-start"), words);
    byId("mission-start").classList.toggle("danger", Boolean(name));
    clearTimeout(this.asking);
    if (name) this.asking = setTimeout(() => this.ask(""), ASKED_MS);
  }

  async start(name) {
    byId("mission-faults").replaceChildren();
    try {
      await this.link.ask("mission", { op: "load", name }, this.form.given);
    } catch (error) {
      byId("mission-faults").replaceChildren(...error.lines.flatMap((text) => text.split("\n")).filter((line) => line.trim()).map((line) => make("li", {}, line)));
      return;
    }
    const isRunning = this.store.fields("mission/state")?.state === "running";
    if (!isRunning || await this.order({ op: "pause" })) await this.order({ op: "start" });
  }
}
