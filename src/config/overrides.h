// Overrides: "key.path=value", as given to --set. A path names keys and list indices: "regions.cell.0" or
// "regions.cell[0]". A value is YAML: 4, bounded, [40, 40], {layout: columns, count: 2, width: 40}.
#pragma once

#include <string>
#include <vector>

#include "config/errors.h"
#include "config/yaml_tree.h"

namespace aurasim::config {

struct Override {
  std::vector<std::string> path;
  YamlNode value;
};

/// Returns the valid overrides; each becomes a source of `errors`, named "--set key.path=value".
std::vector<Override> parse_overrides(const std::vector<std::string>& texts, Errors& errors);

/// Replaces the value at the path, or adds it to its map. Unknown keys are left to the readers to report.
void apply_override(const Override& change, YamlNode& root, Errors& errors);

}  // namespace aurasim::config
