// Makes one file of a saved world's parts, once its nodes have written them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::cut {

struct PutTogether {
  std::string file;  ///< empty: the parts are on their nodes' hosts, or in several folders
  std::uintmax_t bytes = 0;
};

/// If all parts are in one folder of this host, writes them there into one file called `name` and removes the parts.
/// Throws BadCut or std::runtime_error.
PutTogether put_together(const std::vector<std::string>& parts, const std::string& name);

}  // namespace aurasim::cut
