// Rectangles that divide the plane: borders, moving them, cutting and joining, patterns. Pure.
// A box is [x0, y0, x1, y1]; the outermost reach to infinity. Its index is the number of its region.

/** No region may be made narrower than this, m. */
export const MIN_WIDTH = 0.5;
const EPS = 1e-6;
const same = (a, b) => a === b || Math.abs(a - b) < EPS;

/** From and to the wire, where `null` is infinite. */
export const boxesOfMap = (regions) =>
  [...regions].sort((a, b) => a.id - b.id)
    .map((r) => [r.x0 ?? -Infinity, r.y0 ?? -Infinity, r.x1 ?? Infinity, r.y1 ?? Infinity]);
export const boxesForWire = (boxes) => boxes.map((box) => box.map((x) => (Number.isFinite(x) ? x : null)));

/**
 * A stretch of border that can be moved by itself: all boxes that end on it on one side, all that begin on the other.
 * @typedef {object} Border
 * @property {0 | 1} axis  0: a line x = at, 1: a line y = at
 * @property {number} at
 * @property {number} from  along the other axis
 * @property {number} to
 * @property {number[]} below  boxes whose upper edge it is
 * @property {number[]} above  boxes whose lower edge it is
 */

/** @returns {Border[]} */
export function bordersOf(boxes) {
  return [0, 1].flatMap((axis) => bordersAlong(boxes, axis));
}

function bordersAlong(boxes, axis) {
  const across = 1 - axis;
  const edges = [];
  boxes.forEach((box, index) => {
    const [from, to] = [box[across], box[across + 2]];
    if (Number.isFinite(box[axis + 2])) edges.push({ at: box[axis + 2], from, to, index, side: "below" });
    if (Number.isFinite(box[axis])) edges.push({ at: box[axis], from, to, index, side: "above" });
  });
  edges.sort((a, b) => a.at - b.at || a.from - b.from || a.to - b.to);
  const borders = [];
  for (const edge of edges) {
    const open = borders.at(-1);
    // Edges that only touch end to end can move apart from each other; those that overlap cannot.
    if (open && same(open.at, edge.at) && edge.from < open.to - EPS) {
      open.to = Math.max(open.to, edge.to);
      open[edge.side].push(edge.index);
    } else {
      const border = { axis, at: edge.at, from: edge.from, to: edge.to, below: [], above: [] };
      border[edge.side].push(edge.index);
      borders.push(border);
    }
  }
  return borders;
}

/** How far a border can be moved before a region beside it gets too narrow. @returns {[number, number]} */
export function limitsOf(boxes, border) {
  const low = Math.max(...border.below.map((i) => boxes[i][border.axis]));
  const high = Math.min(...border.above.map((i) => boxes[i][border.axis + 2]));
  return [low + MIN_WIDTH, high - MIN_WIDTH];
}

/** @returns {number[][]} boxes with the border at `to`, or as near to it as there is room */
export function moveBorder(boxes, border, to) {
  const [low, high] = limitsOf(boxes, border);
  const at = Math.min(high, Math.max(low, to));
  const moved = boxes.map((box) => [...box]);
  for (const i of border.below) moved[i][border.axis + 2] = at;
  for (const i of border.above) moved[i][border.axis] = at;
  return moved;
}

/** All borders on the line of this one that hang together, as one: to move a whole line of a grid. @returns {Border} */
export function wholeLine(boxes, border) {
  const line = { ...border, below: [...border.below], above: [...border.above] };
  const rest = bordersOf(boxes).filter((b) => b.axis === border.axis && same(b.at, border.at));
  for (let grown = true; grown; ) {
    grown = false;
    for (const other of rest) {
      const touches = same(other.from, line.to) || same(other.to, line.from);
      if (!touches || line.below.includes(other.below[0])) continue;
      line.from = Math.min(line.from, other.from);
      line.to = Math.max(line.to, other.to);
      line.below.push(...other.below);
      line.above.push(...other.above);
      grown = true;
    }
  }
  return line;
}

/** Cuts region `index` in two at `at`; the new one gets the next number. */
export function cutRegion(boxes, index, axis, at) {
  const box = boxes[index];
  if (!box || at - box[axis] < MIN_WIDTH || box[axis + 2] - at < MIN_WIDTH) return boxes;
  const cut = boxes.map((b) => [...b]);
  const upper = [...box];
  cut[index][axis + 2] = at;
  upper[axis] = at;
  return [...cut, upper];
}

/** Takes a border away. Only where exactly two regions of the same length meet. */
export function joinAcross(boxes, border) {
  if (border.below.length !== 1 || border.above.length !== 1) return boxes;
  const [keep, drop] = [border.below[0], border.above[0]].sort((a, b) => a - b);
  const [a, b] = [boxes[keep], boxes[drop]];
  const joined = [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[2], b[2]), Math.max(a[3], b[3])];
  return boxes.map((box, i) => (i === keep ? joined : box)).filter((_, i) => i !== drop);
}

export function regionAt(boxes, x, y) {
  return boxes.findIndex(([x0, y0, x1, y1]) => x >= x0 && x < x1 && y >= y0 && y < y1);
}

/** Does every point belong to exactly one box? Tries one point in each cell that the edges make. */
export function dividesThePlane(boxes) {
  const middles = (axis) => {
    const cuts = [...new Set(boxes.flatMap((b) => [b[axis], b[axis + 2]]).filter(Number.isFinite))].sort((a, b) => a - b);
    if (cuts.length === 0) return [0];
    const between = cuts.slice(1).map((x, i) => (x + cuts[i]) / 2);
    return [cuts[0] - 1, ...between.filter((x, i) => cuts[i + 1] - cuts[i] > EPS), cuts.at(-1) + 1];
  };
  const covers = (b, x, y) => x > b[0] && x < b[2] && y > b[1] && y < b[3];
  return middles(0).every((x) => middles(1).every((y) => boxes.filter((b) => covers(b, x, y)).length === 1));
}

/** Rows and columns for `count` cells, as near to a square as divisors allow. @returns {[number, number]} */
export function gridShape(count) {
  let rows = Math.floor(Math.sqrt(count));
  while (count % rows !== 0) --rows;
  return [rows, count / rows];
}

/**
 * A pattern of `count` regions laid over a rectangle; the outermost then reach to infinity.
 * @param {"columns" | "grid" | "brick"} kind
 * @param {number[]} frame  [x0, y0, x1, y1], finite
 */
export function pattern(kind, count, frame) {
  const [rows, columns] = kind === "columns" ? [1, count] : gridShape(count);
  const [x0, y0, x1, y1] = frame;
  const line = (low, high, i, n) => (i <= 0 ? -Infinity : i >= n ? Infinity : low + ((high - low) * i) / n);
  const boxes = [];
  for (let row = 0; row < rows; ++row) {
    // Every other row of a wall of bricks is shifted by half a brick.
    const shift = kind === "brick" && row % 2 === 1 ? (x1 - x0) / columns / 2 : 0;
    for (let column = 0; column < columns; ++column) {
      boxes.push([line(x0, x1, column, columns) + shift, line(y0, y1, row, rows),
        line(x0, x1, column + 1, columns) + shift, line(y0, y1, row + 1, rows)]);
    }
  }
  return boxes;
}

/** The finite part of a map with a margin: what is drawn of it, and what a pattern is laid over. */
export function extentOf(boxes, margin, atLeast = 20) {
  const range = (axis) => {
    const edges = boxes.flatMap((b) => [b[axis], b[axis + 2]]).filter(Number.isFinite);
    const low = edges.length ? Math.min(...edges) : 0;
    const high = edges.length ? Math.max(...edges) : 0;
    const spare = Math.max(margin, (atLeast - (high - low)) / 2);
    return [low - spare, high + spare];
  };
  const [[x0, x1], [y0, y1]] = [range(0), range(1)];
  return [x0, y0, x1, y1];
}
