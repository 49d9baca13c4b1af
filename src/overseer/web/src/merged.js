// Many copies of one geometry as a single one, moved by the processor. Renderers in software draw every instance of an
// InstancedMesh as a call of its own, which takes them ten times as long as the triangles do. Looks like an
// InstancedMesh to its user.
import * as THREE from "three";

export class MergedMesh extends THREE.Mesh {
  /** @param {THREE.BufferGeometry} source  is disposed with it */
  constructor(source, material, capacity) {
    super(new THREE.BufferGeometry(), material);
    this.source = source;
    this.corners = source.attributes.position.count;
    this.perCopy = source.index ? source.index.count : this.corners;
    for (const name of ["position", "normal", "color"]) {
      const array = new Float32Array(capacity * this.corners * 3);
      this.geometry.setAttribute(name, new THREE.BufferAttribute(array, 3).setUsage(THREE.DynamicDrawUsage));
    }
    this.geometry.setIndex(new THREE.BufferAttribute(this.#indices(capacity), 1));
    // Never drawn: knows where each copy is, and which of them a ray meets.
    this.copies = new THREE.InstancedMesh(source, material, capacity);
    this.copies.frustumCulled = false;
    this.count = 0;
  }

  #indices(capacity) {
    const indices = new Uint32Array(capacity * this.perCopy);
    for (let copy = 0, at = 0; copy < capacity; ++copy) {
      const first = copy * this.corners;
      for (let i = 0; i < this.perCopy; ++i) indices[at++] = first + (this.source.index ? this.source.index.array[i] : i);
    }
    return indices;
  }

  set count(count) {
    if (!this.copies) return;
    this.copies.count = count;
    this.geometry.setDrawRange(0, count * this.perCopy);
  }

  get count() {
    return this.copies.count;
  }

  setMatrixAt(index, matrix) {
    this.copies.setMatrixAt(index, matrix);
    const e = matrix.elements;
    const { position, normal } = this.source.attributes;
    const [fromP, fromN] = [position.array, normal.array];
    const [toP, toN] = [this.geometry.attributes.position.array, this.geometry.attributes.normal.array];
    let at = index * this.corners * 3;
    for (let i = 0; i < fromP.length; i += 3, at += 3) {
      const [x, y, z, nx, ny, nz] = [fromP[i], fromP[i + 1], fromP[i + 2], fromN[i], fromN[i + 1], fromN[i + 2]];
      for (let axis = 0; axis < 3; ++axis) {
        toP[at + axis] = e[axis] * x + e[4 + axis] * y + e[8 + axis] * z + e[12 + axis];
        toN[at + axis] = e[axis] * nx + e[4 + axis] * ny + e[8 + axis] * nz;
      }
    }
  }

  setColorAt(index, colour) {
    const to = this.geometry.attributes.color.array;
    const end = (index + 1) * this.corners * 3;
    for (let at = index * this.corners * 3; at < end; at += 3) colour.toArray(to, at);
  }

  getColorAt(index, colour) {
    colour.fromArray(this.geometry.attributes.color.array, index * this.corners * 3);
  }

  getMatrixAt(index, matrix) {
    this.copies.getMatrixAt(index, matrix);
  }

  /** What was set goes to the renderer with the next frame. */
  upload(matrices, colours) {
    const { position, normal, color } = this.geometry.attributes;
    for (const attribute of [...(matrices ? [position, normal] : []), ...(colours ? [color] : [])]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, this.count * this.corners * 3);
      attribute.needsUpdate = true;
    }
  }

  raycast(ray, hits) {
    this.copies.boundingSphere = null;
    const own = [];
    this.copies.raycast(ray, own);
    for (const hit of own) hits.push({ ...hit, object: this });
  }

  dispose() {
    this.source.dispose();
    this.copies.dispose();
  }
}
