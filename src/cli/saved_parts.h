// The parts of a saved world, once its nodes have written them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::cli {

struct PutTogether {
  bool is_whole = false;  ///< false: the parts are on their nodes' hosts
  std::uintmax_t bytes = 0;
};

/// Makes `file` of the parts, and removes these, if all of them are on this host. Throws cut::BadCut or
/// std::runtime_error.
PutTogether put_together(const std::vector<std::string>& parts, const std::string& file);

}  // namespace aurasim::cli
