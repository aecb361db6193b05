// The gateway's protocol (docs/gateway.md) as objects. One text message holds whole elements, one a line.

const WORDS = new Set(["name", "state", "reason", "step", "text", "value", "cells", "refused", "level", "code", "source"]);
const ROWS = new Set(["node", "module", "status", "cause", "field", "mission", "p", "out", "item", "cap"]);
const parser = new DOMParser();

/** The elements of one text message. */
export function elements(text) {
  const root = parser.parseFromString(`<messages>${text}</messages>`, "application/xml").documentElement;
  return root.querySelector("parsererror") ? [] : [...root.children];
}

/** Attributes as an object; `text` is what stands between the tags. */
export function attributes(element) {
  const found = { tag: element.tagName };
  for (const { name, value } of element.attributes) found[name] = value;
  if (!("text" in found)) found.text = element.childElementCount ? "" : element.textContent;
  return found;
}

/** A `<value>`: numbers as arrays (one number as itself), words as text, rows as arrays of attributes. */
export function value(element) {
  const fields = {};
  for (const child of element.children) {
    const name = child.tagName;
    if (ROWS.has(name) && child.attributes.length) (fields[`${name}s`] ??= []).push(attributes(child));
    else if (WORDS.has(name)) fields[name] = child.textContent;
    else fields[name] = numbers(child.textContent);
  }
  const head = attributes(element);
  return { topic: head.topic, seq: Number(head.seq), stamp_s: Number(head.stamp), age_s: Number(head.age), fields };
}

function numbers(text) {
  const words = text.split(" ").filter(Boolean);
  if (words.length === 1 && (text === "true" || text === "false")) return text === "true";
  const found = words.map((word) => (word === "INF" ? Infinity : word === "-INF" ? -Infinity : Number(word)));
  return found.length === 1 ? found[0] : found;
}

/** The text of a request. Attributes that are undefined are left out; children are [tag, text]. */
export function request(tag, given = {}, children = []) {
  const element = document.implementation.createDocument(null, tag).documentElement;
  for (const [name, value] of Object.entries(given)) if (value !== undefined) element.setAttribute(name, String(value));
  for (const [name, content, more = {}] of children) {
    const child = element.ownerDocument.createElement(name);
    for (const [key, value] of Object.entries(more)) child.setAttribute(key, String(value));
    child.textContent = content;
    element.append(child);
  }
  return new XMLSerializer().serializeToString(element);
}

/** A field that may be one number or several, as several. */
export const list = (field) => (field === undefined || field === "" ? [] : Array.isArray(field) ? field : [field]);
