// The picture of the world: what is drawn and when. Holds everything that needs WebGL, so that the page works without.
import * as THREE from "three";
import { CameraRig } from "./camera.js";
import { GRID_M } from "./frames.js";
import { StampClock } from "./clock.js";
import { Instances } from "./instances.js";
import { Overlays } from "./overlays.js";
import { RegionWalls } from "./region_walls.js";
import { SceneView } from "./scene_view.js";
import { radiusOf } from "./shapes.js";
import { extentOf, boxesOfMap } from "./region_maths.js";

/** Beyond this many metres the origin of the picture moves to the bodies: floats are too coarse there. */
const FAR_OUT = 2000;
/** Radians around the picture in which bodies are told as exactly as within: the camera may turn. */
const BESIDE_PICTURE = 0.15;

export class Picture {
  /** @param {HTMLCanvasElement} canvas @param {import("./world.js").World} world @throws without WebGL */
  constructor(canvas, world) {
    this.world = world;
    this.canvas = canvas;
    this.view = new SceneView(canvas);
    this.rig = new CameraRig();
    this.clock = new StampClock();
    this.instances = new Instances(world, this.view.software);
    this.overlays = new Overlays(world, this.instances);
    this.walls = new RegionWalls();
    this.view.scene.add(this.instances.group, this.overlays.group, this.walls.group);
    this.step_s = 1 / 60;
    this.map = null;
    this.scene = null;
    this.selectedSlot = null;
    this.last_ms = NaN;
    this.resize();
    this.#applyQuality();
    window.addEventListener("resize", () => this.resize());
  }

  resize() {
    const [width, height] = [window.innerWidth, window.innerHeight];
    this.view.resize(width, height);
    this.rig.resize(width, height);
  }

  #applyQuality() {
    const { detail, shadows } = this.view.quality.current;
    this.instances.setLook(detail, shadows > 0);
    this.view.applyQuality();
    // Blurred glass over a picture that changes all the time is dear without a graphics card, too.
    document.body.classList.toggle("spare", !this.view.lit);
  }

  /** Nothing of an earlier connection stays. */
  forget() {
    this.world.clear();
    this.clock.reset();
    this.instances.clear();
    this.overlays.clear();
    this.selectedSlot = null;
    this.framed = null;
  }

  setScene(scene) {
    this.scene = scene;
    this.view.showScene(scene);
    this.instances.setScene(scene);
  }

  /** Statics of the scene have been told to move. */
  showMoves() {
    this.view.findMoving();
  }

  setMap(map) {
    this.map = map;
    this.#showRegions();
  }

  #showRegions() {
    this.reach = this.#reachOfBodies();
    this.walls.showMap(this.map, this.view.origin, this.reach);
  }

  /** Where bodies are, but for a few that strayed. @returns {number[] | null} [x0, y0, x1, y1] */
  #reachOfBodies() {
    const places = [...this.world.slots()].map((slot) => this.world.position(slot));
    if (places.length === 0) return null;
    const range = [0, 1].map((axis) => {
      const sorted = places.map((p) => p[axis]).sort((a, b) => a - b);
      return [sorted[Math.floor(sorted.length * 0.02)], sorted[Math.floor((sorted.length - 1) * 0.98)]];
    });
    return [range[0][0], range[1][0], range[0][1], range[1][1]];
  }

  /** Now and then: have the bodies spread far beyond what is drawn of their regions? */
  #followBodies(now_ms) {
    if (now_ms - (this.followed_ms ?? 0) < 3000) return;
    this.followed_ms = now_ms;
    const reach = this.#reachOfBodies();
    const spare = reach && 0.15 * Math.max(reach[2] - reach[0], reach[3] - reach[1], 20);
    if (reach && (!this.reach || reach.some((x, i) => Math.abs(x - this.reach[i]) > spare))) this.#showRegions();
  }

  /** @param {import("./frames.js").Frame} frame */
  applyFrame(frame, change, now_ms) {
    if (frame.key) {
      this.overlays.clear();
      this.view.prepare();
      this.#chooseOrigin(frame);
    }
    this.instances.apply(change, now_ms);
    this.instances.wake(frame.movedSlots);
    this.clock.arrive(frame.stamp, now_ms);
    const name = this.scene?.name ?? "";
    if (frame.key && this.framed !== name) {
      this.framed = name;
      this.#showRegions();
      this.frameAll();
      this.rig.jump();
    }
  }

  #chooseOrigin(frame) {
    const middle = [0, 1, 2].map((axis) => median(frame.movedP, axis) * GRID_M);
    const origin = middle.map((x) => (Math.abs(x) > FAR_OUT ? Math.round(x / 1000) * 1000 : 0));
    if (origin.every((x, i) => x === this.view.origin[i])) return;
    this.view.moveOrigin(origin);
    this.#showRegions();
    this.instances.shift();
    this.framed = null;
  }

  /** Shows all bodies but for a few that strayed; without bodies the middle of the map. */
  frameAll() {
    const centres = [...this.world.slots()].map((slot) => this.view.toPicture(this.world.position(slot)));
    for (const body of this.view.sceneMessage.statics) {
      const shape = this.view.sceneMessage.shapes[body.shape];
      if (shape && radiusOf(shape) > 0) centres.push(this.view.toPicture(body.p));
    }
    if (centres.length === 0) return this.#frameMap();
    const centre = new THREE.Vector3(...["x", "y", "z"].map((axis) => {
      const sorted = centres.map((p) => p[axis]).sort((a, b) => a - b);
      return (sorted[Math.floor(sorted.length * 0.03)] + sorted[Math.floor(sorted.length * 0.97)]) / 2;
    }));
    const distances = centres.map((p) => p.distanceTo(centre)).sort((a, b) => a - b);
    this.rig.frame(centre, Math.max(4, distances[Math.floor(distances.length * 0.97)] * 0.78 + 1.5));
  }

  #frameMap() {
    const [x0, y0, x1, y1] = extentOf(this.map ? boxesOfMap(this.map.regions) : [], 12);
    this.rig.frame(this.view.toPicture([(x0 + x1) / 2, (y0 + y1) / 2, 1]), Math.hypot(x1 - x0, y1 - y0) * 0.4);
  }

  /** @returns {number} frames per second, 0 while unknown */
  draw(now_ms, tools, hover) {
    const dt_ms = Number.isNaN(this.last_ms) ? 16 : now_ms - this.last_ms;
    this.last_ms = now_ms;
    this.rig.update(Math.min(0.1, dt_ms / 1000));
    const stamp = this.clock.tick(now_ms);
    const { origin } = this.view;
    this.instances.update(stamp, origin, now_ms);
    this.view.moveStatics(stamp, this.step_s);
    this.overlays.update(stamp, origin, 1 / this.step_s);
    const distance = this.selectedSlot === null ? 1
      : this.view.toPicture(this.world.position(this.selectedSlot)).distanceTo(this.rig.camera.position);
    this.overlays.outlineBody(this.selectedSlot, this.rig.fromAbove ? 10 : distance);
    this.walls.group.visible = this.overlays.show.regions && !this.rig.fromAbove;
    this.#followBodies(now_ms);
    this.walls.update(this.rig.perspective);
    tools(hover);
    const focus = this.rig.fromAbove ? new THREE.Vector3(this.rig.topCentre.x, this.rig.topCentre.y, 0) : this.rig.shown.target;
    this.view.render(this.rig.camera, focus, this.rig.fromAbove ? this.rig.topHeight : this.rig.shown.distance);
    if (this.view.quality.frame(dt_ms)) this.#applyQuality();
    return this.view.quality.frame_ms ? 1000 / this.view.quality.frame_ms : 0;
  }

  /**
   * What the overseer has to know of the picture to leave out what nobody would see: docs/viewer.md, "JSON from the page". Nothing of
   * the view from above, where all is shown.
   */
  get eye() {
    if (this.rig.fromAbove) return {};
    const camera = this.rig.perspective;
    const half = THREE.MathUtils.degToRad(camera.fov / 2);
    const towards = camera.getWorldDirection(new THREE.Vector3());
    return { eye: this.view.toWorld(camera.position), towards: towards.toArray(),
      half_angle: Math.atan(Math.tan(half) * Math.hypot(1, camera.aspect)) + BESIDE_PICTURE,
      pixel: (2 * Math.tan(half)) / Math.max(1, this.canvas.clientHeight) };
  }

  /** Where a body is on the page, in pixels: for tests. */
  pixelOf(slot) {
    const p = { p: [0, 0, 0], q: [1, 0, 0, 0] };
    if (!this.world.sample(slot, this.clock.playhead, p)) return null;
    const seen = this.view.toPicture(p.p).project(this.rig.camera);
    return { x: ((seen.x + 1) / 2) * this.canvas.clientWidth, y: ((1 - seen.y) / 2) * this.canvas.clientHeight, inFront: seen.z < 1 };
  }
}

function median(points, axis) {
  const values = [];
  for (let i = axis; i < points.length; i += 3) values.push(points[i]);
  values.sort((a, b) => a - b);
  return values[values.length >> 1] ?? 0;
}
