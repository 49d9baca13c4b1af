// The parts of a saved world, once its nodes have written them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::cli {

struct PutTogether {
  std::string file;  ///< empty: the parts are on their nodes' hosts, or in several folders
  std::uintmax_t bytes = 0;
};

/// Makes one file of the parts, called `name` and in their folder, and removes the parts, if all of them are in one
/// folder of this host. Throws cut::BadCut or std::runtime_error.
PutTogether put_together(const std::vector<std::string>& parts, const std::string& name);

}  // namespace aurasim::cli
