// All bodies, drawn as instances: one InstancedMesh for each part of each prototype's shape.
import * as THREE from "three";
import { asleep, channels, colourOfHost } from "./colours.js";
import { MergedMesh } from "./merged.js";
import { partsOf } from "./shapes.js";

const FLASH_MS = 450;
const state = { p: new Float64Array(3), q: new Float32Array(4) };
const bodyMatrix = new THREE.Matrix4();
const partMatrix = new THREE.Matrix4();
const rotation = new THREE.Quaternion();
const where = new THREE.Vector3();
const unit = new THREE.Vector3(1, 1, 1);
const colour = new THREE.Color();

/** The bodies of one prototype. Instance i of every part is the body in slots[i]. */
class Batch {
  constructor(group, shape, look) {
    this.group = group;
    this.shape = shape;
    this.slots = [];
    this.capacity = 64;
    this.rebuild(look);
  }

  rebuild(look) {
    this.dispose();
    this.parts = partsOf(this.shape, look.detail).map(({ geometry, place }) => {
      const mesh = look.merged ? new MergedMesh(geometry, look.material, this.capacity) : instanced(geometry, look.material, this.capacity);
      mesh.count = this.slots.length;
      mesh.castShadow = mesh.receiveShadow = look.shadows;
      mesh.frustumCulled = false; // its bounds change every frame; finding them costs more than drawing
      mesh.userData.batch = this;
      this.group.add(mesh);
      return { mesh, place };
    });
  }

  grow(look) {
    this.capacity *= 2;
    this.rebuild(look);
  }

  setMatrix(index, matrix) {
    for (const { mesh, place } of this.parts) {
      mesh.setMatrixAt(index, place ? partMatrix.multiplyMatrices(matrix, place) : matrix);
    }
  }

  setColour(index, value) {
    for (const { mesh } of this.parts) mesh.setColorAt(index, value);
  }

  upload(matrices, colours) {
    for (const { mesh } of this.parts) {
      mesh.count = this.slots.length;
      if (mesh instanceof MergedMesh) {
        mesh.upload(matrices, colours);
        continue;
      }
      if (matrices) mesh.instanceMatrix.needsUpdate = true;
      if (colours) mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null; // picking would use the one of long ago
    }
  }

  dispose() {
    for (const { mesh } of this.parts ?? []) {
      this.group.remove(mesh);
      mesh.geometry.dispose();
      mesh.dispose();
    }
  }
}

function instanced(geometry, material, capacity) {
  const mesh = new THREE.InstancedMesh(geometry, material, capacity);
  mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
  mesh.instanceColor = new THREE.InstancedBufferAttribute(new Float32Array(capacity * 3), 3);
  return mesh;
}

export class Instances {
  /** @param {import("./world.js").World} world  @param {boolean} merged  for renderers in software */
  constructor(world, merged = false) {
    this.world = world;
    this.merged = merged;
    this.group = new THREE.Group();
    this.batches = [];
    this.place = new Map(); // slot -> { batch, index, settled }
    this.flashes = new Map(); // slot -> when it began, ms
    this.dirtyColours = new Set();
    this.look = { detail: 2, shadows: false, merged, material: materialFor(2, merged) };
  }

  /** @param {{prototypes: {shape: number}[], shapes: any[]}} scene */
  setScene(scene) {
    for (const batch of this.batches) batch.dispose();
    this.batches = scene.prototypes.map(({ shape }) => new Batch(this.group, scene.shapes[shape], this.look));
    const slots = [...this.world.slots()];
    this.clear();
    slots.forEach((slot) => this.add(slot));
  }

  /** @param {number} detail @param {boolean} shadows */
  setLook(detail, shadows) {
    if (detail === this.look.detail && shadows === this.look.shadows) return;
    this.look = { detail, shadows, merged: this.merged, material: materialFor(detail, this.merged) };
    for (const batch of this.batches) batch.rebuild(this.look);
    this.#touchAll();
  }

  clear() {
    for (const batch of this.batches) batch.slots.length = 0;
    this.place.clear();
    this.flashes.clear();
    this.dirtyColours.clear();
    for (const batch of this.batches) batch.upload(true, true);
  }

  /** @param {ReturnType<import("./world.js").World["apply"]>} change */
  apply(change, now_ms) {
    if (change.cleared) this.clear();
    for (const slot of change.removed) this.remove(slot);
    for (const slot of change.added) this.add(slot);
    for (const slot of change.rehosted) this.dirtyColours.add(slot);
    for (const slot of change.handedOver) this.flashes.set(slot, now_ms);
  }

  add(slot) {
    const batch = this.batches[this.world.prototype[slot]];
    if (!batch || !this.world.isAlive(slot)) return; // the scene that explains it is still to come
    if (this.place.has(slot)) this.remove(slot);
    if (batch.slots.length === batch.capacity) {
      batch.grow(this.look);
      this.#touchAll();
    }
    this.place.set(slot, { batch, index: batch.slots.length, settled: false });
    batch.slots.push(slot);
    this.dirtyColours.add(slot);
  }

  remove(slot) {
    const at = this.place.get(slot);
    if (!at) return;
    this.place.delete(slot);
    this.flashes.delete(slot);
    const last = at.batch.slots.pop();
    if (last === slot) return;
    at.batch.slots[at.index] = last;
    const moved = this.place.get(last);
    moved.index = at.index;
    moved.settled = false;
    this.dirtyColours.add(last);
  }

  #touchAll() {
    for (const [slot, at] of this.place) {
      at.settled = false;
      this.dirtyColours.add(slot);
    }
  }

  /** The scene's origin moved: everything has to be placed anew. */
  shift() {
    this.#touchAll();
  }

  /** Places every body as it is at `stamp`. */
  update(stamp, origin, now_ms) {
    for (const batch of this.batches) batch.moved = batch.recoloured = false;
    for (const [slot, at] of this.place) {
      const settles = this.world.isSettled(slot, stamp);
      if (at.settled && settles) continue;
      at.settled = settles;
      if (!this.#pose(slot, stamp, origin)) bodyMatrix.makeScale(0, 0, 0); // it has no position yet
      at.batch.setMatrix(at.index, bodyMatrix);
      at.batch.moved = true;
    }
    this.#recolour(now_ms);
    for (const batch of this.batches) batch.upload(batch.moved, batch.recoloured);
  }

  /** A frame has moved these: what was settled no longer is. */
  wake(slots) {
    for (const slot of slots) {
      const at = this.place.get(slot);
      if (at) at.settled = false;
    }
  }

  #pose(slot, stamp, origin) {
    if (!this.world.sample(slot, stamp, state)) return false;
    where.set(state.p[0] - origin[0], state.p[1] - origin[1], state.p[2] - origin[2]);
    bodyMatrix.compose(where, rotation.set(state.q[1], state.q[2], state.q[3], state.q[0]), unit);
    return true;
  }

  #recolour(now_ms) {
    for (const slot of this.flashes.keys()) this.dirtyColours.add(slot);
    for (const slot of this.dirtyColours) {
      const at = this.place.get(slot);
      if (!at) continue;
      let rgb = channels(colourOfHost(this.world.host[slot]));
      if (this.world.isAsleep(slot)) rgb = asleep(rgb);
      colour.setRGB(...rgb, THREE.SRGBColorSpace);
      const age = (now_ms - (this.flashes.get(slot) ?? -Infinity)) / FLASH_MS;
      if (age < 1) colour.addScalar(1.4 * (1 - age) ** 2);
      else this.flashes.delete(slot);
      at.batch.setColour(at.index, colour);
      at.batch.recoloured = true;
    }
    this.dirtyColours.clear();
  }

  /** What is drawn for a body now, for tests. @returns {string | null} "#rrggbb" */
  drawnColour(slot) {
    const at = this.place.get(slot);
    if (!at || at.batch.parts.length === 0) return null;
    at.batch.parts[0].mesh.getColorAt(at.index, colour);
    return `#${colour.getHexString(THREE.SRGBColorSpace)}`;
  }

  /** @param {THREE.Raycaster} ray @returns {{slot: number, point: THREE.Vector3} | null} */
  pick(ray) {
    const [hit] = ray.intersectObject(this.group, true);
    if (!hit) return null;
    const slot = hit.object.userData.batch.slots[hit.instanceId];
    return slot === undefined ? null : { slot, point: hit.point };
  }

  /** Matrix and parts of one body, to draw an outline round it. */
  partsOf(slot) {
    const at = this.place.get(slot);
    if (!at) return [];
    return at.batch.parts.map(({ mesh }) => {
      const matrix = new THREE.Matrix4();
      mesh.getMatrixAt(at.index, matrix);
      return { geometry: mesh.source ?? mesh.geometry, matrix };
    });
  }
}

const materials = new Map();
/** Coarse: the cheapest light, for machines without a graphics card. */
function materialFor(detail, vertexColors) {
  const key = `${detail < 2} ${vertexColors}`;
  if (!materials.has(key)) {
    materials.set(key, detail < 2
      ? new THREE.MeshLambertMaterial({ vertexColors })
      : new THREE.MeshStandardMaterial({ vertexColors, roughness: 0.5, metalness: 0.05 }));
  }
  return materials.get(key);
}
