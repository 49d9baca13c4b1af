// The WebSocket to the overseer: opens, reads, comes back after it broke. Everything that it needs from a browser can
// be passed in, so that tests run it in virtual time.
import { decode } from "./frames.js";

const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 1000; // back soon after an overseer that was restarted
/** Statuses come four times a second; this long without a word and the connection is taken for dead. */
const SILENCE_MS = 8000;
const REST_OF_SILENCE_MS = 500;

/**
 * @typedef {object} Handlers
 * @property {(state: "connecting" | "open" | "closed", retryIn_ms?: number) => void} state
 * @property {(message: any) => void} json
 * @property {(message: import("./frames.js").Frame | import("./frames.js").Overlay) => void} binary
 */

export class Connection {
  /**
   * @param {string} url
   * @param {Handlers} handlers
   * @param {{open?: (url: string) => any, setTimeout?: Function, clearTimeout?: Function}} [platform]
   */
  constructor(url, handlers, platform = {}) {
    this.url = url;
    this.handlers = handlers;
    this.open = platform.open ?? ((address) => new WebSocket(address));
    this.later = platform.setTimeout ?? ((f, ms) => setTimeout(f, ms));
    this.never = platform.clearTimeout ?? ((id) => clearTimeout(id));
    this.attempts = 0;
    this.refused = 0; // messages that could not be read
    this.connected = false;
    this.resting = false;
    this.socket = null;
  }

  start() {
    this.never(this.retry);
    this.handlers.state("connecting");
    const socket = this.open(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    // A socket that was given up may still have something to say; only the newest one is listened to.
    const ifCurrent = (f) => (event) => this.socket === socket && f(event);
    socket.onopen = ifCurrent(() => {
      this.connected = true;
      this.#listen();
      this.handlers.state("open");
    });
    socket.onmessage = ifCurrent((event) => this.#receive(event.data));
    socket.onclose = ifCurrent(() => this.#closed());
    socket.onerror = () => {}; // a close follows
  }

  /** At once, without waiting for the next attempt: the tab is looked at again. */
  hurry() {
    if (!this.connected && this.socket === null) this.start();
  }

  /** Anew, though nothing broke. */
  reopen() {
    const old = this.socket;
    this.connected = false;
    this.start();
    old?.close();
  }

  /** While the page is hidden the overseer says nothing: silence is no sign of death then. */
  rest(resting) {
    this.resting = resting;
    if (this.connected) this.#listen();
  }

  /** @returns {boolean} false if there is nobody to send it to */
  send(message) {
    if (!this.connected) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  /** A page that was busy has messages waiting: they are read before the rest of the silence is over. */
  #listen() {
    this.never(this.silence);
    if (this.resting) return;
    this.silence = this.later(() => {
      this.silence = this.later(() => {
        const socket = this.socket;
        this.#closed();
        socket?.close();
      }, REST_OF_SILENCE_MS);
    }, SILENCE_MS - REST_OF_SILENCE_MS);
  }

  #receive(data) {
    this.#listen();
    if (typeof data === "string") {
      let message;
      try {
        message = JSON.parse(data);
      } catch {
        ++this.refused;
        return;
      }
      if (message === null || typeof message !== "object") return void ++this.refused;
      // Only a greeting shows that the other side is well; a server that accepts and drops must not be hammered.
      if (message.type === "hello") this.attempts = 0;
      this.handlers.json(message);
      return;
    }
    const message = decode(data);
    if (message.kind === "refused") {
      ++this.refused;
      console.warn("a message was refused:", message.why);
      return;
    }
    this.handlers.binary(message);
  }

  #closed() {
    this.never(this.silence);
    this.connected = false;
    this.socket = null;
    const wait_ms = Math.min(LONGEST_WAIT_MS, FIRST_WAIT_MS * 1.6 ** this.attempts);
    ++this.attempts;
    this.handlers.state("closed", wait_ms);
    this.retry = this.later(() => this.start(), wait_ms);
  }
}
