#include "import/model.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aurasim::importing {

BadModel::BadModel(std::vector<std::string> errors)
    : std::runtime_error(fmt::format("{}", fmt::join(errors, "\n"))), errors_(std::move(errors)) {}

core::Pose inverse(const core::Pose& X_AB) {
  const core::Quat q_BA = X_AB.q_WB.conjugate();
  return {-(q_BA * X_AB.p_WB), q_BA};
}

std::string element_name(std::string_view kind, std::string_view name) { return fmt::format("{} '{}'", kind, name); }

void tidy_apart(Model& model) {
  std::set<std::pair<std::size_t, std::size_t>> pairs, joined;
  for (const auto& [a, b] : model.apart) pairs.insert(std::minmax(a, b));
  for (const Joint& joint : model.joints) {
    if (joint.parent && !joint.collide) joined.insert(std::minmax(joint.child, *joint.parent));
  }
  model.apart.clear();
  for (const auto& pair : pairs) {
    if (pair.first != pair.second && !joined.contains(pair)) model.apart.push_back(pair);
  }
}

}  // namespace aurasim::importing
