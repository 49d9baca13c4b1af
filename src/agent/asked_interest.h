// Reads from JSON what a client wants to observe.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "agent/fans_and_triggers.h"
#include "core/interest.h"
#include "core/scene.h"

namespace aurasim::agent {

struct AskedInterest {
  core::Interest selection;  ///< interest in bodies; client and sequence are not filled in
  std::vector<FanSpec> fans;
  std::vector<TriggerSpec> triggers;
};

inline constexpr std::size_t kMostFans = 16;
inline constexpr std::size_t kMostRays = 100'000;  ///< rays of one fan
inline constexpr std::size_t kMostTriggers = 64;
inline constexpr double kFarthestRay_m = 1e4;

/// Throws steering::BadAsk with the field, what was found and what is allowed.
AskedInterest asked_interest(const nlohmann::json& json, const core::Scene& scene);

}  // namespace aurasim::agent
