#pragma once

#include <memory>

#include "core/aura.h"

namespace aurasim::core {

/// Creates the aura of rules.kind. `clearance` has to outlive it.
std::unique_ptr<const Aura> make_aura(const AuraRules& rules, const ClearanceQuery& clearance);

}  // namespace aurasim::core
