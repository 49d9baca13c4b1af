// What this page may do. A token, typed in or from the address, is exchanged for a cookie that no script can read; the
// page keeps neither.

/** @typedef {"nothing" | "look" | "operate"} May */

export class Session {
  /** @param {(url: string, options?: object) => Promise<Response>} [ask] */
  constructor(ask = (url, options) => fetch(url, options)) {
    this.ask = ask;
    /** @type {May} */
    this.may = "look";
  }

  /** Asks the overseer what this page may do. While there is none, what it might stays. */
  async look() {
    try {
      const answer = await this.ask("api/session");
      if (answer.ok) this.may = (await answer.json()).may;
    } catch {
      // The socket, which comes back, says what there is to say.
    }
  }

  /** @param {string} token @returns {Promise<string | null>} why not */
  async enter(token) {
    try {
      const answer = await this.ask("api/session", { method: "POST", headers: { Authorization: `Bearer ${token}` } });
      if (!answer.ok) return (await answer.text()).trim() || "the token was refused";
      this.may = (await answer.json()).may;
      return null;
    } catch (error) {
      return `the token could not be shown: ${error.message}`;
    }
  }
}

/**
 * `#token=…`, which no server is ever sent. It is taken out of the address bar and the history at once.
 * @param {Location} location @param {History} history
 */
export function tokenFromAddress(location, history) {
  const match = /[#&]token=([^&]+)/.exec(location.hash);
  if (!match) return null;
  history.replaceState(null, "", location.pathname + location.search);
  try {
    return decodeURIComponent(match[1]);
  } catch {
    return match[1];
  }
}
