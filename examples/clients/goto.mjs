// Drive a robot to a place and say how it goes: node goto.mjs HOST PORT X Y
// The protocol of the gateway with node alone. One message a line comes from the robot, so that a line is all there is to parse.
import net from "node:net";

const [host, port, x, y] = process.argv.slice(2);
const isNumber = (word) => word !== undefined && word.trim() !== "" && Number.isFinite(Number(word));
if (!isNumber(x) || !isNumber(y)) {
  console.error("usage: node goto.mjs HOST PORT X Y, where X and Y are numbers, in metres");
  process.exit(2);
}

const TTL_S = 3;
let begun = false;
let exitCode; // known once it is over
const robot = net.createConnection({ host, port: Number(port) });
robot.setNoDelay(true);
robot.setEncoding("utf8");

const say = (message) => robot.write(message + "\n");
// It is over: give the lease back; the answer to that ends the conversation. Who leaves with the lease in hand stops the robot.
const end = (code) => {
  if (exitCode !== undefined) return;
  exitCode = code;
  clearInterval(renewal);
  say('<lease op="release" id="release"/>');
};

// A tag, its attributes and its text: enough for messages without children of their own, and for <pose> in a <value>.
const ENTITIES = { lt: "<", gt: ">", amp: "&", quot: '"', apos: "'" };
const plain = (text) =>
  text.replace(/&(#x[0-9a-f]+|#\d+|\w+);/gi, (all, name) => {
    if (name[0] !== "#") return ENTITIES[name] ?? all;
    return String.fromCodePoint(name[1] === "x" ? parseInt(name.slice(2), 16) : Number(name.slice(1)));
  });
const read = (line) => {
  const [, tag, rest, inside] = line.match(/^<([\w-]+)((?:\s+[\w:.-]+="[^"]*")*)\s*(?:\/>|>(.*)<\/[\w-]+>)$/s) ?? [];
  const attributes = {};
  for (const [, name, value] of (rest ?? "").matchAll(/([\w:.-]+)="([^"]*)"/g)) attributes[name] = plain(value);
  return { tag, attributes, inside: inside ?? "" };
};
const child = (message, name) => message.inside.match(new RegExp(`<${name}>([^<]*)</${name}>`))?.[1] ?? "";

function hear({ tag, attributes, ...rest }) {
  const id = attributes.id;
  if (tag === "error" && id !== "release" && id !== "renew") {
    console.error(`${attributes.code}: ${plain(rest.inside)}`);
    end(1);
  } else if (tag === "value") {
    const [px, py] = child(rest, "pose").split(" ").map(Number);
    console.log(`pose ${px.toFixed(2)} ${py.toFixed(2)}`);
  } else if (id === "lease") {
    say(`<run id="run" node="GoTo" goal="${Number(x)};${Number(y)}" deadline_s="120"/>`);
  } else if (tag === "ack") {
    begun = true;
  } else if (tag === "progress") {
    console.log(`progress ${attributes.state} ${attributes.text}`);
  } else if (tag === "result") {
    begun = false;
    console.log(`result ${attributes.state} ${attributes.reason}`);
    end(attributes.state === "succeeded" ? 0 : 1);
  } else if (id === "release") {
    robot.end();
  }
}

let buffer = "";
robot.on("connect", () => {
  say('<hello version="1.0" name="node example"/>');
  say('<subscribe topic="Localization/Pose" max_rate_hz="2"/>');
  say(`<lease id="lease" op="acquire" ttl_s="${TTL_S}" on_loss="stop"/>`);
});
robot.on("data", (text) => {
  const lines = (buffer + text).split("\n");
  buffer = lines.pop();
  for (const line of lines) hear(read(line));
});
robot.on("error", (error) => {
  console.error(`no robot: ${error.message}`);
  process.exit(1);
});
robot.on("close", () => process.exit(exitCode ?? 1));

// The lease says: this program is alive. If it hangs or dies, the robot stops within TTL_S.
const renewal = setInterval(() => begun && say('<lease op="renew" id="renew"/>'), (TTL_S * 1000) / 3);
process.on("SIGINT", () => {
  say('<stop id="stop"/>'); // first of all
  console.log("stopped");
  end(130);
});
