// The picture: renderer, lights, ground and statics, and what is under the pointer. Places are world coordinates
// outside and relative to `origin` inside, since single precision is too coarse far out.
import * as THREE from "three";
import { HORIZON, groundFor, sky } from "./ground.js";
import { placeOfStatic } from "./paths.js";
import { LEVELS, Quality } from "./quality.js";
import { partsOf, placeOf } from "./shapes.js";

const LONGEST_PREPARATION_MS = 3000;
const SOFTWARE = /swiftshader|llvmpipe|software|basic render/i;
const STATIC_COLOUR = "#69748a";

export class SceneView {
  /** @param {HTMLCanvasElement} canvas  @throws if there is no WebGL */
  constructor(canvas) {
    this.device = deviceName();
    this.software = SOFTWARE.test(this.device);
    // Smooth edges cost a processor that draws by itself four times the work.
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.software, powerPreference: "high-performance" });
    this.renderer.debug.checkShaderErrors = false; // asking for errors waits for the compiler
    this.renderer.setClearColor(HORIZON);
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.quality = new Quality(this.software ? 3 : 5, pinnedLevel());
    this.origin = [0, 0, 0];
    this.scene = new THREE.Scene();
    this.scene.fog = new THREE.Fog(HORIZON, 80, 400);
    this.sky = sky();
    this.statics = new THREE.Group();
    this.grounds = new THREE.Group();
    this.litStatic = new THREE.MeshStandardMaterial({ color: STATIC_COLOUR, roughness: 0.85, side: THREE.DoubleSide });
    this.plainStatic = new THREE.MeshLambertMaterial({ color: STATIC_COLOUR, side: THREE.DoubleSide });
    this.edgeMaterial = new THREE.LineBasicMaterial({ color: "#9aa7bf", transparent: true, opacity: 0.35 });
    this.raycaster = new THREE.Raycaster();
    this.#addLights();
    this.scene.add(this.sky, this.grounds, this.statics);
    this.showScene({ statics: [], shapes: [] });
  }

  #addLights() {
    this.scene.add(new THREE.HemisphereLight("#cfdcff", "#4a4a58", 1.9));
    this.key = new THREE.DirectionalLight("#fff1dc", 3.0);
    this.keyOffset = new THREE.Vector3(-0.45, -0.6, 1).normalize();
    this.key.shadow.bias = -0.0006;
    this.key.shadow.normalBias = 0.04;
    const rim = new THREE.DirectionalLight("#8fb4ff", 0.9);
    rim.position.set(0.7, 0.9, 0.35);
    this.scene.add(this.key, this.key.target, rim);
  }

  /** There may be new shaders: they are compiled beside the page, which would otherwise stand still for seconds. */
  prepare() {
    this.unprepared = true;
  }

  #isPrepared(camera) {
    if (this.unprepared && !this.compiling) {
      this.unprepared = false;
      // A material that is taken away meanwhile is never ready: the wait has an end.
      const longest = new Promise((resolve) => setTimeout(resolve, LONGEST_PREPARATION_MS));
      const done = () => { this.compiling = false; };
      this.compiling = true;
      Promise.race([this.renderer.compileAsync(this.scene, camera), longest]).then(done, done);
    }
    return !this.compiling;
  }

  /** @param {{statics: any[], shapes: any[]}} message */
  showScene(message) {
    this.sceneMessage = message;
    this.prepare();
    for (const group of [this.statics, this.grounds]) dispose(group);
    this.parts = [];
    for (const body of message.statics) this.#addStatic(body, message.shapes[body.shape]);
    this.findMoving();
    if (this.grounds.children.length === 0) this.grounds.add(groundFor(null, this.origin, this.lit));
    this.#alignGrids();
  }

  #addStatic(body, shape) {
    if (!shape) return;
    const place = placeOf(body.p, body.q);
    if (shape.kind === "plane") return void this.grounds.add(groundFor(planeAt(shape, place), this.origin, this.lit));
    place.premultiply(new THREE.Matrix4().makeTranslation(...this.origin.map((x) => -x)));
    for (const part of partsOf(shape, 3, new THREE.Matrix4())) {
      const mesh = new THREE.Mesh(part.geometry, this.lit ? this.litStatic : this.plainStatic);
      const inStatic = part.place ?? new THREE.Matrix4();
      mesh.applyMatrix4(place.clone().multiply(inStatic));
      this.parts.push({ mesh, body, inStatic });
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.userData.staticId = body.id;
      mesh.add(new THREE.LineSegments(new THREE.EdgesGeometry(part.geometry, 25), this.edgeMaterial));
      this.statics.add(mesh);
    }
  }

  /** Among the statics of the scene. */
  findMoving() {
    this.moving = this.parts.filter(({ body }) => body.path || body.moves);
  }

  /** Puts the statics that move where they are. */
  moveStatics(stamp, step_s) {
    if (!(stamp >= 0)) return;
    const origin = new THREE.Matrix4().makeTranslation(...this.origin.map((x) => -x));
    for (const { mesh, body, inStatic } of this.moving) {
      origin.clone().multiply(placeOfStatic(body, stamp, step_s)).multiply(inStatic)
        .decompose(mesh.position, mesh.quaternion, mesh.scale);
    }
  }

  /** Lines of the grid stand at whole metres of the world, wherever the origin of the picture is. */
  #alignGrids() {
    for (const { material } of this.grounds.children) {
      material.userData.gridOffset.value.set(this.origin[0] % 10, this.origin[1] % 10);
    }
  }

  /** @param {number[]} origin  in the world */
  moveOrigin(origin) {
    this.origin = origin;
    this.showScene(this.sceneMessage);
  }

  resize(width, height) {
    this.size = [width, height];
    const ratio = Math.min(this.quality.current.pixels, this.quality.current.pixels < 1 ? 1 : window.devicePixelRatio || 1);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /** Brings the renderer to the level that the frame times allow. */
  applyQuality() {
    const { shadows } = this.quality.current;
    this.renderer.toneMapping = this.lit ? THREE.NeutralToneMapping : THREE.NoToneMapping;
    this.renderer.shadowMap.enabled = shadows > 0;
    this.key.castShadow = shadows > 0;
    if (shadows && this.key.shadow.mapSize.x !== shadows) {
      this.key.shadow.mapSize.set(shadows, shadows);
      this.key.shadow.map?.dispose();
      this.key.shadow.map = null;
    }
    this.litStatic.needsUpdate = true;
    this.showScene(this.sceneMessage);
    if (this.size) this.resize(...this.size);
  }

  /**
   * @param {THREE.Camera} camera
   * @param {THREE.Vector3} focus  what is looked at, for shadows and fog
   * @param {number} distance  from the camera to it
   */
  render(camera, focus, distance) {
    const reach = THREE.MathUtils.clamp(distance * 0.9, 14, 110);
    const { camera: light } = this.key.shadow;
    if (Math.abs(light.right - reach) > reach * 0.1) {
      [light.left, light.right, light.bottom, light.top] = [-reach, reach, -reach, reach];
      [light.near, light.far] = [1, reach * 6];
      light.updateProjectionMatrix();
    }
    // In steps of a texel or so: shadows that slide with the camera shimmer.
    const texel = (2 * reach) / this.key.shadow.mapSize.x;
    for (const axis of ["x", "y", "z"]) this.key.target.position[axis] = Math.round(focus[axis] / texel) * texel;
    this.key.position.copy(this.key.target.position).addScaledVector(this.keyOffset, reach * 3);
    const flat = camera.isOrthographicCamera;
    this.scene.fog.near = flat ? 1e5 : 60 + distance * 1.6;
    this.scene.fog.far = flat ? 1e6 : 320 + distance * 6;
    this.sky.visible = !flat && this.lit;
    this.sky.position.copy(camera.position);
    if (this.#isPrepared(camera)) this.renderer.render(this.scene, camera);
  }

  /** @returns {THREE.Raycaster} through a point of the picture, -1 to 1 */
  rayThrough(x, y, camera) {
    this.raycaster.setFromCamera(new THREE.Vector2(x, y), camera);
    this.raycaster.far = Infinity;
    return this.raycaster;
  }

  /** From and to of a ray in the world, for the server. */
  rayInWorld(ray, length = 2000) {
    const to = ray.ray.at(length, new THREE.Vector3());
    return { from: this.toWorld(ray.ray.origin), to: this.toWorld(to) };
  }

  /** Ground or static that a ray meets. @returns {{p: number[], normal: number[], staticId?: number} | null} */
  pickSurface(ray) {
    const grounds = this.grounds.children.filter((ground) => ground.userData.surface);
    const [hit] = ray.intersectObjects([...(grounds.length ? grounds : this.grounds.children), ...this.statics.children], false);
    if (!hit) return null;
    const normal = hit.face.normal.clone().transformDirection(hit.object.matrixWorld);
    if (normal.dot(ray.ray.direction) > 0) normal.negate();
    return { p: this.toWorld(hit.point), normal: normal.toArray(), staticId: hit.object.userData.staticId,
      distance: hit.distance };
  }

  toWorld(p) {
    return [p.x + this.origin[0], p.y + this.origin[1], p.z + this.origin[2]];
  }

  toPicture(p) {
    return new THREE.Vector3(p[0] - this.origin[0], p[1] - this.origin[1], p[2] - this.origin[2]);
  }

  /** Is there time for light on every point of the ground, a sky, shadows? */
  get lit() {
    return this.quality.current.detail > 1;
  }
}

function planeAt(shape, place) {
  const normal = new THREE.Vector3(...shape.normal).normalize();
  const point = normal.clone().multiplyScalar(shape.offset ?? 0).applyMatrix4(place);
  normal.transformDirection(place);
  return { normal: normal.toArray(), offset: normal.dot(point) };
}

function dispose(group) {
  group.traverse((object) => object.geometry?.dispose());
  group.clear();
}

function deviceName() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) throw new Error("there is no WebGL 2");
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return name;
}

/** `?quality=best` holds a level, whatever the frame times are. */
function pinnedLevel() {
  const level = LEVELS.findIndex(({ name }) => name === new URLSearchParams(location.search).get("quality"));
  return level < 0 ? null : level;
}
