#pragma once

#include <memory>

#include "core/aura.h"

namespace aurasim::core {

/// The aura of rules.kind. `clearance` outlives it.
std::unique_ptr<const Aura> make_aura(const AuraRules& rules, const ClearanceQuery& clearance);

}  // namespace aurasim::core
