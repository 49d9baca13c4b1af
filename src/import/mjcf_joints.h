// Reads joints and equality constraints of a compiled MuJoCo model. Only for the MJCF reader.
#pragma once

#include <mujoco/mujoco.h>

#include "import/model.h"

namespace aurasim::importing {

/// Returns the name in the file, or "KIND NUMBER", which is unique.
std::string mjcf_name(const mjModel& m, int type, int id, const char* kind);

inline core::Vec3 mj_vec3(const mjtNum* p) { return {p[0], p[1], p[2]}; }
inline core::Quat mj_quat(const mjtNum* q) { return core::Quat(q[0], q[1], q[2], q[3]).normalized(); }

/// Link of each MuJoCo body: link_of[body] is an index in Model::links, or nothing for the world and bodies welded to
/// it.
using LinkOfBody = std::vector<std::optional<std::size_t>>;

/// Adds the joints of one body, in the pose of `d`.
void add_mjcf_joints(const mjModel& m, const mjData& d, int body, const LinkOfBody& link_of, Model& model);

void add_mjcf_equalities(const mjModel& m, const mjData& d, const LinkOfBody& link_of, Model& model);

}  // namespace aurasim::importing
