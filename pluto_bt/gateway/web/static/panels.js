// The smaller panels: tabs, mission, events, modules, signals.

import { age, byId, clock, make, say, show, toast } from "./dom.js";

const EVENTS_KEPT = 300;
const ASKED_MS = 6000; // so long a button waits for the click that confirms
const LEVELS = { info: ["·", "info"], warning: ["▲", "warning"], error: ["✕", "error"] };
const MISSION_SIGNS = { idle: "○", running: "▶", paused: "❚❚", stopping: "■", succeeded: "✓", failed: "✕", aborted: "■" };

export class Tabs {
  constructor() {
    this.tabs = [...document.querySelectorAll("[role=tab]")];
    this.listeners = new Map();
    this.tabs.forEach((tab) => {
      tab.onclick = () => this.open(tab);
      tab.onkeydown = (event) => this.key(event, tab);
    });
    this.open(this.tabs[0]);
  }

  onOpen(name, listener) {
    this.listeners.set(name, listener);
  }

  open(tab) {
    for (const one of this.tabs) {
      one.setAttribute("aria-selected", String(one === tab));
      one.tabIndex = one === tab ? 0 : -1;
      show(byId(one.getAttribute("aria-controls")), one === tab);
    }
    document.body.dataset.tab = tab.id.replace("tab-", "");
    document.querySelector(".panels").scrollTop = 0;
    this.listeners.get(tab.id.replace("tab-", ""))?.();
  }

  key(event, tab) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.stopPropagation();
    const seen = this.tabs.filter((one) => one.offsetParent !== null);
    const next = seen[(seen.indexOf(tab) + step + seen.length) % seen.length];
    this.open(next);
    next.focus();
  }
}

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
    byId("mission-start").onclick = () => this.begin(byId("mission-choice").value);
    byId("mission-choice").onchange = () => this.ask("");
    link.on("up", () => this.list());
  }

  take(fields) {
    say(byId("mission-state"), missionWords(fields) + missionReason(fields));
    say(byId("mission-step"), [fields.name, fields.step].filter(Boolean).join(" · "));
    const can = { pause: fields.state === "running", resume: fields.state === "paused", abort: ["running", "paused", "stopping"].includes(fields.state) };
    for (const button of byId("mission-ops").children) button.disabled = !can[button.dataset.op];
  }

  async list() {
    const { rows } = await this.link.ask("mission", { op: "list" }).catch(() => ({ rows: [] }));
    byId("mission-choice").replaceChildren(...rows.map(({ name }) => make("option", { value: name }, name)));
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
    if (["running", "paused", "stopping"].includes(state) && this.asked !== name) this.ask(name, `End ${running}, start ${name}`);
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
      await this.link.ask("mission", { op: "load", name });
    } catch (error) {
      byId("mission-faults").replaceChildren(...error.lines.flatMap((text) => text.split("\n")).filter((line) => line.trim()).map((line) => make("li", {}, line)));
      return;
    }
    const isRunning = this.store.fields("mission/state")?.state === "running";
    if (!isRunning || await this.order({ op: "pause" })) await this.order({ op: "start" });
  }
}

export class Events {
  constructor() {
    Object.assign(this, { seen: new Set(), unread: 0 });
  }

  add({ level, code, source, text, seq, time }) {
    if (seq && this.seen.has(Number(seq))) return;
    this.seen.add(Number(seq));
    const list = byId("events"), [sign, word] = LEVELS[level] ?? ["·", level];
    const line = make("li", { "data-level": level, title: code }, make("time", {}, clock(Number(time))), make("span", { class: "sign", role: "img", "aria-label": word }, sign),
      make("span", { class: "source" }, source), make("span", { class: "text" }, text));
    line.seq = Number(seq);
    list.insertBefore(line, [...list.children].find((one) => one.seq < line.seq) ?? null); // the log of before comes after the first live ones
    while (list.children.length > EVENTS_KEPT) list.lastChild.remove();
    if (level !== "info" && byId("panel-events").hidden) this.count(this.unread + 1);
  }

  count(number) {
    this.unread = number;
    say(byId("events-count"), String(number));
    show(byId("events-count"), number > 0);
  }

  /** Show these, and no others. */
  replace(events) {
    const last = events.map(({ seq }) => seq).join();
    if (last === this.last) return;
    this.last = last;
    this.seen.clear();
    byId("events").replaceChildren();
    for (const event of events) this.add(event);
    this.count(0);
  }
}

export class Modules {
  constructor(link, store) {
    Object.assign(this, { link, store, rows: new Map() });
    store.on("modules", () => this.look());
  }

  /** Show what is known, if anybody looks. */
  look() {
    if (byId("panel-modules").hidden) return;
    for (const module of this.store.fields("modules")?.modules ?? []) {
      const row = this.rows.get(module.name) ?? this.add(module.name);
      row.element.dataset.state = module.state;
      say(row.state, `${module.state === "running" ? "●" : module.state === "stopped" ? "○" : "✕"} ${module.state}`);
      say(row.note, [module.text, Number(module.failures) ? `${module.failures} failures` : "", Number(module.overruns) ? `${module.overruns} overruns` : ""].filter(Boolean).join(" · "));
      say(row.steps, module.steps);
      say(row.worst, `${Number(module.worst_ms).toFixed(1)} ms`);
      if (row.order) say(row.order, module.state === "running" ? "Stop" : "Start");
      row.op = module.state === "running" ? "stop" : "start";
    }
  }

  add(name) {
    const row = { state: make("span", {}), note: make("span", { class: "words" }), steps: make("td", { class: "num" }), worst: make("td", { class: "num" }), op: "stop" };
    row.element = make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, row.state, row.note), row.steps, row.worst);
    if (this.link) {
      row.order = make("button", { type: "button", class: "quiet", "aria-label": `Start or stop ${name}` });
      row.order.onclick = () => this.link.ask("module", { name, op: row.op }).then(() => toast(`${name}: ${row.op} ordered`, true)).catch((error) => toast(error.message));
      row.element.append(make("td", { class: "live-only" }, row.order));
    }
    this.rows.set(name, row);
    byId("modules").append(row.element);
    return row;
  }
}

export class Signals {
  constructor(store) {
    Object.assign(this, { store, rows: new Map() });
    setInterval(() => this.refresh(), 500);
  }

  refresh() {
    if (byId("panel-signals").hidden || document.hidden) return;
    for (const topic of Object.keys(this.store.staleAfter_s)) {
      const value = this.store.get(topic);
      if (!value && !this.rows.has(topic)) continue;
      const row = this.rows.get(topic) ?? this.add(topic), limit_s = this.store.staleAfter_s[topic];
      const isOld = this.store.isStale(topic);
      row.element.dataset.state = isOld ? "old" : "";
      say(row.age, `${age(this.store.age_s(topic))}${isOld ? " old" : ""}`);
      say(row.limit, limit_s ? `${limit_s} s` : "–");
      say(row.seq, value ? String(value.seq) : "–");
    }
  }

  add(topic) {
    const row = { age: make("td", { class: "num" }), limit: make("td", { class: "num" }), seq: make("td", { class: "num" }) };
    row.element = make("tr", {}, make("th", { scope: "row" }, topic), row.age, row.limit, row.seq);
    this.rows.set(topic, row);
    const after = [...this.rows.keys()].sort();
    byId("signals").replaceChildren(...after.map((name) => this.rows.get(name).element));
    return row;
  }
}
