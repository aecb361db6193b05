// The live link: one WebSocket, requests with their answers, pings that measure it, and the way back when it is lost.

import { attributes, elements, request, value } from "./wire.js";

const PING_MS = 1000;
const LOST_MS = 2500; // no byte for so long: what is shown is old
const BACK_OFF_MS = [250, 500, 1000, 2000];
const ANSWER_MS = 5000, FAULTS_MS = 30;

export const socketAddress = () => `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`;

/** What the buttons of this page do about a refusal, instead of what a program would have to send. */
const CURES = {
  "lease-held": (text) => `${text[0].toUpperCase()}${text.slice(1).split(/ for another|;/)[0]}. Take over takes it away.`,
  "read-only": (text) => `Your token does not allow that: ${text}. Ask who runs the robot for one that does.`,
};

export class Refused extends Error {
  /** `faults`: everything that was said against the request. The message is for a person at this page. */
  constructor(faults) {
    super(faults.map(({ text, code }) => CURES[code]?.(text) ?? (text || code)).join("\n"));
    this.code = faults[0].code;
    this.faults = faults;
  }

  /** Each with the line and column of the document that it was found in. */
  get lines() {
    return this.faults.map(({ line, col, text, code }) => (line ? `${line}:${col} ` : "") + (text || code));
  }
}

export class Link {
  /** `wishes`: [topic, max_rate_hz, on_change]; values go to `store`, other messages to listeners by tag. */
  constructor(store, wishes, name) {
    Object.assign(this, { store, wishes, name, token: "", isUp: false, roundTrip_ms: null, heard_ms: 0, lost_ms: performance.now(), farewell: "" });
    this.listeners = new Map();
    this.waiting = new Map();
    this.tries = 0;
    this.next = 1;
    setInterval(() => this.look(), PING_MS / 2);
  }

  on(tag, listener) {
    if (!this.listeners.has(tag)) this.listeners.set(tag, []);
    this.listeners.get(tag).push(listener);
  }

  tell(tag, message) {
    for (const listener of this.listeners.get(tag) ?? []) listener(message);
  }

  connect() {
    const socket = new WebSocket(socketAddress());
    this.socket = socket;
    this.opened_ms = performance.now();
    // The session is this connection's own: a lost one ends its lease, and nothing is taken up again behind the operator's back.
    this.session = `console-${crypto.getRandomValues(new Uint32Array(2)).join("-")}`;
    socket.onopen = () => this.greet();
    socket.onmessage = (event) => this.hear(event.data);
    socket.onclose = () => this.closed(socket);
  }

  async greet() {
    const { socket } = this;
    try {
      await this.ask("hello", { version: "1.0", name: this.name, session: this.session, token: this.token || undefined });
    } catch (error) {
      if (error.code === "unauthorised") this.tell("unauthorised", error);
      socket.close(); // a connection that is not answered would stay open, and no other one be tried
      this.closed(socket);
      return;
    }
    this.isUp = true;
    this.farewell = "";
    this.tries = 0;
    for (const [topic, rate_hz, onChange] of this.wishes) {
      this.ask("subscribe", { topic, max_rate_hz: rate_hz, on_change: Boolean(onChange) }).catch(() => {});
    }
    this.ping(); // so that the page knows at once how good the link is, and the time of the run
    this.tell("up");
  }

  hear(text) {
    this.heard_ms = performance.now();
    for (const element of elements(text)) {
      if (element.tagName === "value") this.take(value(element));
      else this.answer(element.tagName, element);
    }
  }

  take(value) {
    if (value.topic === "events") this.tell("event", { ...value.fields, seq: value.seq, time: value.stamp_s });
    else this.store.put(value);
  }

  answer(tag, element) {
    const message = attributes(element);
    if (tag === "error" && message.fatal === "true") this.farewell = message.text; // the connection closes behind it
    const id = element.getAttribute("id");
    const asked = this.waiting.get(id);
    if (asked && tag !== "progress" && tag !== "result" && tag !== "event") {
      message.rows = [...element.children].map((child) => ({ ...attributes(child), rows: [...child.children].map(attributes) }));
      if (tag === "error") this.refuse(id, asked, message);
      else this.settle(id, asked).resolve(message);
    }
    this.tell(tag, message);
  }

  settle(id, asked) {
    this.waiting.delete(id);
    clearTimeout(asked.timer);
    return asked;
  }

  /** All that is wrong with a request comes as one error after the other, so it is heard out. */
  refuse(id, asked, message) {
    asked.faults ??= [];
    asked.faults.push(message);
    if (asked.faults.length > 1) return;
    clearTimeout(asked.timer);
    asked.timer = setTimeout(() => this.settle(id, asked).reject(new Refused(asked.faults)), message.fatal === "true" ? 0 : FAULTS_MS);
  }

  /** Send a request; the promise is its direct answer, and fails with `Refused`. */
  ask(tag, given = {}, children = []) {
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) {
        reject(new Refused([{ code: "no-link", text: "no link to the robot" }]));
        return;
      }
      const id = `c${this.next++}`;
      const timer = setTimeout(() => {
        this.waiting.delete(id);
        reject(new Refused([{ code: "no-answer", text: `no answer to ${tag} within ${ANSWER_MS / 1000} s` }]));
      }, ANSWER_MS);
      this.waiting.set(id, { resolve, reject, timer });
      this.socket.send(request(tag, { id, ...given }, children));
    });
  }

  /** So long not a byte came. */
  get silent_ms() {
    return performance.now() - this.heard_ms;
  }

  look() {
    const now_ms = performance.now();
    if (this.isUp && this.silent_ms > LOST_MS) {
      this.socket.close();
      this.closed(this.socket); // at once: the closing handshake may never end
    }
    if (!this.isUp && this.socket?.readyState === WebSocket.CONNECTING && now_ms - this.opened_ms > 2 * LOST_MS) this.socket.close();
    if (this.isUp && now_ms - this.pinged_ms >= PING_MS) this.ping();
  }

  ping() {
    const now_ms = this.pinged_ms = performance.now();
    this.ask("ping").then((pong) => {
      this.roundTrip_ms = performance.now() - now_ms;
      this.tell("clock", Number(pong.time));
    }).catch(() => {});
  }

  closed(socket) {
    if (socket !== this.socket) return;
    if (this.isUp) this.lost_ms = performance.now();
    this.socket = null;
    this.isUp = false;
    this.roundTrip_ms = null;
    for (const asked of this.waiting.values()) {
      clearTimeout(asked.timer);
      asked.reject(new Refused(asked.faults ?? [{ code: "no-link", text: "the link was lost" }]));
    }
    this.waiting.clear();
    this.tell("down");
    if (!this.isHeld) setTimeout(() => this.connect(), BACK_OFF_MS[Math.min(this.tries++, BACK_OFF_MS.length - 1)]);
  }
}
