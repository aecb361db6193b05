// Teleoperation: a stick or the arrow keys. It begins with the velocities that are in force, and letting go is zero.

import { byId, say, toast } from "./dom.js";
import { isTyping } from "./halt.js";

const SEND_MS = 100;
const SONAR = 1, LASER = 2; // cmdFlags 10 * A + T: A = who watches, T = 0 velocity
const PER_S = 1.2; // of full deflection: how fast the command follows the stick
const KEYS = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };

export class Drive {
  constructor(link, store, lease, orders, robot) {
    Object.assign(this, { link, store, lease, orders, robot, isArmed: false, wish: [0, 0], told: [0, 0], isHeld: false, pressed: new Set() });
    const watch = (robot.sonars.length ? SONAR : 0) | (robot.laser_max_m === null ? 0 : LASER);
    this.flags = 10 * watch;
    this.watchers = ["Nobody watches", "Sonar watches", "Laser watches", "Laser and sonar watch"][watch];
    byId("drive-arm").onclick = () => (this.isArmed ? this.disarm() : this.arm());
    byId("top-speed").oninput = () => this.showTop();
    for (const button of byId("turns").children) {
      button.onclick = () => orders.start("MakeTurn", { angle_deg: button.dataset.turn }, `Turn ${button.textContent}`);
    }
    this.listen();
    lease.onChange((isMine) => { if (!isMine) this.disarm(); });
    store.on("drive/status", ({ fields }) => this.showReal(fields.data));
    this.showTop();
    this.disarm();
    setInterval(() => this.step(), SEND_MS);
  }

  listen() {
    const stick = byId("stick");
    stick.addEventListener("pointerdown", (event) => { stick.setPointerCapture(event.pointerId); this.drag(event); });
    stick.addEventListener("pointermove", (event) => stick.hasPointerCapture(event.pointerId) && this.drag(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) stick.addEventListener(name, () => this.letGo());
    window.addEventListener("keydown", (event) => this.key(event, true));
    window.addEventListener("keyup", (event) => this.key(event, false));
    window.addEventListener("blur", () => this.letGo());
    document.addEventListener("visibilitychange", () => document.hidden && this.letGo());
  }

  async arm() {
    try {
      await this.lease.tighten(true);
      await this.orders.prepare();
      this.isArmed = true;
      this.shown();
      byId("stick").focus({ preventScroll: true });
    } catch (error) {
      toast(error.message);
    }
  }

  disarm() {
    if (this.isArmed) {
      this.letGo();
      this.lease.tighten(false).catch(() => {});
    }
    this.isArmed = false;
    this.shown();
  }

  shown() {
    const button = byId("drive-arm");
    button.setAttribute("aria-pressed", String(this.isArmed));
    say(button, this.isArmed ? "Let go of the wheel" : "Take the wheel");
    button.classList.toggle("primary", !this.isArmed);
    byId("stick").classList.toggle("armed", this.isArmed);
    say(byId("drive-note"), this.isArmed ? `Drag the stick or hold the arrow keys. Letting go stops. ${this.watchers}.` : "Takes the lease and pauses a running mission.");
  }

  top() {
    const share = Number(byId("top-speed").value) / 100;
    return [this.robot.max_speed_mps * share, this.robot.max_turn_radps * share];
  }

  showTop() {
    const [v, w] = this.top();
    say(byId("top-shown"), `${v.toFixed(2)} m/s, ${(w * 57.3).toFixed(0)} °/s`);
  }

  drag(event) {
    if (!this.isArmed) return;
    const box = byId("stick").getBoundingClientRect(), radius = box.width / 2;
    let x = (event.clientX - box.left - radius) / radius, y = (event.clientY - box.top - radius) / radius;
    const far = Math.hypot(x, y);
    if (far > 1) [x, y] = [x / far, y / far];
    this.hold([-y, -x]);
  }

  key(event, isDown) {
    if (!(event.key in KEYS) || !this.isArmed || isTyping(event.target)) return;
    event.preventDefault();
    isDown ? this.pressed.add(event.key) : this.pressed.delete(event.key);
    const wish = [0, 0];
    for (const name of this.pressed) KEYS[name].forEach((share, i) => { wish[i] += share; });
    this.pressed.size ? this.hold(wish) : this.letGo();
  }

  /** The stick is held at `wish`, shares of the top speeds; the first touch begins with what the robot does. */
  hold(wish) {
    if (!this.isHeld) {
      const [v_mps, w_radps] = this.top(), [v, w] = this.store.fields("drive/status")?.data ?? [0, 0];
      this.told = [limit(v / v_mps), limit(w / w_radps)];
    }
    Object.assign(this, { isHeld: true, wish });
    this.draw();
  }

  letGo() {
    this.pressed.clear();
    if (!this.isHeld) return;
    Object.assign(this, { isHeld: false, wish: [0, 0], told: [0, 0] });
    this.send();
    this.draw();
  }

  step() {
    if (!this.isHeld) return;
    const most = PER_S * SEND_MS / 1000;
    this.told = this.told.map((share, i) => share + Math.max(-most, Math.min(most, this.wish[i] - share)));
    this.send();
  }

  send() {
    const [v_mps, w_radps] = this.top(), v = this.told[0] * v_mps, w = this.told[1] * w_radps;
    say(byId("told-v"), `${v.toFixed(2)} m/s`);
    say(byId("told-w"), `${(w * 57.3).toFixed(0)} °/s`);
    const velocity = ["velocity", `${v.toFixed(4)} ${w.toFixed(4)}`];
    this.link.ask("command", { target: "motion", flags: this.flags }, [velocity]).catch((error) => {
      if (!this.isArmed) return;
      this.isHeld = false; // what was refused is not repeated ten times a second
      this.disarm();
      toast(error.message);
    });
  }

  draw() {
    const knob = byId("knob");
    knob.style.transform = `translate(${(-this.wish[1] * 62).toFixed(1)}px, ${(-this.wish[0] * 62).toFixed(1)}px)`;
  }

  showReal([v, w]) {
    say(byId("real-v"), `${v.toFixed(2)} m/s`);
    say(byId("real-w"), `${(w * 57.3).toFixed(0)} °/s`);
  }
}

const limit = (share) => Math.max(-1, Math.min(1, share));
