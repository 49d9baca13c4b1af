// Sky and ground: planes of the scene as a ground with a grid of metres that goes on for as far as one can see.
import * as THREE from "three";

const REACH = 4000; // m, beyond every fog
export const HORIZON = new THREE.Color("#10151f");

const GRID_VERTEX = /* glsl */ `
#include <begin_vertex>
vGrid = position.xy + gridOffset;`;

// Lines as wide as a pixel or two wherever they are; they fade out before they would flicker.
const GRID_FRAGMENT = /* glsl */ `
#include <color_fragment>
float lines = gridLine(vGrid, 1.0) * 0.30 + gridLine(vGrid, 10.0) * 0.75;
diffuseColor.rgb = mix(diffuseColor.rgb, gridColour, clamp(lines, 0.0, 1.0));`;

const GRID_FUNCTION = /* glsl */ `
varying vec2 vGrid;
uniform vec3 gridColour;
float gridLine(vec2 p, float spacing) {
  vec2 cell = p / spacing;
  vec2 width = fwidth(cell);
  vec2 d = abs(fract(cell - 0.5) - 0.5) / max(width, vec2(1e-5));
  float line = 1.0 - min(min(d.x, d.y), 1.0);
  return line * (1.0 - smoothstep(0.08, 0.45, max(width.x, width.y)));
}
void main() {`;

/** Unlit where light is dear: the ground fills most of the picture. */
function gridMaterial(ghostly, lit) {
  const common = { side: THREE.DoubleSide, transparent: ghostly, opacity: ghostly ? 0.55 : 1, depthWrite: !ghostly };
  const material = lit
    ? new THREE.MeshStandardMaterial({ ...common, color: ghostly ? "#10151f" : "#1f2736", roughness: 0.92, metalness: 0 })
    : new THREE.MeshBasicMaterial({ ...common, color: ghostly ? "#0d121b" : "#121a28" });
  material.userData.gridOffset = { value: new THREE.Vector2() };
  material.onBeforeCompile = (shader) => {
    shader.uniforms.gridColour = { value: new THREE.Color(lit ? "#62748f" : "#3a4a66") };
    shader.uniforms.gridOffset = material.userData.gridOffset;
    shader.vertexShader = shader.vertexShader
      .replace("void main() {", "varying vec2 vGrid;\nuniform vec2 gridOffset;\nvoid main() {")
      .replace("#include <begin_vertex>", GRID_VERTEX);
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", GRID_FUNCTION)
      .replace("#include <color_fragment>", GRID_FRAGMENT);
  };
  return material;
}

/**
 * A plane of the scene, as a mesh that lies in it near the origin of the picture.
 * @param {{normal: number[], offset?: number} | null} plane  in the world; null: there is none, a hint of z = 0
 * @param {number[]} origin  of the picture, in the world
 * @param {boolean} lit  light and shadows on it, or its own colour only
 */
export function groundFor(plane, origin, lit) {
  const material = gridMaterial(plane === null, lit);
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(2 * REACH, 2 * REACH), material);
  const normal = new THREE.Vector3(...(plane?.normal ?? [0, 0, 1])).normalize();
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
  const offset = plane?.offset ?? 0;
  const height = offset - normal.dot(new THREE.Vector3(...origin));
  mesh.position.copy(normal).multiplyScalar(height);
  mesh.receiveShadow = plane !== null;
  mesh.renderOrder = -2;
  mesh.userData.surface = plane !== null;
  return mesh;
}

/** A dome that is a little lighter towards the horizon; it moves with the camera. */
export function sky() {
  const material = new THREE.ShaderMaterial({
    side: THREE.BackSide, depthWrite: false, depthTest: false, fog: false,
    uniforms: { horizon: { value: HORIZON }, zenith: { value: new THREE.Color("#05070c") },
      glow: { value: new THREE.Color("#22304a") } },
    vertexShader: /* glsl */ `
      varying vec3 vDirection;
      void main() {
        vDirection = position;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      varying vec3 vDirection;
      uniform vec3 horizon, zenith, glow;
      void main() {
        float h = normalize(vDirection).z;
        vec3 colour = mix(horizon, zenith, smoothstep(0.0, 0.7, h));
        colour += glow * 0.35 * exp(-14.0 * abs(h - 0.03)) * smoothstep(-0.02, 0.05, h);
        gl_FragColor = vec4(colour, 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const dome = new THREE.Mesh(new THREE.SphereGeometry(50, 32, 20), material);
  dome.renderOrder = -10;
  dome.frustumCulled = false;
  return dome;
}
