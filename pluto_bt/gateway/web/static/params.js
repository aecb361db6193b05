// Parameters with units and ranges. Changes are gathered, set all or none, and go back by themselves unless they are kept in time.

import { byId, make, say, show, toast } from "./dom.js";

const CONFIRM_S = 30;

export class Params {
  constructor(link, lease) {
    Object.assign(this, { link, lease, rows: new Map(), changed: new Map(), rev: 0, until_ms: 0 });
    byId("params-filter").oninput = () => this.filter();
    byId("params-set").onclick = () => this.set();
    byId("params-drop").onclick = () => this.load();
    byId("params-keep").onclick = () => this.order({ op: "set" }, "kept");
    byId("params-back").onclick = () => this.order({ op: "rollback" }, "rolled back");
    byId("params-save").onclick = () => this.order({ op: "save" }, "saved for the next run");
    setInterval(() => this.countDown(), 500);
  }

  async load() {
    this.changed.clear();
    try {
      this.shown(await this.link.ask("params"));
      if (!this.docs) await this.explain();
    } catch (error) {
      say(byId("params-note"), error.code === "unknown-element" ? "This gateway serves no parameters." : error.message);
    }
  }

  async explain() {
    this.docs = true;
    const { rows } = await this.link.ask("describe", { param: "*" }).catch(() => ({ rows: [] }));
    for (const item of rows) {
      const row = this.rows.get(item.name), doc = item.rows.find((one) => one.tag === "doc");
      if (row && doc) say(row.doc, doc.text);
    }
  }

  shown({ rev, confirm_s, rows }) {
    this.rev = Number(rev);
    this.until_ms = Number(confirm_s) > 0 ? performance.now() + Number(confirm_s) * 1000 : 0;
    say(byId("params-rev"), `revision ${rev}`);
    rows.sort((a, b) => (b.live === "true") - (a.live === "true")); // what can be changed now comes first
    for (const one of rows) {
      const row = this.rows.get(one.name) ?? this.add(one);
      row.input.value = one.text;
      row.value = one.text;
      row.element.classList.remove("changed");
    }
    this.countDown();
    this.note();
  }

  add({ name, unit, range, type, live, default: usual }) {
    const [group, ...rest] = name.split(".");
    const input = make("input", { type: "text", value: "", spellcheck: false, autocomplete: "off", disabled: live !== "true", "aria-label": name });
    const doc = make("span", { class: "words" });
    const label = make("span", { class: "name" }, make("span", { class: "kind" }, rest.length ? `${group}.` : ""), make("b", {}, rest.length ? rest.join(".") : group));
    const limits = [unit, range, usual && `usually ${usual}`, live === "true" ? "" : "set at the start"].filter(Boolean).join(" · ") || type;
    const element = make("label", { class: "param" }, label, input, make("span", { class: "limits" }, limits), doc);
    const row = { element, input, doc, value: "" };
    input.oninput = () => {
      if (input.value === row.value) this.changed.delete(name);
      else this.changed.set(name, input.value);
      element.classList.toggle("changed", input.value !== row.value);
      this.note();
    };
    this.rows.set(name, row);
    byId("params").append(element);
    return row;
  }

  async set() {
    const values = [...this.changed].map(([name, text]) => ["p", text, { name }]);
    try {
      const answer = await this.link.ask("params", { op: "set", rev: this.rev, confirm_s: CONFIRM_S }, values);
      this.changed.clear();
      if (answer.tag === "params" && answer.rows.length) this.shown(answer);
      else await this.load();
      this.until_ms = performance.now() + CONFIRM_S * 1000;
      toast(`Set for ${CONFIRM_S} s: keep it, or it goes back.`, true); // in the place of what was refused before
      this.countDown();
    } catch (error) {
      toast(error.message);
    }
  }

  async order(given, done) {
    try {
      await this.link.ask("params", given);
      await this.load();
      this.until_ms = 0;
      toast(`Parameters ${done}`, true);
    } catch (error) {
      toast(error.message);
    }
    this.countDown();
  }

  countDown() {
    const left_s = (this.until_ms - performance.now()) / 1000;
    if (this.until_ms && left_s <= 0) {
      this.until_ms = 0;
      this.load();
    }
    show(byId("params-confirm"), left_s > 0);
    say(byId("params-left"), `goes back in ${Math.max(0, left_s).toFixed(0)} s`);
    show(byId("params-ops"), this.changed.size > 0 || left_s > 0);
    show(byId("params-set"), this.changed.size > 0);
    show(byId("params-drop"), this.changed.size > 0);
  }

  note() {
    say(byId("params-note"), this.changed.size ? `${this.changed.size} to set: all or none, for ${CONFIRM_S} s unless kept` : "");
    this.countDown();
  }

  filter() {
    const wanted = byId("params-filter").value.toLowerCase();
    for (const [name, row] of this.rows) show(row.element, name.toLowerCase().includes(wanted));
  }
}
