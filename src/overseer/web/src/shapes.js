// Geometry of the shapes that a scene can have, and how far they reach.
import * as THREE from "three";

/**
 * What has to be drawn for a shape: one geometry per part, with the part's place in the body.
 * @param {any} shape  SHAPE of docs/viewer.md
 * @param {number} detail  0 crude, 1 coarse, 2 middle, 3 fine
 * @returns {{geometry: THREE.BufferGeometry, place: THREE.Matrix4 | null}[]}
 */
export function partsOf(shape, detail, place = null) {
  if (shape.kind === "compound") {
    return shape.parts.flatMap((part) => {
      const inBody = placeOf(part.p, part.q);
      return partsOf(part.shape, detail, place ? place.clone().multiply(inBody) : inBody);
    });
  }
  const geometry = geometryOf(shape, detail);
  return geometry ? [{ geometry, place }] : [];
}

export function placeOf(p = [0, 0, 0], q = [1, 0, 0, 0]) {
  return new THREE.Matrix4().compose(
    new THREE.Vector3(...p), new THREE.Quaternion(q[1], q[2], q[3], q[0]), new THREE.Vector3(1, 1, 1));
}

function geometryOf(shape, detail) {
  const round = [5, 8, 14, 24][detail];
  switch (shape.kind) {
    case "sphere":
      return sphere(shape.radius, detail);
    case "box":
      return new THREE.BoxGeometry(...shape.half_extents.map((h) => 2 * h));
    case "capsule":
      return new THREE.CapsuleGeometry(shape.radius, shape.height, [1, 2, 4, 8][detail], round).rotateX(Math.PI / 2);
    case "cylinder":
      return new THREE.CylinderGeometry(shape.radius, shape.radius, shape.height, round).rotateX(Math.PI / 2);
    case "mesh":
      return mesh(shape);
    default:
      return null; // planes are drawn as ground
  }
}

/** Fewest triangles for the roundest look; smooth normals. */
function sphere(radius, detail) {
  if (detail === 0) return octahedron(radius * 1.15);
  const [around, along] = [[8, 6], [14, 9], [24, 16]][detail - 1];
  return new THREE.SphereGeometry(radius, around, along).rotateX(Math.PI / 2);
}

/** With one normal per corner it is shaded like a ball; six corners are all that it costs. */
function octahedron(r) {
  const points = [r, 0, 0, -r, 0, 0, 0, r, 0, 0, -r, 0, 0, 0, r, 0, 0, -r];
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(points.map((x) => x / r), 3));
  geometry.setIndex([0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5]);
  return geometry;
}

function mesh({ points, triangles }) {
  const indexed = new THREE.BufferGeometry();
  indexed.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  indexed.setIndex(triangles);
  // Faces, not a smooth skin: most meshes here are hulls and terrain, whose edges should be seen.
  const faceted = indexed.toNonIndexed();
  faceted.computeVertexNormals();
  return faceted;
}

/** Radius about the origin of the body; planes have none. */
export function radiusOf(shape) {
  switch (shape.kind) {
    case "sphere":
      return shape.radius;
    case "box":
      return Math.hypot(...shape.half_extents);
    case "capsule":
      return shape.radius + shape.height / 2;
    case "cylinder":
      return Math.hypot(shape.radius, shape.height / 2);
    case "mesh": {
      let most = 0;
      for (let i = 0; i < shape.points.length; i += 3) {
        most = Math.max(most, Math.hypot(shape.points[i], shape.points[i + 1], shape.points[i + 2]));
      }
      return most;
    }
    case "compound":
      return Math.max(0, ...shape.parts.map((part) => Math.hypot(...(part.p ?? [0])) + radiusOf(part.shape)));
    default:
      return 0;
  }
}
