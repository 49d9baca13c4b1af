// Finds bodies that have broken down: their state has NaN, or is beyond core/limits.h.
#pragma once

#include <string>

class btRigidBody;

namespace aurasim::physics {

/// True if the body has broken down. The check is cheap, because it is called for every body in every state.
bool has_broken_down(const btRigidBody& body);

/// Text that says what is wrong with a body that has broken down, with its state.
std::string fault_of(const btRigidBody& body);

}  // namespace aurasim::physics
