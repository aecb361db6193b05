// The smaller panels: tabs, events, modules, signals.

import { age, byId, clock, make, say, show, toast } from "./dom.js";

const EVENTS_KEPT = 300;
const LEVELS = { info: ["·", "info"], warning: ["▲", "warning"], error: ["✕", "error"] };

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
