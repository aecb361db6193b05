// Making and filling elements. Text is only ever set as text: nothing that a robot, a mission or a person says is read as HTML.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children; strings become text nodes. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "class") element.className = value;
    else if (name.startsWith("aria-") || name.startsWith("data-") || name === "role") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children);
  return element;
}

/** Set the text, and touch the page only if it has changed. */
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function show(element, isShown) {
  if (element.hidden === isShown) element.hidden = !isShown;
}

export const metres = (value) => `${value.toFixed(2)} m`;
export const degrees = (value_rad) => `${(value_rad * 180 / Math.PI).toFixed(0)}°`;

/** An age as a person reads it. */
export function age(seconds) {
  if (!Number.isFinite(seconds)) return "never";
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 120) return `${seconds.toFixed(0)} s`;
  return seconds < 7200 ? `${(seconds / 60).toFixed(0)} min` : `${(seconds / 3600).toFixed(0)} h`;
}

/** Seconds of the run as minutes and seconds. */
export function clock(seconds) {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}

let hiding = 0;
/** A short word about what was just refused or done. */
export function toast(text, isGood = false) {
  const element = byId("toast");
  say(element, text);
  element.classList.toggle("good", isGood);
  show(element, true);
  element.onclick = () => show(element, false);
  clearTimeout(hiding);
  hiding = setTimeout(() => show(element, false), isGood ? 3000 : 8000);
}
