// Bodies in regular formations. A list of maps of one key:
//   {stack: {prototype, count}}                  one upon the other
//   {wall: {prototype, rows, columns, gap}}      in bond: odd rows are shifted by half a body
//   {pyramid: {prototype, rows, gap}}            `rows` bodies at the bottom, one at the top, in one plane
//   {block: {prototype, counts: [nx, ny, nz], spacing: [dx, dy, dz]}}      spacing of centres; default: touching
//   {row: {prototype, count, step: [dx, dy, dz]}}    `position` is the first body's centre
//   {chain: {prototype, count, step, anchor: first}}     a row whose bodies point their z axis along `step` and hang
//                                    together by ball joints halfway between their centres; `anchor` (none, first,
//                                    last, both) joins an end to the world, half a step beyond the centre
// and in each, at will: position (of the middle of the bottom; [0, 0, 0]), yaw_deg (turns the whole about the
// vertical through position), velocity and spin (of every body), name (NAME.0, NAME.1, ... are the bodies' names).
// `gap` is the free space between bodies side by side.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

void read_generators(const Field& field, SceneDraft& draft);

}  // namespace aurasim::config
