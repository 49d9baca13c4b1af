// What the tools do to the world: rays become picks, blows, drags and new bodies, as commands.
import * as THREE from "three";

const DRAG_EVERY_MS = 66; // 15 Hz
const DRAG_GAIN = 7; // per second: how eagerly a dragged body goes to the pointer
const DRAG_FASTEST = 18; // m/s
/** A body that is faster (m per step) is not where the server sees it now: what the user saw is believed. */
const MOVING = 0.02;

export class Tools {
  /**
   * @param {{view: import("./scene_view.js").SceneView, rig: import("./camera.js").CameraRig,
   *   world: import("./world.js").World, instances: import("./instances.js").Instances,
   *   commands: import("./commands.js").Commands, toolbox: import("./toolbox.js").Toolbox,
   *   select: (what: {slot?: number, staticId?: number} | null) => void, live: () => boolean}} app
   */
  constructor(app) {
    this.app = app;
    this.drag = null;
    this.ghost = new THREE.Mesh(new THREE.BoxGeometry(1, 1, 1), new THREE.MeshBasicMaterial(
      { color: "#8fd0ff", transparent: true, opacity: 0.35, depthWrite: false }));
    this.ghost.add(new THREE.LineSegments(new THREE.EdgesGeometry(this.ghost.geometry), new THREE.LineBasicMaterial({ color: "#cfe8ff" })));
    this.ghost.visible = false;
    app.view.scene.add(this.ghost);
  }

  #ray(at) {
    return this.app.view.rayThrough(at.x, at.y, this.app.rig.camera);
  }

  /** Nearest of body and surface in the picture. */
  #pick(at) {
    const { view, instances } = this.app;
    const ray = this.#ray(at);
    const body = instances.pick(ray);
    const surface = view.pickSurface(ray);
    if (body && !(surface && surface.distance < body.point.distanceTo(ray.ray.origin))) return { body, ray };
    return { surface, ray };
  }

  /** Selects at once what the picture shows, and lets the run correct it. */
  async pickBody(at) {
    const { view, world, app } = { ...this.app, app: this.app };
    const { body, surface, ray } = this.#pick(at);
    if (body) app.select({ slot: body.slot });
    else if (surface?.staticId !== undefined) app.select({ staticId: surface.staticId });
    else app.select(null);
    const id = body ? world.id[body.slot] : null;
    if (!app.live()) return { id, p: body ? view.toWorld(body.point) : null, ray };
    const reply = await app.commands.send({ kind: "ray", ...view.rayInWorld(ray) }, { quiet: true, what: "pick" });
    const hit = reply.ok && reply.result?.hit ? reply.result : null;
    const v = [0, 0, 0];
    const moving = body && world.isAlive(body.slot) && world.velocity(body.slot, v) && Math.hypot(...v) > MOVING;
    if (hit && hit.body !== null && hit.body !== undefined && !moving) {
      const slot = world.slotOfId.get(hit.body);
      if (slot !== undefined && hit.body !== id) app.select({ slot });
      return { id: hit.body, p: hit.p, ray };
    }
    return { id, p: body ? view.toWorld(body.point) : null, ray };
  }

  async pushBody(at) {
    const strength = this.app.toolbox.settings().push;
    const { id, p, ray } = await this.pickBody(at);
    if (id === null) return;
    const J = ray.ray.direction.clone().multiplyScalar(strength).toArray();
    this.app.commands.send({ kind: "impulse", body: id, J, p }, { what: "push" });
  }

  /** @returns {boolean} has something been taken hold of? */
  beginDrag(at) {
    const { body, ray } = this.#pick(at);
    if (!body) return false;
    this.app.select({ slot: body.slot });
    const facing = this.app.rig.camera.getWorldDirection(new THREE.Vector3()).negate();
    const state = this.#centre(body.slot);
    this.drag = {
      slot: body.slot, id: this.app.world.id[body.slot], offset: state.clone().sub(body.point), sent_ms: 0,
      plane: new THREE.Plane().setFromNormalAndCoplanarPoint(facing, body.point), to: state, ray,
    };
    this.timer = setInterval(() => this.#pull(), DRAG_EVERY_MS);
    return true;
  }

  #centre(slot) {
    return this.app.view.toPicture(this.app.world.position(slot));
  }

  moveDrag(at) {
    const point = this.#ray(at).ray.intersectPlane(this.drag.plane, new THREE.Vector3());
    if (point) this.drag.to = point.add(this.drag.offset);
  }

  #pull() {
    const { drag } = this;
    const { world, commands } = this.app;
    if (!drag || !world.isAlive(drag.slot) || world.id[drag.slot] !== drag.id) return this.endDrag();
    if (drag.waiting) return; // a slow run is not flooded
    const v = drag.to.clone().sub(this.#centre(drag.slot)).multiplyScalar(DRAG_GAIN).clampLength(0, DRAG_FASTEST);
    drag.waiting = true;
    commands.send({ kind: "velocity", body: drag.id, v: v.toArray(), w: [0, 0, 0] }, { quiet: true, what: "drag" })
      .then((reply) => {
        drag.waiting = false;
        if (!reply.ok && this.drag === drag) this.endDrag();
      });
  }

  endDrag() {
    clearInterval(this.timer);
    this.drag = null;
  }

  throwBody() {
    const { rig, view, commands, toolbox } = this.app;
    const { shape, size, speed, mass } = toolbox.settings().throw;
    const forward = rig.perspective.getWorldDirection(new THREE.Vector3());
    const eye = rig.perspective.position.clone().addScaledVector(forward, size + 0.5);
    // Aimed a little up, so that it comes down near what is looked at.
    const v = forward.clone().multiplyScalar(speed).add(new THREE.Vector3(0, 0, speed * 0.08));
    const solid = shape === "sphere" ? { kind: "sphere", radius: size / 2 } : { kind: "box", size: [size, size, size] };
    const p = view.toWorld(eye);
    p[2] = Math.max(p[2], size / 2);
    commands.send({ kind: "spawn", shape: solid, mass, p, q: [1, 0, 0, 0], v: v.toArray(), w: [0, 0, 0] }, { what: "throw" });
  }

  #whereToPlace(at) {
    const { body, surface, ray } = this.#pick(at);
    if (surface) return { p: surface.p, normal: surface.normal };
    if (body) return { p: this.app.view.toWorld(body.point), normal: ray.ray.direction.clone().negate().toArray() };
    return null;
  }

  /** What would be placed, where the pointer is. */
  previewPlace(at) {
    const where = at && this.app.live() && this.#whereToPlace(at);
    this.ghost.visible = Boolean(where);
    if (!where) return;
    const { what, size, yaw_deg } = this.app.toolbox.settings().place;
    const extent = what === "box" ? size : [0.5, 0.5, 0.5];
    this.ghost.position.copy(this.app.view.toPicture(where.p)).add(new THREE.Vector3(0, 0, extent[2] / 2));
    this.ghost.rotation.z = THREE.MathUtils.degToRad(yaw_deg);
    this.ghost.scale.set(...extent);
  }

  placeAt(at) {
    const where = this.#whereToPlace(at);
    const { commands, toolbox } = this.app;
    if (!where) return void commands.toast("There is nothing to place it on", "info");
    const place = toolbox.settings().place;
    const half = THREE.MathUtils.degToRad(place.yaw_deg) / 2;
    const q = [Math.cos(half), 0, 0, Math.sin(half)];
    const [x, y, z] = where.p;
    if (place.what === "box") {
      commands.send({ kind: "static", shape: { kind: "box", size: place.size }, p: [x, y, z + place.size[2] / 2], q }, { what: "place" });
    } else if (!place.mesh) {
      commands.toast("Choose a mesh file first", "info");
    } else if (place.as === "static") {
      commands.send({ kind: "static", shape: { kind: "mesh", hash: place.mesh.hash }, p: where.p, q }, { what: "place" });
    } else {
      const shape = { kind: "mesh", hash: place.mesh.hash, as: place.as };
      const p = where.p.map((c, i) => c + where.normal[i] * 0.1 + (i === 2 ? 3 : 0)); // dropped, so that it never starts inside
      commands.send({ kind: "spawn", shape, mass: place.mass, p, q, v: [0, 0, 0], w: [0, 0, 0] }, { what: "drop" });
    }
  }
}
