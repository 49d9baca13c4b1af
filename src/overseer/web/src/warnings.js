// What the nodes say went beyond a limit or a forecast, in words. Pure.
// A warning is no fault: it says that a collision may have come late. Collisions that did are counted apart, and they
// alone are alarming.

/** By the name that the status gives to it. */
export const WARNINGS = {
  speed: ["too fast", "Bodies faster than tolerances.speed of the launch file."],
  latency: ["late message", "Messages of other nodes that came later than the lookahead allows."],
  frame: ["slow frame", "Steps that took longer to compute than tolerances.frame of the launch file. The run gets slower, not wrong."],
  promise: ["off its path", "Bodies that left the path that their node had foretold to the others."],
  span: ["out of reach", "Bodies near a region that does not listen to their node."],
};

export const ABOUT_WARNINGS = "Warnings: something went beyond a limit of the launch file or beyond what a node had foretold. "
  + "A collision may have come late because of it. Whether one has is counted as late.";
export const ABOUT_LATE = "Late: collisions that a node saw too late, or not at all, because the bodies belonged to two nodes. Should be 0.";

const count = (number) => (number > 0 ? number : 0);

/** @returns {{name: string, means: string, count: number}[]} those that there were */
export function warningsOf(node) {
  return Object.entries(WARNINGS).map(([kind, [name, means]]) => ({ name, means, count: count(node.violations?.[kind]) }))
    .filter((warning) => warning.count > 0);
}

export const lateOf = (node) => count(node.late) + count(node.missed);

/** Over all nodes. `late` is NaN where nobody counts them, as in older recordings. */
export function sumOf(nodes) {
  const sum = { warnings: 0, late: nodes.some((node) => node.late !== undefined) ? 0 : NaN };
  for (const node of nodes) {
    for (const warning of warningsOf(node)) sum.warnings += warning.count;
    sum.late += lateOf(node);
  }
  return sum;
}
