// Names of the sync modes in launch files and results.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "core/sync_mode.h"

namespace aurasim::core {

inline constexpr std::array<std::pair<SyncMode, std::string_view>, 3> kSyncModeNames = {
    {{SyncMode::kFreeRunning, "free_running"},
     {SyncMode::kBounded, "bounded"},
     {SyncMode::kDeterministic, "deterministic"}}};

inline std::string_view name_of(SyncMode sync) { return kSyncModeNames[static_cast<std::size_t>(sync)].second; }

inline std::optional<SyncMode> sync_named(std::string_view name) {
  for (const auto& [sync, its_name] : kSyncModeNames) {
    if (its_name == name) return sync;
  }
  return std::nullopt;
}

}  // namespace aurasim::core
