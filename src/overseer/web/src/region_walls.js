// The regions in the picture: translucent walls on their borders, a breath of their colour on the ground, their numbers.
import * as THREE from "three";
import { colourOfHost } from "./colours.js";
import { boxesOfMap, bordersOf, extentOf } from "./region_maths.js";

const WALL_HEIGHT = 7; // m
const TINT_HEIGHT = 0.012; // above the ground, so that both can be told apart

const DASH = 1.2; // m of wall and m of gap on a coupled border

/** One material for all walls. On a coupled border the wall has gaps. */
const wallMaterial = new THREE.ShaderMaterial({
  transparent: true, depthWrite: false, side: THREE.DoubleSide, fog: false,
  uniforms: { colour: { value: new THREE.Color("#9db8e8") }, dash: { value: 0 } },
  vertexShader: /* glsl */ `
    varying float vUp;
    varying float vAlong;
    varying float vFar;
    void main() {
      vUp = uv.y;
      vAlong = position.x;
      vec4 seen = modelViewMatrix * vec4(position, 1.0);
      vFar = -seen.z;
      gl_Position = projectionMatrix * seen;
    }`,
  fragmentShader: /* glsl */ `
    varying float vUp;
    varying float vAlong;
    varying float vFar;
    uniform vec3 colour;
    uniform float dash;
    void main() {
      if (dash > 0.0 && fract(vAlong / (2.0 * dash)) > 0.5) discard;
      float glow = 0.20 * pow(1.0 - vUp, 2.2) + 0.5 * smoothstep(0.035, 0.0, vUp);
      gl_FragColor = vec4(colour, glow * (1.0 - smoothstep(150.0, 700.0, vFar)));
      #include <colorspace_fragment>
    }`,
});

export class RegionWalls {
  constructor() {
    this.group = new THREE.Group();
    this.labels = [];
  }

  /**
   * @param {{regions: any[]} | null} map
   * @param {number[]} origin
   * @param {number[] | null} reach  [x0, y0, x1, y1]: where bodies are; infinite regions are drawn as far as that
   */
  showMap(map, origin, reach) {
    this.#dispose();
    if (!map || map.regions.length === 0) return;
    const boxes = boxesOfMap(map.regions);
    const margin = Math.max(20, spanOf(boxes) * 0.35);
    const extent = extentOf(boxes, margin, 40);
    reach?.forEach((x, i) => { extent[i] = i < 2 ? Math.min(extent[i], x - 4) : Math.max(extent[i], x + 4); });
    const clip = (x, axis) => Math.min(extent[axis + 2], Math.max(extent[axis], x)) - origin[axis];
    const ids = [...map.regions].map((r) => r.id).sort((a, b) => a - b);
    for (const border of bordersOf(boxes)) this.#addWall(border, clip, origin);
    boxes.forEach((box, i) => {
      const [x0, y0, x1, y1] = [clip(box[0], 0), clip(box[1], 1), clip(box[2], 0), clip(box[3], 1)];
      if (x1 > x0 && y1 > y0) this.#addRegion(ids[i], x0, y0, x1, y1, boxes.length > 1, origin);
    });
  }

  /** @param {boolean} coupled  the nodes on both sides of a border solve contacts together */
  set coupled(coupled) {
    wallMaterial.uniforms.dash.value = coupled ? DASH : 0;
  }

  get coupled() {
    return wallMaterial.uniforms.dash.value > 0;
  }

  #addWall(border, clip, origin) {
    const across = 1 - border.axis;
    const [from, to] = [clip(border.from, across), clip(border.to, across)];
    if (to <= from) return;
    const wall = new THREE.Mesh(new THREE.PlaneGeometry(to - from, WALL_HEIGHT).rotateX(Math.PI / 2), wallMaterial);
    if (border.axis === 0) wall.rotation.z = Math.PI / 2;
    const at = border.at - origin[border.axis];
    const middle = (from + to) / 2;
    wall.position.set(border.axis === 0 ? at : middle, border.axis === 0 ? middle : at, WALL_HEIGHT / 2 - origin[2]);
    wall.renderOrder = 2;
    this.group.add(wall);
  }

  #addRegion(id, x0, y0, x1, y1, tinted, origin) {
    const colour = colourOfHost(id);
    if (tinted) {
      const tint = new THREE.Mesh(
        new THREE.PlaneGeometry(x1 - x0, y1 - y0),
        new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.06, depthWrite: false,
          toneMapped: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 }));
      tint.position.set((x0 + x1) / 2, (y0 + y1) / 2, TINT_HEIGHT - origin[2]);
      tint.renderOrder = -1;
      this.group.add(tint);
    }
    const label = numberSprite(id, colour);
    label.position.set((x0 + x1) / 2, (y0 + y1) / 2, 0.6 - origin[2]);
    this.group.add(label);
    this.labels.push({ label, x0, y0, x1, y1 });
  }

  /** Labels stay readable from near and far. */
  update(camera) {
    for (const { label } of this.labels) {
      const size = Math.min(9, Math.max(0.9, camera.position.distanceTo(label.position) * 0.034));
      label.scale.set(size * 2.6, size, 1);
    }
  }

  #dispose() {
    for (const object of this.group.children) {
      object.geometry?.dispose();
      object.material.map?.dispose();
      if (object.material !== wallMaterial) object.material.dispose();
    }
    this.group.clear();
    this.labels.length = 0;
  }
}

function spanOf(boxes) {
  const [x0, y0, x1, y1] = extentOf(boxes, 0, 0);
  return Math.max(x1 - x0, y1 - y0);
}

function numberSprite(id, colour) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [333, 128];
  const pen = canvas.getContext("2d");
  pen.font = "600 50px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = "rgba(15, 21, 33, 0.88)";
  pen.strokeStyle = `${colour}99`;
  pen.lineWidth = 4;
  pen.beginPath();
  pen.roundRect(8, 18, 317, 92, 46);
  pen.fill();
  pen.stroke();
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(56, 64, 15, 0, 7);
  pen.fill();
  pen.fillStyle = "#e8eefb";
  pen.fillText(`region ${id}`, 190, 66, 220);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.anisotropy = 4;
  return new THREE.Sprite(new THREE.SpriteMaterial(
    { map: texture, transparent: true, depthWrite: false, depthTest: false, opacity: 0.92, fog: false, toneMapped: false }));
}
