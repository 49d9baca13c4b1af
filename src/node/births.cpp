#include "node/births.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "node/scene_additions.h"

namespace aurasim::node {

std::vector<core::BodyRecord> Injections::between(const core::Scene& scene, core::Step after, core::Step until,
                                                  double step_s) {
  if (next_.size() != scene.injectors.size() || known_ != after) {
    next_.clear();
    for (const core::Injector& injector : scene.injectors) {
      const std::uint64_t index = core::injected_count(injector, after, step_s);
      next_.push_back({core::birth_step(injector, index, step_s), index});
    }
  }
  std::vector<core::BodyRecord> bodies;
  for (std::size_t k = 0; k < next_.size(); ++k) {
    Next& next = next_[k];
    for (; next.birth <= until; next.birth = core::birth_step(scene.injectors[k], ++next.index, step_s)) {
      bodies.push_back(*core::injected_body(scene.injectors[k], next.index, step_s));
    }
  }
  known_ = until;
  return bodies;
}

std::vector<NewBody> ToBeBorn::take_due(const core::Scene& scene, Injections& injections, core::Step birth,
                                        double step_s) {
  std::vector<NewBody> due;
  std::erase_if(spawns, [&](core::Order& order) {
    if (order.at_step > birth) return false;
    core::BodyRecord record = record_of(std::get<core::Spawn>(order.action), order.at_step);
    due.push_back({std::move(record), std::move(order)});
    return true;
  });
  if (birth <= injected) return due;
  for (core::BodyRecord& record : injections.between(scene, injected, birth, step_s)) {
    due.push_back({std::move(record), {}});
  }
  injected = birth;
  return due;
}

}  // namespace aurasim::node
