// Errands: one node run by this console. A running mission is paused first, and the lease is taken if it is free; both are said on the button's sheet.

import { byId, metres, say, show, toast } from "./dom.js";

export class Orders {
  constructor(link, store, lease) {
    Object.assign(this, { link, store, lease, run: null });
    link.on("progress", (message) => this.heard(message));
    link.on("result", (message) => this.ended(message));
    link.on("down", () => this.tell(""));
    byId("errand-cancel").onclick = () => this.run && link.ask("cancel", { run: this.run }).catch((error) => toast(error.message));
  }

  get missionRuns() {
    return this.store.fields("mission/state")?.state === "running";
  }

  /** What will happen besides the errand itself, in words; "" if nothing. */
  consequences() {
    const words = [];
    if (this.missionRuns) words.push("pauses the mission");
    if (!this.lease.isMine && !this.lease.holder) words.push("takes the lease");
    return words.join(", ");
  }

  /** Pause the mission and hold the lease. Raises Refused. */
  async prepare() {
    if (!this.lease.isMine) await this.lease.acquire();
    if (this.missionRuns) await this.link.ask("mission", { op: "pause" });
  }

  async start(node, ports, words) {
    try {
      await this.prepare();
      const { run } = await this.link.ask("run", { node, ...ports });
      Object.assign(this, { run, words });
      this.tell(`${words} …`);
    } catch (error) {
      toast(error.message);
    }
  }

  heard({ run, text }) {
    if (run === this.run) this.tell(text ? `${this.words}: ${text}` : `${this.words} …`);
  }

  ended({ run, state, reason, text }) {
    if (run !== this.run) return;
    this.run = null;
    this.tell("");
    toast(`${this.words}: ${state}${reason && state !== "succeeded" ? ` (${reason})` : ""}${text ? `, ${text}` : ""}`, state === "succeeded");
  }

  tell(text) {
    if (!text) this.run = null;
    say(byId("errand-text"), text);
    show(byId("errand"), Boolean(text));
  }
}

/** The sheet over the map: what to do with the place that was tapped. */
export class GoalSheet {
  constructor(orders, map, robot) {
    Object.assign(this, { orders, map, robot, place: null });
    const goto = robot.turns_on_the_spot ? "GoTo" : "CarGoTo";
    byId("goal-goto").onclick = () => this.go(goto, "Go to");
    byId("goal-moveto").onclick = () => this.go("MoveTo", "Move to");
    byId("goal-navigate").onclick = () => this.go("NavigateTo", "Navigate to");
    byId("goal-cancel").onclick = () => this.close();
    show(byId("goal-moveto"), robot.laser_max_m !== null);
    show(byId("goal-navigate"), robot.laser_max_m !== null);
    orders.lease.onChange(() => this.place && this.note());
    window.addEventListener("keydown", (event) => event.key === "Escape" && this.close());
  }

  open(x, y, goal) {
    this.place = { x, y };
    this.map.choose(this.place);
    const pose = this.orders.store.fields("Localization/Pose")?.pose;
    say(byId("goal-place"), goal ? `${goal.id}  (${x.toFixed(2)}, ${y.toFixed(2)})` : `${x.toFixed(2)}, ${y.toFixed(2)}`);
    say(byId("goal-far"), pose ? `${metres(Math.hypot(x - pose[0], y - pose[1]))} away` : "");
    this.note();
    show(byId("goal-sheet"), true);
    byId("goal-sheet").classList.toggle("above", this.map.view.toScreen(x, y)[1] > this.map.view.height / 2); // never over the place itself
    byId("goal-goto").focus({ preventScroll: true });
  }

  note() {
    const { holder, isMine } = this.orders.lease;
    const isForeign = Boolean(holder) && !isMine;
    say(byId("goal-note"), isForeign ? `${holder} holds the lease: Take over, above, comes first` : this.orders.consequences());
    for (const name of ["goto", "moveto", "navigate"]) byId(`goal-${name}`).disabled = isForeign;
  }

  go(node, words) {
    const { x, y } = this.place;
    const where = `${x.toFixed(2)}, ${y.toFixed(2)}`;
    this.close();
    this.orders.start(node, { goal: `${x.toFixed(3)};${y.toFixed(3)}` }, `${words} ${where}`);
  }

  close() {
    this.place = null;
    this.map.choose(null);
    show(byId("goal-sheet"), false);
  }
}
