#include "lab/conditions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "config/launch.h"
#include "core/sphere_aura.h"

namespace aurasim::lab {
namespace {

/// From `first` to `last` in `increment`s; the last value is `last` also where the increments miss it.
std::vector<double> steps_of(double first, double last, double increment) {
  std::vector<double> values;
  const auto count = static_cast<int>(std::floor((last - first) / increment + 1e-9));
  for (int i = 0; i <= count; ++i) values.push_back(first + i * increment);
  if (last - values.back() > 1e-9) values.push_back(last);
  return values;
}

core::AuraRules plain_rules(core::AuraKind kind, const Conditions& conditions) {
  core::AuraRules rules;
  rules.kind = kind;
  rules.step_s = kStep_s;
  rules.substeps = conditions.substeps;
  rules.lookahead = lookahead(conditions.promised);
  rules.top_speed_m_s = conditions.promised.speed_m_s;
  rules.frame_s = conditions.promised.frame_s;
  rules.latency_s = conditions.promised.latency_s;
  rules.gravity = core::Vec3::Zero();
  return rules;
}

double reach_of(const core::AuraRules& rules) {
  const core::NoShapes no_shapes;
  return rules.kind == core::AuraKind::kThesis ? core::ThesisAura(rules, no_shapes).reach(1)
                                               : core::TightAura(rules, no_shapes).reach(1);
}

}  // namespace

std::vector<Series> thesis_series() {
  return {{Factor::kSpeed, 16, steps_of(1, 32, 1)},
          {Factor::kSpeed, 32, steps_of(1, 64, 1)},
          {Factor::kSpeed, 48, steps_of(1, 96, 1)},
          {Factor::kLatency, 0.002, steps_of(0, 0.004, 0.00005)},
          {Factor::kLatency, 0.008, steps_of(0, 0.016, 0.00025)},
          {Factor::kLatency, 0.016, steps_of(0, 0.032, 0.001)},
          {Factor::kFrame, 0.00833, steps_of(0, 0.01666, 0.001)},
          {Factor::kFrame, 0.015, steps_of(0, 0.030, 0.001)},
          {Factor::kFrame, 0.03333, steps_of(0, 0.06666, 0.002)}};
}

Series loss_series() { return {Factor::kLoss, 0, steps_of(0, 0.20, 0.01)}; }

Series thinned(const Series& series, std::size_t count) {
  const std::size_t all = series.values.size();
  if (count == 0 || count >= all) return series;
  Series few{series.factor, series.tolerance, {}};
  for (std::size_t i = 1; i <= count; ++i) few.values.push_back(series.values[i * all / count - 1]);
  return few;
}

Conditions conditions_at(const Series& series, double value, int substeps) {
  Conditions c;
  c.substeps = substeps;
  switch (series.factor) {
    case Factor::kSpeed:
      c.promised.speed_m_s = series.tolerance;
      break;
    case Factor::kLatency:
      c.promised.latency_s = series.tolerance;
      break;
    case Factor::kFrame:
      c.promised.frame_s = series.tolerance;
      break;
    case Factor::kLoss:
      break;
  }
  c.speed_m_s = series.factor == Factor::kSpeed ? value : c.promised.speed_m_s;
  c.latency_s = series.factor == Factor::kLatency ? value : c.promised.latency_s;
  c.frame_s = series.factor == Factor::kFrame ? value : c.promised.frame_s;
  c.loss = series.factor == Factor::kLoss ? value : 0;
  return c;
}

bool within_tolerance(const Series& series, double value) { return value <= series.tolerance + 1e-9; }

int lookahead(const Tolerances& promised) {
  config::Launch launch;
  launch.tolerances = {promised.speed_m_s, promised.latency_s, promised.frame_s};
  launch.time.step_hz = 1 / kStep_s;
  return launch.lookahead();
}

core::AuraRules rules_for(AuraChoice choice, const Conditions& conditions) {
  switch (choice) {
    case AuraChoice::kNone:
      return plain_rules(core::AuraKind::kNone, conditions);
    case AuraChoice::kThesis:
      return plain_rules(core::AuraKind::kThesis, conditions);
    case AuraChoice::kTight:
      return plain_rules(core::AuraKind::kTight, conditions);
    case AuraChoice::kTightAtThesisSize: {
      core::AuraRules rules = plain_rules(core::AuraKind::kTight, conditions);
      rules.reach_scale = reach_of(plain_rules(core::AuraKind::kThesis, conditions)) / reach_of(rules);
      return rules;
    }
    case AuraChoice::kSwept:
      break;
  }
  return plain_rules(core::AuraKind::kSwept, conditions);
}

double aura_reach_m(AuraChoice choice, const Conditions& conditions) {
  if (choice == AuraChoice::kNone || choice == AuraChoice::kSwept) return 0;
  return reach_of(rules_for(choice, conditions));
}

std::string_view name_of(AuraChoice aura) {
  constexpr std::array<std::string_view, 5> names = {"none", "thesis", "tight", "tight_at_thesis_size", "swept"};
  return names[static_cast<std::size_t>(aura)];
}

std::string_view name_of(Factor factor) {
  constexpr std::array<std::string_view, 4> names = {"speed", "latency", "frame", "loss"};
  return names[static_cast<std::size_t>(factor)];
}

std::string name_of(const Series& series) {
  if (series.factor == Factor::kLoss) return "loss";
  const char* unit = series.factor == Factor::kSpeed ? "m_s" : "ms";
  return fmt::format("{}_{:g}{}", name_of(series.factor), shown(series.factor, series.tolerance), unit);
}

double shown(Factor factor, double value) {
  switch (factor) {
    case Factor::kSpeed:
      return value;
    case Factor::kLatency:
    case Factor::kFrame:
      return std::round(value * 1e8) / 1e5;
    case Factor::kLoss:
      break;
  }
  return std::round(value * 1e6) / 1e4;
}

}  // namespace aurasim::lab
