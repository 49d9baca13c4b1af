// Commands to the run and their replies. Every command is answered once; who sent it gets a promise, the user a toast.

const TOKEN_KEY = "aurasim.token";
const REPLY_TIMEOUT_MS = 8000;

export class Commands {
  /**
   * @param {(message: object) => boolean} send
   * @param {(text: string, kind: "ok" | "bad" | "info") => void} toast
   * @param {() => Promise<string | null>} askForToken
   */
  constructor(send, toast, askForToken) {
    this.sendMessage = send;
    this.toast = toast;
    this.askForToken = askForToken;
    this.waiting = new Map();
    this.sent = 0;
    this.tokenNeeded = false;
    this.token = tokenFromAddress() ?? remembered() ?? "";
  }

  /**
   * @param {{kind: string}} command
   * @param {{quiet?: boolean, what?: string}} [options]  quiet: no toast when all is well; what: its name in the toast
   * @returns {Promise<{ok: boolean, text: string, result?: any}>} never rejects
   */
  async send(command, options = {}) {
    if (this.tokenNeeded && !this.token) await this.#getToken();
    const request = `p${++this.sent}-${Math.random().toString(36).slice(2, 8)}`;
    const reply = await new Promise((resolve) => {
      const message = { type: "command", request, command };
      if (this.token) message.token = this.token;
      if (!this.sendMessage(message)) return resolve({ ok: false, text: "not connected" });
      const timer = setTimeout(() => this.reply({ request, ok: false, text: "no answer in time" }), REPLY_TIMEOUT_MS);
      this.waiting.set(request, { resolve, timer });
    });
    const what = options.what ?? command.kind;
    if (!reply.ok) {
      this.toast(`${what}: ${reply.text || "refused"}`, "bad");
      if (/token/i.test(reply.text ?? "")) this.#forgetToken();
    } else if (!options.quiet) {
      // Some answers begin with the command's name.
      const text = reply.text?.replace(`${command.kind}: `, "");
      this.toast(text ? `${what}: ${text}` : what, "ok");
    }
    return reply;
  }

  reply(message) {
    const waiting = this.waiting.get(message.request);
    if (!waiting) return;
    this.waiting.delete(message.request);
    clearTimeout(waiting.timer);
    waiting.resolve(message);
  }

  /** The connection broke: nobody will answer any more. */
  dropAll() {
    for (const request of [...this.waiting.keys()]) this.reply({ request, ok: false, text: "the connection broke" });
  }

  /** A mesh file becomes a shape that commands can name. @param {File} file */
  async upload(file) {
    if (this.tokenNeeded && !this.token) await this.#getToken();
    const headers = this.token ? { Authorization: `Bearer ${this.token}` } : {};
    try {
      const answer = await fetch(`api/shapes?name=${encodeURIComponent(file.name)}`, { method: "POST", headers, body: file });
      const text = await answer.text();
      if (!answer.ok) {
        this.toast(`${file.name}: ${explained(text) || answer.statusText}`, "bad");
        if (answer.status === 401 || answer.status === 403) this.#forgetToken();
        return null;
      }
      const shape = JSON.parse(text);
      this.toast(`${file.name}: ${shape.points} points, ${shape.triangles} triangles`, "ok");
      return shape;
    } catch (error) {
      this.toast(`${file.name}: ${error.message}`, "bad");
      return null;
    }
  }

  async #getToken() {
    const token = await this.askForToken();
    if (!token) return;
    this.token = token;
    try {
      sessionStorage.setItem(TOKEN_KEY, token);
    } catch {
      // Storage may be switched off: the token then lives as long as the page.
    }
  }

  #forgetToken() {
    this.token = "";
    try {
      sessionStorage.removeItem(TOKEN_KEY);
    } catch {
      // as above
    }
  }
}

function explained(text) {
  try {
    const said = JSON.parse(text);
    return said.text ?? said.error ?? text;
  } catch {
    return text;
  }
}

function remembered() {
  try {
    return sessionStorage.getItem(TOKEN_KEY);
  } catch {
    return null;
  }
}

/** `#token=…`; it is taken out of the address bar, so that it is not shown or shared by accident. */
function tokenFromAddress() {
  const match = /[#&]token=([^&]+)/.exec(location.hash);
  if (!match) return null;
  const token = decodeURIComponent(match[1]);
  history.replaceState(null, "", location.pathname + location.search);
  try {
    sessionStorage.setItem(TOKEN_KEY, token);
  } catch {
    // as above
  }
  return token;
}
