// Statics that move as their scene says (core/static_path.h): where they are at a time.
import * as THREE from "three";
import { placeOf } from "./shapes.js";

/**
 * @param {{stops: {at: number, p: number[], q: number[]}[], repeats: boolean, smooth: boolean}} path  p in m, q as
 *     [w, x, y, z], seen from where the static stands at the start; at in s, ascending
 * @param {number} t_s
 * @returns {THREE.Matrix4}
 */
export function placeOnPath(path, t_s) {
  const ends_s = path.stops.at(-1).at;
  const t = path.repeats ? t_s - Math.floor(t_s / ends_s) * ends_s : t_s;
  const next = path.stops.findIndex((stop) => stop.at > t);
  if (next < 0) return at(path.stops.at(-1), path.stops.at(-1), 1);
  const before = next > 0 ? path.stops[next - 1] : { at: 0, p: [0, 0, 0], q: [1, 0, 0, 0] };
  const share = (t - before.at) / (path.stops[next].at - before.at);
  return at(before, path.stops[next], path.smooth ? share * share * (3 - 2 * share) : share);
}

/**
 * What statics have been told, put into the scene. Others keep what they know.
 * @param {{generation: number, statics: {id: number, moves?: any[]}[]}} scene
 * @param {{generation: number, statics: {id: number, moves: any[]}[]}} message
 * @returns {boolean} whether it is of that scene
 */
export function takeMoves(scene, message) {
  if (scene.generation !== message.generation) return false;
  const told = new Map(message.statics.map(({ id, moves }) => [id, moves]));
  for (const body of scene.statics) if (told.has(body.id)) body.moves = told.get(body.id);
  return true;
}

/**
 * A static that has been told to move.
 * @param {{p, q, path?, moves?: {step: number, states: number, from: {p, q}, to: {p, q}}[]}} body  in the world
 * @param {number} stamp  step, may lie between two
 */
export function placeOfStatic(body, stamp, step_s) {
  const move = body.moves?.findLast(({ step }) => stamp >= step - 1);
  if (move) return at(move.from, move.to, Math.min(1, (stamp + 1 - move.step) / move.states));
  const place = placeOf(body.p, body.q);
  return body.path ? place.multiply(placeOnPath(body.path, stamp * step_s)) : place;
}

function at(before, next, share) {
  const p = new THREE.Vector3(...before.p).lerp(new THREE.Vector3(...next.p), share);
  const q = turned(before.q).slerp(turned(next.q), share);
  return new THREE.Matrix4().compose(p, q, new THREE.Vector3(1, 1, 1));
}

function turned([w, x, y, z]) {
  return new THREE.Quaternion(x, y, z, w).normalize();
}
