// Commands to the run and their replies. Every command is answered once; who sent it gets a promise, the user a toast.

const REPLY_TIMEOUT_MS = 8000;

export class Commands {
  /**
   * @param {(message: object) => boolean} send
   * @param {(text: string, kind: "ok" | "bad" | "info") => void} toast
   * @param {import("./session.js").Session} session
   * @param {() => Promise<string | null>} askForToken
   * @param {() => Promise<boolean>} reconnect  a socket may what the page might when it was opened
   */
  constructor(send, toast, session, askForToken, reconnect) {
    Object.assign(this, { sendMessage: send, toast, session, askForToken, reconnect });
    this.waiting = new Map();
    this.sent = 0;
    this.entering = null;
  }

  /**
   * @param {{kind: string}} command
   * @param {{quiet?: boolean, what?: string}} [options]  quiet: no toast when all is well; what: its name in the toast
   * @returns {Promise<{ok: boolean, text: string, result?: any}>} never rejects
   */
  async send(command, options = {}) {
    if (command.kind !== "ray" && !(await this.mayOperate())) return { ok: false, text: "only watching" };
    const request = `p${++this.sent}-${Math.random().toString(36).slice(2, 8)}`;
    const reply = await new Promise((resolve) => {
      if (!this.sendMessage({ type: "command", request, command })) return resolve({ ok: false, text: "not connected" });
      const timer = setTimeout(() => this.reply({ request, ok: false, text: "no answer in time" }), REPLY_TIMEOUT_MS);
      this.waiting.set(request, { resolve, timer });
    });
    const what = options.what ?? command.kind;
    if (!reply.ok) {
      this.toast(`${what}: ${reply.text || "refused"}`, "bad");
      if (/token/i.test(reply.text ?? "")) this.session.look();
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
    if (!(await this.mayOperate())) return null;
    try {
      const answer = await fetch(`api/shapes?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file });
      const text = await answer.text();
      if (!answer.ok) {
        this.toast(`${file.name}: ${explained(text) || answer.statusText}`, "bad");
        if (answer.status === 401) this.session.look();
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

  /** In a replay, what all who watch it see. @param {object} message */
  async replay(message) {
    if (await this.mayOperate()) this.sendMessage(message);
  }

  /** Asks the user for a token if need be, once, however many want to know. @returns {Promise<boolean>} */
  async mayOperate() {
    if (this.session.may === "operate") return true;
    this.entering ??= this.#enter().finally(() => { this.entering = null; });
    return this.entering;
  }

  async #enter() {
    const token = await this.askForToken();
    if (!token) return false;
    const why = await this.session.enter(token) ?? (this.session.may === "operate" ? null : "this token is for watching only");
    if (why) this.toast(why, "bad");
    return why === null && this.reconnect();
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
