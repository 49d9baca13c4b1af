// Hard cases that the order of contacts may change, with blocks of several sizes. All cases stand around the origin,
// which is a corner of blocks of any size.
#include <array>

#include <fmt/format.h>

#include "lab/stability/stability.h"
#include "lab/suites/suites.h"

namespace aurasim::lab {
namespace {

struct BlocksCase {
  const char* name;
  bool quick;           ///< also part of a quick run
  double standing_s{};  ///< how long no body may fall with the preset `balanced`; 0: not tried
};

constexpr std::array kBlocksCases = {
    BlocksCase{"stack_20", true, 60},       BlocksCase{"stack_50", false},
    BlocksCase{"pyramid", false, 60},       BlocksCase{"card_house", false, 60},
    BlocksCase{"mass_ratio_100", true, 60}, BlocksCase{"balls_666", false},
    BlocksCase{"deep_overlap", true},       BlocksCase{"wedge", true},
    BlocksCase{"newtons_cradle", true},     BlocksCase{"chain_50", true},
    BlocksCase{"tiny_1cm", true},           BlocksCase{"huge_100m", true},
};
constexpr std::array kSides_m = {8.0, 16.0, 32.0};

RunRules rules_of(const char* preset, double side_m) {
  RunRules rules = preset_rules(preset);
  rules.block_m = side_m;
  return rules;
}

void add_blocks_rows(const StabilityRow& row, const char* preset, std::vector<ResultRow>& out) {
  for (std::size_t i = 0; i < row.what.metrics.size(); ++i) {
    const Metric& metric = row.what.metrics[i];
    out.push_back({fmt::format("{}/{}, {:g} m", row.what.name, preset, row.rules.block_m), metric.measured,
                   row.one.errors[i], metric.unit});
  }
}

/// The case for a long time, with bodies that never sleep and with bodies that may.
std::vector<Case> standing_cases(const BlocksCase& of) {
  std::vector<Case> cases(2, stability_case(of.name));
  for (Case& c : cases) c.duration_s = of.standing_s;
  cases[1].name += "_may_sleep";
  for (core::Prototype& prototype : cases[1].scene.prototypes) prototype.can_sleep = true;
  return cases;
}

}  // namespace

std::vector<std::string> blocks_parts() {
  std::vector<std::string> parts;
  for (const BlocksCase& c : kBlocksCases) parts.emplace_back(c.name);
  return parts;
}

SuiteResults run_blocks_suite(const SuitePlan& plan, const Progress& progress) {
  SuiteResults results;
  std::vector<Target> targets;
  double differ = 0, done = 0;
  for (const BlocksCase& of : kBlocksCases) {
    if (!progress(done++ / kBlocksCases.size())) return results;
    if (!plan.wants(of.name) || (plan.only.empty() && !plan.is_full() && !of.quick)) continue;
    for (const double side_m : kSides_m) {
      for (const char* preset : {"fast", "balanced"}) {
        const StabilityRow row = run_stability(stability_case(of.name), rules_of(preset, side_m));
        add_blocks_rows(row, preset, results.rows);
        if (!row.same_bits()) ++differ;
      }
      if (of.standing_s == 0 || !plan.is_full()) continue;
      for (const Case& c : standing_cases(of)) {
        const StabilityRow row = run_stability(c, rules_of("balanced", side_m));
        if (!row.same_bits()) ++differ;
        constexpr std::size_t kFallen = 1;
        targets.push_back({fmt::format("{}, blocks of {:g} m, preset balanced, {:g} s: {}", c.name, side_m,
                                       of.standing_s, c.metrics[kFallen].measured),
                           row.one.errors[kFallen], 0});
      }
    }
  }
  targets.push_back({"runs whose bits on two nodes differ from those on one", differ, 0});
  add_targets(results, targets);
  return results;
}

}  // namespace aurasim::lab
