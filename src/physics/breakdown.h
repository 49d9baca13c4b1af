// Bodies that no world can bear any more: not a number, or out of all bounds (core/limits.h).
#pragma once

#include <string>

class btRigidBody;

namespace aurasim::physics {

/// Cheap: asked of every body in every state.
bool has_broken_down(const btRigidBody& body);

/// What is wrong with a body that has broken down, and its state.
std::string fault_of(const btRigidBody& body);

}  // namespace aurasim::physics
