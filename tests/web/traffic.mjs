// How many bytes an overseer or a replay sends to one page.
//   node traffic.mjs URL [--seconds 20] [--eye X,Y,Z --towards X,Y,Z] [--hidden] [--seek STEP]
// --seek: where in a replay to begin. Without an eye everything is sent as it is. Counts what comes over TCP, with all headers of the WebSocket.
import { parseArgs } from "node:util";
import WebSocket from "ws";

const { values, positionals } = parseArgs({ allowPositionals: true, options: { seconds: { type: "string", default: "20" },
  eye: { type: "string" }, towards: { type: "string" }, hidden: { type: "boolean" },
  seek: { type: "string" } } });
const vector = (text) => text.split(",").map(Number);

const socket = new WebSocket(`${positionals[0].replace("http", "ws")}ws`);
const seen = { binary: 0, frames: 0, text: 0, bodies: 0 };
socket.on("message", (data, isBinary) => {
  seen[isBinary ? "binary" : "text"] += data.length;
  seen.frames += isBinary ? 1 : 0;
  if (isBinary) return;
  const message = JSON.parse(data.toString());
  if (message.type === "status") seen.bodies = message.nodes.reduce((sum, node) => sum + node.bodies, 0);
});
await new Promise((resolve, reject) => socket.on("open", resolve).on("error", reject));
if (values.hidden) socket.send(JSON.stringify({ type: "view", hidden: true }));
if (values.eye) {
  // A picture of 1280 x 800 pixels, 50 degrees high.
  const half = (25 * Math.PI) / 180;
  socket.send(JSON.stringify({ type: "view", eye: vector(values.eye), towards: vector(values.towards),
    half_angle: Math.atan(Math.tan(half) * Math.hypot(1, 1.6)) + 0.15, pixel: (2 * Math.tan(half)) / 800 }));
}
if (values.seek) socket.send(JSON.stringify({ type: "replay", action: "seek", value: Number(values.seek) }));
await new Promise((resolve) => setTimeout(resolve, 1500)); // the scene and the first frame are no stream
const [before, bytes, start] = [{ ...seen }, socket._socket.bytesRead, performance.now()];
await new Promise((resolve) => setTimeout(resolve, 1000 * Number(values.seconds)));
const took_s = (performance.now() - start) / 1000;
const rate = (n) => Number((n / took_s).toFixed(1));
console.log(JSON.stringify({ kB_s: rate((socket._socket.bytesRead - bytes) / 1000), frames_kB_s: rate((seen.binary - before.binary) / 1000),
  texts_kB_s: rate((seen.text - before.text) / 1000), frames_s: rate(seen.frames - before.frames), bodies: seen.bodies }));
socket.terminate();
