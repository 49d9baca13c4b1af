// Puts the page together: messages go to the model and the panels, what the user does goes to the run.
import { colourOfHost } from "./colours.js";
import { Commands } from "./commands.js";
import { Connection } from "./connection.js";
import { askForToken, curtain, hint, toast, toggleHelp } from "./dialogs.js";
import { h, iconButton } from "./dom.js";
import { Input, listenToKeys } from "./input.js";
import { NodesPanel, TopBar } from "./panels.js";
import { takeMoves } from "./paths.js";
import { Picture } from "./picture.js";
import { RegionEditor } from "./region_editor.js";
import { Selection } from "./selection.js";
import { Session, tokenFromAddress } from "./session.js";
import { Toolbox, TOOLS } from "./toolbox.js";
import { Tools } from "./tools.js";
import { Transport } from "./transport.js";
import { ViewTeller } from "./view_teller.js";
import { World } from "./world.js";

const world = new World();
const show = { regions: true, auras: false, links: false, contacts: false, velocity: false };
let hello = null;
let scene = null;
let map = null;
let status = null;
let linkState = "connecting";
/** @type {Tools | null} */
let tools = null; // needs the toolbox, and is asked for by it

const canvas = document.getElementById("picture");
const picture = openPicture();
const topBar = new TopBar();
const nodes = new NodesPanel();
const connection = new Connection(new URL("ws", location.href.replace(/^http/, "ws")).href,
  { state: showLink, json: receive, binary: receiveBinary });
const viewTeller = new ViewTeller((message) => connection.send(message));
const session = new Session();
const commands = new Commands((message) => connection.send(message), toast, session, () => askForToken("operate"), reconnect);
const transport = new Transport({
  command: (command, options) => commands.send(command, options),
  replay: (action, value) => commands.replay({ type: "replay", action, ...(value === undefined ? {} : { value }) }),
});
const toolbox = new Toolbox({ onTool: chooseTool, onShow: showOverlay, onThrow: () => tools?.throwBody(), onFile: upload, onRemove: removeSelected }, show);
const selection = new Selection({ world, toolbox, scene: () => scene, picture: () => picture,
  step_s: () => hello?.step_s ?? 1 / 60, watch: (slot) => connection.send({ type: "watch", slot }) });
const isLive = () => connection.connected && hello?.mode === "live";
tools = picture && new Tools({ view: picture.view, rig: picture.rig, instances: picture.instances, world, commands,
  toolbox, live: isLive, select: (what) => selection.choose(what) });
const input = picture && new Input(canvas, { rig: picture.rig, tools, tool: () => toolbox.tool });
const editor = picture && new RegionEditor({ rig: picture.rig, origin: () => picture.view.origin,
  nodes: () => status?.nodes?.length ?? 0, coupled: () => picture.walls.coupled, onclose: () => canvas.focus(),
  apply: (boxes) => commands.send({ kind: "regions", boxes }) });

function openPicture() {
  try {
    return new Picture(canvas, world);
  } catch (error) {
    console.warn(error);
    const note = document.getElementById("no-webgl");
    note.hidden = false;
    note.textContent = "This browser has no WebGL, so the world cannot be drawn. The panels beside work: they show the run as it is.";
    document.body.classList.add("no-picture");
    return null;
  }
}

// ---- messages ----

function receive(message) {
  const handler = { hello: onHello, scene: onScene, moves: onMoves, map: onMap, status: onStatus, body: (m) => selection.tell(m),
    reply: (m) => commands.reply(m), replay: (m) => hello?.mode === "replay" && transport.showReplay(m) }[message.type];
  try {
    handler?.(message);
  } catch (error) {
    // One message that this page does not understand must not end the page.
    console.error(`a message of type ${message.type} was not understood`, error);
  }
}

function onHello(message) {
  hello = message;
  scene = map = status = null;
  world.clear();
  picture?.forget();
  nodes.clear();
  if (editor?.open) editor.close();
  selection.choose(null);
  session.look(); // the overseer may be another one than before
  greeted?.(true);
  transport.setMode(message.mode, message.first, message.last, message.resets, message.step_s);
  toolbox.setMode(message.mode);
  document.body.dataset.mode = message.mode;
  document.title = `${message.scene} · aurasim`;
  topBar.showLink(message.mode === "replay" ? "replay" : "open");
  if (picture) {
    picture.step_s = message.step_s;
    picture.clock.expect(1 / message.step_s / 1000, 1 / message.step_s / message.tick_hz);
  }
  sendShow();
  viewTeller.forget();
  if (document.hidden) viewTeller.hide();
  listScenes(message.scene);
}

function onScene(message) {
  scene = message;
  picture?.setScene(message);
  selection.refresh();
  document.title = `${message.name} · aurasim`;
  chooseScene(message.name);
}

function onMoves(message) {
  if (scene && takeMoves(scene, message)) picture?.showMoves();
}

function onMap(message) {
  map = message;
  picture?.setMap(message);
}

function onStatus(message) {
  status = message;
  topBar.showRun(message.state, message.rate, message.step, hello?.step_s ?? 1 / 60);
  nodes.show(message.nodes ?? [], hello?.step_s ?? 1 / 60);
  if (picture) picture.walls.coupled = (message.nodes ?? []).some(({ exchange }) => exchange === "coupled");
  if (hello?.mode === "live") transport.showRunning(message.state === "running" || message.state === "starting");
  transport.showRate(message.rate);
  selection.refresh();
  updateCurtain();
}

function receiveBinary(message) {
  if (message.kind === "overlay") return void picture?.overlays.apply(message);
  const change = world.apply(message);
  picture?.applyFrame(message, change, performance.now());
  selection.follow();
}

function showLink(state, retryIn_ms) {
  linkState = state;
  document.body.classList.toggle("stale", state !== "open");
  if (state === "closed") {
    commands.dropAll();
    tools?.endDrag();
    session.look().then(askToLook); // it may have been shut out
    topBar.showLink("closed", `offline, again in ${(retryIn_ms / 1000).toFixed(1)} s`);
  } else {
    topBar.showLink(state === "open" ? "open" : "connecting");
  }
  updateCurtain();
}

// ---- who may ----

let greeted = null;
let wontLook = false;

/** @returns {Promise<boolean>} it is connected again */
function reconnect() {
  commands.dropAll();
  return new Promise((resolve) => {
    greeted = resolve;
    setTimeout(() => resolve(false), 8000);
    connection.reopen();
  });
}

let asksToLook = null;

/** Until there is a token that is right, or the user has none. */
function askToLook() {
  asksToLook ??= (async () => {
    while (session.may === "nothing" && !wontLook) {
      const token = await askForToken("look");
      wontLook = token === null;
      await enter(token);
    }
    updateCurtain();
  })().finally(() => { asksToLook = null; });
  return asksToLook;
}

async function enter(token) {
  const why = token && await session.enter(token);
  if (why) toast(why, "bad");
}

async function begin() {
  await enter(tokenFromAddress(location, history));
  await session.look();
  await askToLook();
  if (session.may !== "nothing") connection.start();
}

function updateCurtain() {
  if (wontLook && session.may === "nothing") {
    curtain("A token is needed", "Load the page again to be asked for it.");
  } else if (!hello) {
    curtain("Looking for the run", linkState === "closed" ? "The overseer does not answer. It is asked again and again." : "Connecting to the overseer…");
  } else if (linkState === "open" && status?.state === "starting" && world.size === 0) {
    curtain("The nodes are starting", "The world appears as soon as all regions are there.");
  } else {
    curtain(null);
  }
}

// ---- what the user does ----

function chooseTool(tool) {
  canvas.dataset.tool = tool;
  document.body.dataset.tool = tool;
  if (tools && tool !== "place") tools.previewPlace(null);
}

function sendShow() {
  connection.send({ type: "show", auras: show.auras, links: show.links, contacts: show.contacts });
}

function showOverlay(key, on) {
  show[key] = on;
  if (picture) picture.overlays.show[key] = on;
  sendShow();
}

async function upload(file) {
  const shape = await commands.upload(file);
  if (shape) toolbox.setMesh(file.name, shape);
}

function removeSelected() {
  const command = selection.removal();
  if (command) commands.send(command);
}

function drawRegions() {
  if (!editor) return;
  if (editor.open) return editor.close();
  if (!isLive() || !map) return void toast("There is no map to draw on yet", "info");
  editor.start(map);
}

const sceneChoice = document.getElementById("scenes");
sceneChoice.addEventListener("change", () => {
  commands.send({ kind: "scene", name: sceneChoice.value }).then((reply) => !reply.ok && chooseScene(scene?.name ?? ""));
  sceneChoice.blur();
});

async function listScenes(current) {
  let names = [];
  try {
    names = (await (await fetch("api/scenes")).json()).scenes ?? [];
  } catch {
    // An overseer without a list still has the scene that it shows.
  }
  if (!names.includes(current)) names.unshift(current);
  sceneChoice.replaceChildren(...names.map((name) => h("option", { value: name }, name.replaceAll("_", " "))));
  sceneChoice.disabled = hello?.mode === "replay";
  chooseScene(current);
}

function chooseScene(name) {
  if (name && ![...sceneChoice.options].some((option) => option.value === name)) {
    sceneChoice.append(h("option", { value: name }, name.replaceAll("_", " ")));
  }
  sceneChoice.value = name;
}

function toggleFlying() {
  if (!picture) return;
  picture.rig.flying = !picture.rig.flying;
  flyButton.setAttribute("aria-pressed", String(picture.rig.flying));
  toast(picture.rig.flying ? "Flying: W A S D Q E move, drag looks around" : "Orbiting: drag turns round what you look at", "info");
}

const flyButton = iconButton("fly", "Orbit or fly (C)", toggleFlying, { "aria-pressed": "false", class: "icon wide" });
document.getElementById("top-buttons").append(
  iconButton("frame", "Show everything (F)", () => picture?.frameAll()), flyButton,
  iconButton("regions", "Draw the regions (R)", drawRegions, { id: "draw-regions", class: "icon wide" }),
  iconButton("panels", "Hide or show the panels (H)", togglePanels),
  iconButton("help", "Keys and mouse (?)", toggleHelp, { id: "help" }));

function togglePanels() {
  document.body.classList.toggle("bare");
}

// On a small screen the world comes first.
if (window.matchMedia("(max-width: 860px)").matches) togglePanels();

const tool = (name) => () => hello?.mode !== "replay" && toolbox.setTool(name);
const ifLive = (f) => () => isLive() && f();
listenToKeys({
  " ": () => transport.toggle(), ".": () => transport.step(1), ",": () => transport.stepBack(), "[": () => transport.faster(1 / 1.5), "]": () => transport.faster(1.5),
  m: () => transport.keep(), n: () => transport.goBack(),
  x: ifLive(() => commands.send({ kind: "reset" })), t: ifLive(() => tools?.throwBody()), f: () => picture?.frameAll(), c: toggleFlying,
  delete: ifLive(removeSelected), backspace: ifLive(removeSelected), h: togglePanels, "?": toggleHelp, r: drawRegions,
  escape: () => (editor?.open ? editor.close() : selection.choose(null)),
  b: () => toolbox.flip("regions"), u: () => toolbox.flip("auras"), l: () => toolbox.flip("links"), k: () => toolbox.flip("contacts"),
  v: () => toolbox.flip("velocity"), ...Object.fromEntries(TOOLS.map((name, i) => [String(i + 1), tool(name)])),
}, picture?.rig ?? null);

// ---- drawing ----

let fps = 0;
let shown_ms = 0;
function draw(now_ms) {
  requestAnimationFrame(draw);
  if (picture) {
    fps = picture.draw(now_ms, (at) => toolbox.tool === "place" && tools.previewPlace(at), input.hover);
    if (editor.open) editor.draw();
    if (connection.connected && hello) viewTeller.look(picture.eye, now_ms);
  }
  if (now_ms - shown_ms < 250) return;
  shown_ms = now_ms;
  topBar.showPicture(world.size, fps, picture?.view.quality.current.name ?? "");
  hint(hello && linkState === "open" && status && status.state !== "starting" && world.size === 0 ? "The world is empty. Press T to throw something in." : null);
}
requestAnimationFrame(draw);
document.addEventListener("visibilitychange", () => {
  connection.rest(document.hidden);
  if (document.hidden) return viewTeller.hide();
  viewTeller.look(picture?.eye ?? {}, performance.now());
  connection.hurry();
});
updateCurtain();
connection.rest(document.hidden); // a tab that is opened behind another
begin();

// For tests and the curious: what the page believes, to be read only.
window.aurasim = Object.freeze({
  bodies: () => [...world.slots()].map((slot) => ({ slot, id: world.id[slot], host: world.host[slot], epoch: world.epoch[slot], p: world.position(slot) })),
  get frames() { return world.counts.frames; },
  get lastStamp() { return world.stamp; },
  get shownStamp() { return picture?.clock.playhead ?? NaN; },
  get connected() { return connection.connected && hello !== null; },
  get mode() { return hello?.mode ?? null; },
  get counts() { return { ...world.counts, refused: connection.refused }; },
  get fps() { return fps; },
  get quality() { return picture?.view.quality.current.name ?? null; },
  get device() { return picture?.view.device ?? null; },
  get selected() { return selection.body?.id ?? null; },
  get status() { return status; },
  get scene() { return scene; },
  get map() { return map; },
  get coupledBorders() { return picture?.walls.coupled ?? null; },
  hostColour: (host) => colourOfHost(host),
  colourOf: (id) => (world.slotOfId.has(id) ? picture?.instances.drawnColour(world.slotOfId.get(id)) ?? null : null),
  pixelOf: (id) => (world.slotOfId.has(id) ? picture?.pixelOf(world.slotOfId.get(id)) ?? null : null),
});
