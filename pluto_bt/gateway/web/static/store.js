// The newest value of each topic with its age. Who wants to know listens by topic; "*" hears all.

export class Store {
  constructor(staleAfter_s) {
    this.staleAfter_s = staleAfter_s;
    this.values = new Map();
    this.listeners = new Map();
    this.frozen_s = null; // a recording stands still: ages are those of its moment
  }

  on(topic, listener) {
    if (!this.listeners.has(topic)) this.listeners.set(topic, []);
    this.listeners.get(topic).push(listener);
  }

  put(value) {
    value.received_ms = performance.now();
    this.values.set(value.topic, value);
    for (const listener of this.listeners.get(value.topic) ?? []) listener(value);
    for (const listener of this.listeners.get("*") ?? []) listener(value);
  }

  /** Forget a topic that did not exist at the moment shown. */
  drop(topic) {
    this.values.delete(topic);
  }

  get(topic) {
    return this.values.get(topic);
  }

  fields(topic) {
    return this.values.get(topic)?.fields;
  }

  age_s(topic) {
    const value = this.values.get(topic);
    if (!value) return Infinity;
    return value.age_s + (this.frozen_s === null ? (performance.now() - value.received_ms) / 1000 : 0);
  }

  /** True if the value is missing, or older than the robot's own table allows. */
  isStale(topic) {
    const limit_s = this.staleAfter_s[topic] ?? 0;
    return !this.values.has(topic) || (limit_s > 0 && this.age_s(topic) > limit_s + 0.3);
  }
}
