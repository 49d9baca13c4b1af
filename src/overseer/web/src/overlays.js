// What is drawn over the bodies: borders of the regions, auras, links, contacts, velocities, the selected body.
import * as THREE from "three";
import { colourOfHost } from "./colours.js";

const state = { p: new Float64Array(3), q: new Float32Array(4) };
const other = { p: new Float64Array(3), q: new Float32Array(4) };
const v = new Float64Array(3);

/** Lines whose number changes all the time. */
class Lines {
  constructor(colour, opacity) {
    this.object = new THREE.LineSegments(
      new THREE.BufferGeometry(),
      new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity, depthWrite: false }));
    this.object.frustumCulled = false;
    this.object.visible = false;
    this.#reserve(256);
  }

  #reserve(points) {
    this.positions = new Float32Array(points * 3);
    this.object.geometry.dispose();
    this.object.geometry.setAttribute(
      "position", new THREE.BufferAttribute(this.positions, 3).setUsage(THREE.DynamicDrawUsage));
  }

  begin(mostLines) {
    if (mostLines * 6 > this.positions.length) this.#reserve(mostLines * 3);
    this.at = 0;
  }

  line(ax, ay, az, bx, by, bz) {
    this.positions.set([ax, ay, az, bx, by, bz], this.at);
    this.at += 6;
  }

  end() {
    this.object.geometry.setDrawRange(0, this.at / 3);
    this.object.geometry.attributes.position.needsUpdate = true;
  }
}

export class Overlays {
  /** @param {import("./world.js").World} world  @param {import("./instances.js").Instances} instances */
  constructor(world, instances) {
    this.world = world;
    this.instances = instances;
    this.group = new THREE.Group();
    this.show = { auras: false, links: false, contacts: false, velocity: false, regions: true };
    this.latest = null;
    this.links = new Lines("#ffe08a", 0.85);
    this.contacts = new Lines("#ff5d73", 0.95);
    this.velocity = new Lines("#9fd8ff", 0.8);
    this.contacts.object.renderOrder = 3;
    this.contacts.object.material.depthTest = false;
    this.#reserveAuras(256);
    this.outline = new THREE.Group();
    this.outlineMaterial = new THREE.MeshBasicMaterial({ color: "#ffffff", side: THREE.BackSide });
    this.group.add(this.links.object, this.contacts.object, this.velocity.object, this.outline);
  }

  #reserveAuras(capacity) {
    if (this.auras) this.group.remove(this.auras);
    this.auras?.dispose();
    const material = this.auras?.material ?? new THREE.MeshBasicMaterial(
      { transparent: true, opacity: 0.055, depthWrite: false, blending: THREE.AdditiveBlending });
    this.auras = new THREE.InstancedMesh(new THREE.SphereGeometry(1, 16, 12), material, capacity);
    this.auras.instanceColor = new THREE.InstancedBufferAttribute(new Float32Array(capacity * 3), 3);
    this.auras.frustumCulled = false;
    this.auraCapacity = capacity;
    this.group.add(this.auras);
  }

  /** @param {import("./frames.js").Overlay | null} message */
  apply(message) {
    this.latest = message;
  }

  update(stamp, origin, stepsPerSecond) {
    this.#updateAuras(stamp, origin);
    this.#updatePairs(this.links, this.show.links && this.latest?.links, stamp, origin);
    this.#updatePairs(this.contacts, this.show.contacts && this.latest?.contacts, stamp, origin);
    this.#updateVelocity(stamp, origin, stepsPerSecond);
  }

  #updateAuras(stamp, origin) {
    this.auras.visible = Boolean(this.show.auras && this.latest);
    if (!this.auras.visible) return;
    const { auraSlots, auraRadii } = this.latest;
    if (auraSlots.length > this.auraCapacity) this.#reserveAuras(auraSlots.length * 2);
    const matrix = new THREE.Matrix4();
    const colour = new THREE.Color();
    let count = 0;
    for (let i = 0; i < auraSlots.length; ++i) {
      if (!this.world.sample(auraSlots[i], stamp, state)) continue;
      const r = auraRadii[i];
      matrix.makeScale(r, r, r).setPosition(state.p[0] - origin[0], state.p[1] - origin[1], state.p[2] - origin[2]);
      this.auras.setMatrixAt(count, matrix);
      this.auras.setColorAt(count++, colour.set(colourOfHost(this.world.host[auraSlots[i]])));
    }
    this.auras.count = count;
    this.auras.instanceMatrix.needsUpdate = this.auras.instanceColor.needsUpdate = true;
  }

  #updatePairs(lines, pairs, stamp, origin) {
    lines.object.visible = Boolean(pairs && pairs.length);
    if (!lines.object.visible) return;
    lines.begin(pairs.length / 2);
    for (let i = 0; i < pairs.length; i += 2) {
      if (!this.world.sample(pairs[i], stamp, state) || !this.world.sample(pairs[i + 1], stamp, other)) continue;
      lines.line(state.p[0] - origin[0], state.p[1] - origin[1], state.p[2] - origin[2],
        other.p[0] - origin[0], other.p[1] - origin[1], other.p[2] - origin[2]);
    }
    lines.end();
  }

  /** As far as the body goes in a third of a second. */
  #updateVelocity(stamp, origin, stepsPerSecond) {
    this.velocity.object.visible = this.show.velocity;
    if (!this.show.velocity) return;
    const scale = stepsPerSecond * 0.33;
    this.velocity.begin(this.world.size);
    for (const slot of this.world.slots()) {
      if (!this.world.velocity(slot, v) || !this.world.sample(slot, stamp, state)) continue;
      const [x, y, z] = [state.p[0] - origin[0], state.p[1] - origin[1], state.p[2] - origin[2]];
      this.velocity.line(x, y, z, x + v[0] * scale, y + v[1] * scale, z + v[2] * scale);
    }
    this.velocity.end();
  }

  /** A white seam round the selected body: its own shape from behind, a little larger. */
  outlineBody(slot, cameraDistance) {
    const parts = slot === null ? [] : this.instances.partsOf(slot);
    while (this.outline.children.length > parts.length) this.outline.remove(this.outline.children.at(-1));
    parts.forEach(({ geometry, matrix }, i) => {
      let mesh = this.outline.children[i];
      if (!mesh) {
        mesh = new THREE.Mesh(geometry, this.outlineMaterial);
        mesh.matrixAutoUpdate = false;
        this.outline.add(mesh);
      }
      mesh.geometry = geometry;
      geometry.boundingSphere ?? geometry.computeBoundingSphere();
      const grow = 1 + Math.min(0.6, (0.03 + cameraDistance * 0.0022) / Math.max(0.05, geometry.boundingSphere.radius));
      mesh.matrix.copy(matrix).scale(new THREE.Vector3(grow, grow, grow));
      mesh.matrixWorldNeedsUpdate = true;
    });
  }

  clear() {
    this.latest = null;
    this.outlineBody(null, 1);
  }
}
