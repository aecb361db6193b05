// The console begins here: the scenery, then either the live link or the black box, and the parts that show them.

import { Bar } from "./bar.js";
import { Box } from "./box.js";
import { byId, make, say } from "./dom.js";
import { Drive } from "./drive.js";
import { Halt, isTyping } from "./halt.js";
import { Lease } from "./lease.js";
import { Link } from "./link.js";
import { MapView } from "./map.js";
import { GoalSheet, Orders } from "./orders.js";
import { Mission } from "./mission.js";
import { Events, Modules, Signals, Tabs } from "./panels.js";
import { Params } from "./params.js";
import { Store } from "./store.js";
import { Tree } from "./tree.js";
import { Why } from "./why.js";

const WISHES = [ // topic, at most so often a second, only changes
  ["Localization/Pose", 10], ["Localization/Dead-Reckoning", 2], ["Localization/Laser_Pose", 5], ["sick/scan", 5], ["ATRV2/Sonar", 5], ["ATRV2/Bumper", 5],
  ["ATRV2/Battery", 1], ["ATRV2/Drive/Raw", 10], ["ATRV2/Drive/Command", 0, true], ["drive/status", 10], ["avoidance/status", 2], ["filter/status", 2],
  ["motion/status", 2], ["motion/command", 0], ["motion/job", 2], ["motion/rectangle", 0], ["map/path", 0], ["map/local", 1], ["Localization/Check", 2],
  ["world/state", 5], ["tree", 5, true], ["mission/state", 0], ["modules", 1], ["events", 0],
];

const TOO_WIDE_M = 120; // a map so wide begins at the robot

async function begin() {
  const halt = new Halt();
  const { scenery, token } = await fetchScenery("");
  const { robot, world } = scenery;
  document.title = `${robot.name} · ${scenery.mode === "box" ? "black box" : "console"}`;
  document.body.dataset.mode = scenery.mode;
  say(byId("robot"), robot.name);
  say(byId("place"), [robot.platform, world.name, scenery.mode === "box" ? scenery.box : ""].filter(Boolean).join(" · "));
  const store = new Store(scenery.stale_after_s), tabs = new Tabs(), tree = new Tree(store), events = new Events();
  tabs.onOpen("tree", () => tree.woken());
  tabs.onOpen("events", () => events.count(0));
  new Signals(store);
  const parts = { scenery, store, tabs, tree, events, token, halt };
  parts.map = scenery.mode === "box" ? showBox(parts) : showRobot(parts);
  setUpMap(parts);
  window.pluto = { map: parts.map, store }; // for who looks into the page by hand, and for its tests
  if (scenery.grid) parts.map.picture = await fetchPicture(scenery.grid.picture, token);
  parts.map.isDirty = true;
}

function showRobot({ scenery, store, tabs, tree, events, token, halt }) {
  const link = new Link(store, WISHES, operator());
  link.token = token;
  link.on("unauthorised", (error) => say(byId("no-link"), error.message));
  link.on("event", (event) => events.add(event));
  link.on("up", () => link.ask("log", { since: 0 }).catch(() => {}));
  const lease = new Lease(link), orders = new Orders(link, store, lease), bar = new Bar(store, scenery.robot, link), why = new Why(link);
  Object.defineProperty(why, "now_s", { get: () => bar.now_s });
  tree.clock = () => bar.now_s;
  why.watch(store);
  halt.join(link, store, lease, why);
  new Mission(link, store, lease);
  const modules = new Modules(link, store);
  tabs.onOpen("modules", () => modules.look());
  new Drive(link, store, lease, orders, scenery.robot);
  const params = new Params(link, lease);
  tabs.onOpen("params", () => params.load());
  const map = new MapView(byId("map"), store, scenery, (x, y, goal) => sheet.open(x, y, goal));
  const sheet = new GoalSheet(orders, map, scenery.robot);
  link.connect();
  return map;
}

function showBox({ scenery, store, tabs, tree, events }) {
  const box = new Box(store, scenery), bar = new Bar(store, scenery.robot, null), why = new Why(null);
  const modules = new Modules(null, store);
  tabs.onOpen("modules", () => modules.look());
  box.on("events", (list) => events.replace(list));
  box.on("moment", () => { bar.tick(box.wanted_s); });
  box.on("why", (answer) => why.show(answer.moving === "true", answer.rows, box.wanted_s));
  tree.clock = () => box.wanted_s;
  const map = new MapView(byId("map"), store, scenery, () => {});
  box.seek(scenery.start_s);
  return map;
}

function setUpMap({ map }) {
  const follow = byId("follow");
  const setFollow = (isOn) => {
    map.view.isFollowing = isOn;
    if (isOn) map.view.near();
    follow.setAttribute("aria-pressed", String(isOn));
  };
  map.view.moved = () => setFollow(false);
  follow.onclick = () => setFollow(!map.view.isFollowing);
  byId("fit").onclick = () => {
    setFollow(false);
    map.fit();
  };
  byId("zoom-in").onclick = () => map.view.zoom(1.4);
  byId("zoom-out").onclick = () => map.view.zoom(1 / 1.4);
  const [x0, y0, x1, y1] = map.scenery.world.bounds_m;
  if (Math.max(x1 - x0, y1 - y0) > TOO_WIDE_M) setFollow(true);
  byId("legend").append(...map.legend(make));
  window.addEventListener("keydown", (event) => {
    if (isTyping(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = { "+": () => map.view.zoom(1.4), "-": () => map.view.zoom(1 / 1.4), 0: () => byId("fit").click(), f: () => follow.click() }[event.key];
    act?.();
  });
}

/** The name under which this console drives: "console", and what the person calls himself after it. */
function operator() {
  const own = new URLSearchParams(location.search).get("name") ?? "";
  return own ? `console ${own.slice(0, 40)}` : "console";
}

async function fetchScenery(token) {
  const answer = await fetch("/scenery.json", { headers: token ? { Authorization: `Bearer ${token}` } : {} });
  if (answer.status === 401) return fetchScenery(await askToken(Boolean(token)));
  if (!answer.ok) throw new Error(await answer.text());
  return { scenery: await answer.json(), token };
}

/** The dialog lets STOP be: it lies beside it, not under it. */
function askToken(wasWrong) {
  const dialog = byId("token-dialog"), field = byId("token"), others = document.querySelectorAll(".bar, .map, .side");
  say(byId("token-note"), wasWrong ? "The robot knows nobody with that token. Look for a letter too many or too few, or ask who runs the robot." : "");
  field.setAttribute("aria-invalid", String(wasWrong));
  field.value = "";
  for (const one of others) one.inert = true;
  dialog.show();
  field.focus();
  return new Promise((resolve) => {
    dialog.onclose = () => {
      for (const one of others) one.inert = false;
      resolve(field.value);
    };
  });
}

async function fetchPicture(name, token) {
  const answer = await fetch(`/pictures/${name}`, { headers: token ? { Authorization: `Bearer ${token}` } : {} });
  return answer.ok ? createImageBitmap(await answer.blob()) : null;
}

begin().catch((error) => {
  const note = byId("no-link");
  say(note, `The console could not begin: ${error.message}`);
  note.hidden = false;
});
