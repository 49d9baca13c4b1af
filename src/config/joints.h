// Joints of a scene. A list of maps, each of one of
//   ball: {}
//   hinge: {axis: [0, 0, 1], limits_deg: [-45, 45], motor: {speed: 3, max_impulse: 0.5}}      rad/s, N m s per substep
//   slider: {axis: [0, 0, 1], limits: [-0.5, 0.5]}                                            m
//   fixed: {}
//   spring: {orientation: {...}, x: {stiffness: 500, damping: 10, limits: [-1, 1]}, y: ..., z: ..., rx: ...}
// and
//   bodies: [A, B]       names of bodies; [A] joins A to the world. Angles and positions are those of A relative to B
//   position: [x, y, z]  of the joint in the world, in state 0; default: that of A
//   name, collide (false; whether A and B collide with each other), break_impulse (N s or N m s in one substep)
// The axes of a spring are x, y, z (N/m, N s/m, m) and rx, ry, rz (N m/rad, N m s/rad, limits_deg); those that are not
// given are locked, {} is free.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

/// After all bodies.
void read_joints(const Field& field, SceneDraft& draft);

/// Once the bodies have their ids.
void number_joints(SceneDraft& draft);

}  // namespace aurasim::config
