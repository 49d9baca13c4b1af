import { expect, test } from "vitest";
import { Commands } from "../../src/overseer/web/src/commands.js";
import { Session, tokenFromAddress } from "../../src/overseer/web/src/session.js";

const answered = (status, body) => ({ ok: status === 200, text: async () => String(body), json: async () => body });
const none = () => Promise.reject(new Error("nobody is there"));

/** Commands of a page that may look, whose user types these tokens. */
function commandsWith(session, tokens) {
  const sent = [], toasts = [];
  let reconnected = 0, asked = 0;
  const commands = new Commands((message) => sent.push(message), (text) => toasts.push(text), session,
    async () => tokens[asked++] ?? null, async () => { ++reconnected; return true; });
  return { commands, sent, toasts, get reconnected() { return reconnected; }, get asked() { return asked; } };
}
const overseer = async (url, { headers } = {}) =>
  (!headers ? answered(200, { may: "look" }) : headers.Authorization === "Bearer right" ? answered(200, { may: "operate" })
    : headers.Authorization === "Bearer look" ? answered(200, { may: "look" }) : answered(401, "the token is missing or wrong\n"));

test("ATokenIsTakenOutOfTheAddressAndOnlyIt", () => {
  const replaced = [];
  const history = { replaceState: (...words) => replaced.push(words[2]) };
  const at = (hash) => tokenFromAddress({ hash, pathname: "/p", search: "?quality=low" }, history);
  expect(at("#token=a%20b")).toBe("a b");
  expect(at("#x=1&token=%zz")).toBe("%zz");
  expect(replaced).toEqual(["/p?quality=low", "/p?quality=low"]);
  expect(at("#tokens=1")).toBe(null);
  expect(at("")).toBe(null);
  expect(replaced.length).toBe(2);
});

test("AnOverseerThatIsAwayChangesNothing", async () => {
  const session = new Session(none);
  session.may = "operate";
  await session.look();
  expect(session.may).toBe("operate");
  expect(await session.enter("right")).toMatch(/nobody is there/);
});

test("ManyCommandsAtOnceAskForOneToken", async () => {
  const page = commandsWith(new Session(overseer), ["right"]);
  page.commands.send({ kind: "pause" });
  page.commands.send({ kind: "reset" });
  await page.commands.mayOperate();
  await Promise.resolve();
  expect(page.asked).toBe(1);
  expect(page.reconnected).toBe(1);
  expect(page.sent.map((message) => message.command.kind)).toEqual(["pause", "reset"]);
  expect(JSON.stringify(page.sent)).not.toMatch(/right/);
  page.commands.dropAll();
});

test("AWrongTokenAndOneForWatchingChangeNothing", async () => {
  const page = commandsWith(new Session(overseer), ["wrong", "look"]);
  for (const why of [/missing or wrong/, /watching/]) {
    expect((await page.commands.send({ kind: "pause" })).ok).toBe(false);
    expect(page.toasts.pop()).toMatch(why);
  }
  expect((await page.commands.send({ kind: "pause" })).ok).toBe(false);
  expect(page.toasts).toEqual([]);
  expect(page.sent).toEqual([]);
});

test("WhoLooksMayAskWhereARayEnds", () => {
  const page = commandsWith(new Session(overseer), []);
  page.commands.send({ kind: "ray" });
  expect(page.sent.length).toBe(1);
  expect(page.asked).toBe(0);
  page.commands.dropAll();
});
