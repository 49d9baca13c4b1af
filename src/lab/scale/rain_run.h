// Runs one Rain: all its nodes in virtual time in this thread, each step's work measured as CPU time of the node.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "lab/launch_rules.h"
#include "lab/scale/rain.h"
#include "lab/scale/window.h"

namespace aurasim::lab {

inline constexpr double kWindow_s = 5;  ///< as in the thesis

struct RainPlace {
  std::filesystem::path launch_file;  ///< launch_configs/columns_rain.yaml, or a file with the same injectors
  SetupOf setup_of;
};

/// Rules of nodes whose frames are never late, and whose work is measured as CPU time.
ClusterRules rules_of(const Rain& rain, const config::Launch& launch, const RainPlace& place);

/// Runs the rain and returns its windows. Nothing when `stop` became true. `stepped(share)` is called now and then with
/// the share of the run that is done, 0 to 1.
std::optional<std::vector<Window>> run_rain(const Rain& rain, const RainPlace& place,
                                            const std::function<void(double)>& stepped, const std::atomic<bool>& stop);

}  // namespace aurasim::lab
