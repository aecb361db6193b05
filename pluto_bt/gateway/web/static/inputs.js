// What a mission wants to be given: the inputs that its main tree declares in TreeNodesModel, and a form of them.

import { byId, make, show } from "./dom.js";

const UNITS = [["_mps", "m/s"], ["_dps", "°/s"], ["_deg", "°"], ["_rad", "rad"], ["_m", "m"], ["_s", "s"]];
const FORMS = { int: "a whole number", double: "a number", float: "a number", bool: "true or false", point: "x;y", Point2D: "x;y", points: "x,y;x,y;…" };

/** The inputs of a document, those that must be given first; none if it is no XML that a browser reads. */
export function inputsOf(text) {
  const root = new DOMParser().parseFromString(text, "application/xml").documentElement;
  if (root.tagName !== "root") return [];
  const used = new Set([...root.querySelectorAll("BehaviorTree SubTree")].map((one) => one.getAttribute("ID")));
  const trees = [...root.children].filter((one) => one.tagName === "BehaviorTree").map((one) => one.getAttribute("ID"));
  const main = root.getAttribute("main_tree_to_execute") ?? trees.find((id) => !used.has(id));
  const model = [...root.querySelectorAll("TreeNodesModel > SubTree")].find((one) => one.getAttribute("ID") === main);
  const ports = [...(model?.children ?? [])].filter((one) => one.tagName === "input_port" || one.tagName === "inout_port");
  return ports.map(input).sort((a, b) => b.isNeeded - a.isNeeded);
}

function input(port) {
  const name = port.getAttribute("name"), type = port.getAttribute("type") ?? "";
  return { name, form: FORMS[type] ?? "", unit: unitOf(name), usual: port.getAttribute("default") ?? "", isNeeded: !port.hasAttribute("default"), words: port.textContent.trim() };
}

function unitOf(name) {
  return UNITS.find(([ending]) => name.endsWith(ending))?.[1] ?? "";
}

/** The form: what is left as it is takes its usual value, so that the robot decides what that is. */
export class InputForm {
  constructor(onChange) {
    Object.assign(this, { fields: [], onChange });
  }

  show(inputs) {
    this.fields = inputs.map((one) => ({ ...one, box: this.box(one) }));
    byId("mission-inputs").replaceChildren(...this.fields.map((one) => row(one)));
    show(byId("mission-inputs"), inputs.length > 0);
    this.onChange();
  }

  box({ name, usual, form, isNeeded }) {
    const box = make("input", { type: "text", value: usual, placeholder: isNeeded ? form : `usually ${usual || "empty"}`, title: form, spellcheck: false, autocomplete: "off", required: isNeeded, "aria-label": name });
    box.oninput = () => this.onChange();
    return box;
  }

  /** Names of what must be given and is not. */
  get missing() {
    return this.fields.filter(({ isNeeded, box }) => isNeeded && !box.value.trim()).map(({ name }) => name);
  }

  /** What differs from the usual values, as children of a request. */
  get given() {
    return this.fields.filter(({ usual, isNeeded, box }) => isNeeded || box.value !== usual).map(({ name, box }) => ["p", box.value, { name }]);
  }
}

function row({ name, unit, isNeeded, words, box }) {
  const label = make("span", { class: "name" }, make("b", {}, name), unit && make("span", { class: "limits" }, ` ${unit}`), isNeeded ? make("span", { class: "needed" }, " to be given") : "");
  return make("label", { class: "param" }, make("span", {}, label, make("span", { class: "words" }, words)), box);
}
