// The camera: orbit round a point or fly, and a view from straight above for drawing regions. z is up.
import * as THREE from "three";

const UP = new THREE.Vector3(0, 0, 1);
const STEEPEST = Math.PI / 2 - 0.02;

export class CameraRig {
  constructor() {
    this.perspective = new THREE.PerspectiveCamera(50, 1, 0.1, 6000);
    this.above = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 4000);
    this.perspective.up.copy(UP);
    this.above.up.set(0, 1, 0);
    this.target = new THREE.Vector3(0, 0, 1);
    this.yaw = -2.05;
    this.pitch = 0.42;
    this.distance = 34;
    this.flying = false;
    this.fromAbove = false;
    this.aspect = 1;
    // What is shown runs after what is wanted.
    this.shown = { target: this.target.clone(), yaw: this.yaw, pitch: this.pitch, distance: this.distance };
    this.keys = new Set();
    this.topHeight = 60; // m, what the view from above spans vertically
    this.topCentre = new THREE.Vector2();
    this.update(0);
  }

  get camera() {
    return this.fromAbove ? this.above : this.perspective;
  }

  resize(width, height) {
    this.aspect = width / Math.max(1, height);
    this.perspective.aspect = this.aspect;
    this.perspective.updateProjectionMatrix();
  }

  /** Dragged by so many pixels. */
  turn(dx, dy) {
    const pace = this.flying ? 0.0028 : 0.005;
    const eye = this.#eye(this);
    this.yaw -= dx * pace;
    this.pitch = THREE.MathUtils.clamp(this.pitch + dy * pace, this.flying ? -STEEPEST : -0.35, STEEPEST);
    // Flying turns about the eye: the target swings round it.
    if (this.flying) this.target.copy(eye).addScaledVector(this.#outward(this), -this.distance);
  }

  pan(dx, dy, height) {
    const scale = (2 * this.distance * Math.tan(THREE.MathUtils.degToRad(this.perspective.fov / 2))) / Math.max(1, height);
    const { right, up } = this.#axes();
    this.target.addScaledVector(right, -dx * scale).addScaledVector(up, dy * scale);
  }

  zoom(factor) {
    this.distance = THREE.MathUtils.clamp(this.distance * factor, 0.6, 1500);
  }

  /** Shows everything within a sphere. */
  frame(centre, radius) {
    const half = THREE.MathUtils.degToRad(this.perspective.fov / 2);
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.aspect));
    this.target.copy(centre);
    this.distance = THREE.MathUtils.clamp(radius / Math.sin(narrow), 3, 1500);
  }

  /** No gliding to the place: the scene is another one. */
  jump() {
    this.shown.target.copy(this.target);
    Object.assign(this.shown, { yaw: this.yaw, pitch: this.pitch, distance: this.distance });
  }

  #outward({ yaw, pitch }) {
    return new THREE.Vector3(Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch));
  }

  #eye(state) {
    return state.target.clone().addScaledVector(this.#outward(state), state.distance);
  }

  #axes() {
    const outward = this.#outward(this);
    const right = new THREE.Vector3().crossVectors(UP, outward).normalize();
    return { outward, right, up: new THREE.Vector3().crossVectors(outward, right) };
  }

  #walk(dt_s) {
    if (this.keys.size === 0) return;
    const { outward, right } = this.#axes();
    const forward = this.flying ? outward.negate() : outward.negate().setZ(0).normalize();
    const pace = dt_s * THREE.MathUtils.clamp(this.distance * 0.9, 6, 120) * (this.keys.has("shift") ? 3 : 1);
    const pull = (plus, minus) => (this.keys.has(plus) ? 1 : 0) - (this.keys.has(minus) ? 1 : 0);
    this.target.addScaledVector(forward, pull("w", "s") * pace).addScaledVector(right, pull("d", "a") * pace);
    this.target.z += pull("e", "q") * pace;
  }

  update(dt_s) {
    this.#walk(dt_s);
    const follow = 1 - Math.exp(-dt_s * 14);
    const { shown } = this;
    shown.target.lerp(this.target, follow);
    shown.yaw += (this.yaw - shown.yaw) * follow;
    shown.pitch += (this.pitch - shown.pitch) * follow;
    shown.distance += (this.distance - shown.distance) * follow;
    // Flying: a look to the side must not drag the eye through the glide of the target.
    if (this.flying) this.jump();
    this.perspective.position.copy(this.#eye(shown));
    this.perspective.lookAt(shown.target);
    this.perspective.near = Math.max(0.05, shown.distance * 0.004);
    this.perspective.updateProjectionMatrix();
    this.#updateAbove();
    this.camera.updateMatrixWorld();
  }

  #updateAbove() {
    const half = this.topHeight / 2;
    Object.assign(this.above, { left: -half * this.aspect, right: half * this.aspect, top: half, bottom: -half });
    this.above.position.set(this.topCentre.x, this.topCentre.y, 1500);
    this.above.lookAt(this.topCentre.x, this.topCentre.y, 0);
    this.above.updateProjectionMatrix();
  }
}
