#include "node/births.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "node/scene_additions.h"

namespace aurasim::node {

void ToBeBorn::begin(const core::Scene& scene, core::Step known, double step_s) {
  next_injection.clear();
  for (const core::Injector& injector : scene.injectors) {
    next_injection.push_back(core::injected_count(injector, known, step_s));
  }
}

std::vector<NewBody> ToBeBorn::take_due(const core::Scene& scene, core::Step birth, double step_s) {
  std::vector<NewBody> due;
  std::erase_if(spawns, [&](core::Order& order) {
    if (order.at_step > birth) return false;
    core::BodyRecord record = record_of(std::get<core::Spawn>(order.action), order.at_step);
    due.push_back({std::move(record), std::move(order)});
    return true;
  });
  for (std::size_t k = 0; k < scene.injectors.size(); ++k) {
    const core::Injector& injector = scene.injectors[k];
    const std::uint64_t count = core::injected_count(injector, birth, step_s);
    for (; next_injection[k] < count; ++next_injection[k]) {
      if (auto record = core::injected_body(injector, next_injection[k], step_s)) due.push_back({*record, {}});
    }
  }
  return due;
}

std::vector<core::BodyRecord> injected_between(const core::Scene& scene, core::Step after, core::Step until,
                                               double step_s) {
  std::vector<core::BodyRecord> bodies;
  for (const core::Injector& injector : scene.injectors) {
    const std::uint64_t end = core::injected_count(injector, until, step_s);
    for (auto i = core::injected_count(injector, after, step_s); i < end; ++i) {
      if (auto record = core::injected_body(injector, i, step_s)) bodies.push_back(*record);
    }
  }
  return bodies;
}

}  // namespace aurasim::node
