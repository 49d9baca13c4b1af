import { beforeEach, expect, test } from "vitest";
import { Connection } from "../../src/overseer/web/src/connection.js";
import { writeFrame } from "./frame_writer.mjs";

/** Time that passes when it is told to. */
class Time {
  constructor() {
    this.now = 0;
    this.due = new Map();
    this.next = 1;
  }
  setTimeout = (f, ms) => {
    this.due.set(this.next, { at: this.now + ms, f });
    return this.next++;
  };
  clearTimeout = (id) => this.due.delete(id);
  pass(ms) {
    const end = this.now + ms;
    for (;;) {
      const [id, entry] = [...this.due].sort((a, b) => a[1].at - b[1].at)[0] ?? [];
      if (!entry || entry.at > end) break;
      this.due.delete(id);
      this.now = entry.at;
      entry.f();
    }
    this.now = end;
  }
}

let time, sockets, states, messages, frames, connection;
beforeEach(() => {
  [time, sockets, states, messages, frames] = [new Time(), [], [], [], []];
  connection = new Connection("ws://test/ws",
    { state: (state, wait) => states.push([state, wait]), json: (m) => messages.push(m), binary: (f) => frames.push(f) },
    { ...time, open: () => (sockets.push({ sent: [], send(m) { this.sent.push(m); }, close() {} }), sockets.at(-1)) });
  connection.start();
});
const greet = () => {
  sockets.at(-1).onopen({});
  sockets.at(-1).onmessage({ data: '{"type": "hello"}' });
};

test("AConnectionIsOpenedAnewWhenItIsToldTo", () => {
  greet();
  connection.reopen();
  expect(sockets.length).toBe(2);
  expect(connection.connected).toBe(false);
  sockets[0].onclose({}); // of the old one, and no news
  greet();
  time.pass(1000);
  expect(sockets.length).toBe(2);
  expect(connection.connected).toBe(true);
});

test("AConnectionThatBreaksIsOpenedAgainWithinTwoSeconds", () => {
  greet();
  sockets[0].onclose({});
  expect(connection.connected).toBe(false);
  time.pass(1999);
  expect(sockets.length).toBeGreaterThan(1);
  greet();
  expect(connection.connected).toBe(true);
});

test("WaitsGrowAndHaveALimit", () => {
  for (let i = 0; i < 12; ++i) {
    sockets.at(-1).onclose({});
    time.pass(5000);
  }
  const waits = states.filter(([state]) => state === "closed").map(([, wait]) => wait);
  expect(waits[1]).toBeGreaterThan(waits[0]);
  expect(Math.max(...waits)).toBe(1000);
});

test("AServerThatAcceptsAndDropsIsNotHammered", () => {
  for (let i = 0; i < 6; ++i) {
    sockets.at(-1).onopen({});
    sockets.at(-1).onclose({});
    time.pass(5000);
  }
  expect(states.filter(([state]) => state === "closed").at(-1)[1]).toBeGreaterThan(900);
});

test("AGreetingStartsTheWaitsAnew", () => {
  for (let i = 0; i < 5; ++i) {
    sockets.at(-1).onclose({});
    time.pass(5000);
  }
  greet();
  sockets.at(-1).onclose({});
  expect(states.at(-1)[1]).toBe(250);
});

test("SilenceIsADeadConnection", () => {
  greet();
  time.pass(8500);
  expect(sockets.length).toBe(2);
});

test("ASocketThatWasGivenUpIsNotHeardAnyMore", () => {
  greet();
  sockets[0].onclose({});
  time.pass(2000);
  sockets[0].onmessage?.({ data: '{"type": "status"}' });
  expect(messages).toEqual([{ type: "hello" }]);
});

test("WhatCannotBeReadIsCountedAndTheRestGoesOn", () => {
  greet();
  for (const data of ["{", "null", "7", new ArrayBuffer(3), new ArrayBuffer(60)]) sockets[0].onmessage({ data });
  sockets[0].onmessage({ data: writeFrame({ stamp: 4 }) });
  expect(connection.refused).toBe(5);
  expect(frames.map((f) => f.stamp)).toEqual([4]);
});

test("NothingIsSentWhileThereIsNobody", () => {
  expect(connection.send({ type: "show" })).toBe(false);
  greet();
  expect(connection.send({ type: "show" })).toBe(true);
  expect(JSON.parse(sockets[0].sent[0])).toEqual({ type: "show" });
});

test("AHiddenPageDoesNotTakeSilenceForDeath", () => {
  greet();
  connection.rest(true);
  time.pass(600_000);
  expect(sockets.length).toBe(1);
  connection.rest(false);
  time.pass(8500);
  expect(sockets.length).toBe(2);
});
