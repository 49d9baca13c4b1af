// Each requirement that the preset `exact` meets, for `exact` and for the soft step with more and more substeps and
// steps. A time is compared with that of `exact` in the same round.
#include <array>

#include "lab/measured_run.h"
#include "lab/scale/fit.h"
#include "lab/stability/stability.h"
#include "lab/suites/suites.h"

namespace aurasim::lab {
namespace {

struct Question {
  const char* case_name;
  std::size_t metric;
  double duration_s;  ///< 0: that of the case
  bool quick;         ///< also part of a quick run
};

/// The requirements of the stability experiment that the preset `exact` or Bullet's settings have to meet, and what
/// docs/accuracy.md promises of `exact`: piles do not sink, and weights of 1:1000 and cubes of 1 cm stand.
constexpr std::array kQuestions = {
    Question{"dzhanibekov", 0, 0, true},      Question{"dzhanibekov", 1, 0, true},
    Question{"bouncing_ball_1", 0, 0, true},  Question{"rolling_plate_no_erp", 0, 0, true},
    Question{"bullet_ccd_on", 0, 0, true},    Question{"stack_20", 1, 60, false},
    Question{"stack_20", 2, 60, false},       Question{"card_house", 1, 60, false},
    Question{"pyramid", 1, 60, false},        Question{"mass_ratio_100", 1, 60, true},
    Question{"mass_ratio_1000", 1, 60, true}, Question{"mass_ratio_1000", 0, 60, true},
    Question{"tiny_1cm", 1, 60, true},        Question{"newtons_cradle", 0, 0, true},
};

struct Candidate {
  std::string name;
  RunRules rules;
};

std::vector<Candidate> candidates() {
  std::vector<Candidate> all = {{"exact", preset_rules("exact")}};
  for (const auto& [hz, substeps] : {std::pair{60, 8}, {60, 16}, {60, 32}, {60, 64}, {240, 8}, {240, 32}, {960, 8}}) {
    RunRules rules = preset_rules("balanced");
    rules.step_hz = hz;
    rules.substeps = substeps;
    all.push_back({"soft_step, " + std::to_string(hz) + " Hz x " + std::to_string(substeps), rules});
  }
  return all;
}

Case case_of(const Question& question) {
  Case c = stability_case(question.case_name);
  if (question.duration_s > 0) c.duration_s = question.duration_s;
  return c;
}

/// '/' divides the parts of a case.
std::string without_slashes(std::string text) {
  for (std::size_t at = text.find('/'); at != std::string::npos; at = text.find('/')) text.replace(at, 1, "over");
  return text;
}

/// One case for all candidates, by turns.
class Comparison {
 public:
  explicit Comparison(const Case& c, std::size_t candidates) : case_(c), ratios_(candidates), errors_(candidates) {}

  bool add_round(const std::vector<Candidate>& all, const std::function<bool()>& go_on) {
    double exact_s = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!go_on()) return false;
      const MeasuredRun run = run_case(case_, all[i].rules, one_node());
      const double cpu_s = run.cpu_us_per_step * all[i].rules.step_hz;  // per simulated second
      if (i == 0) exact_s = cpu_s;
      ratios_[i].push_back(cpu_s / exact_s);
      errors_[i] = run.errors;
    }
    return true;
  }

  void rows_of(const Question& question, const std::vector<Candidate>& all, std::vector<ResultRow>& out) const {
    const Metric& metric = case_.metrics[question.metric];
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string what = without_slashes(case_.name + ": " + metric.measured) + "/" + all[i].name;
      out.push_back({what, "error", errors_[i][question.metric], metric.unit});
      out.push_back(
          {what, "time over that of exact", median(ratios_[i]), "ratio", static_cast<int>(ratios_[i].size())});
    }
  }

 private:
  Case case_;
  std::vector<std::vector<double>> ratios_;
  std::vector<std::vector<double>> errors_;
};

}  // namespace

std::vector<std::string> solvers_parts() {
  std::vector<std::string> parts;
  for (const Question& question : kQuestions) {
    if (parts.empty() || parts.back() != question.case_name) parts.emplace_back(question.case_name);
  }
  return parts;
}

SuiteResults run_solvers_suite(const SuitePlan& plan, const Progress& progress) {
  const int rounds = plan.is_full() ? 3 : 1;
  const std::vector<Candidate> all = candidates();
  SuiteResults results;
  const Question* before = nullptr;
  std::vector<Comparison> comparison;  // of the case of `before`
  double done = 0;
  const double whole = static_cast<double>(kQuestions.size() * all.size()) * rounds;
  for (const Question& question : kQuestions) {
    const bool belongs = plan.is_full() || question.quick || !plan.only.empty();
    if (!belongs || !plan.wants(question.case_name)) continue;
    const bool same_case = before != nullptr && std::string(before->case_name) == question.case_name;
    if (!same_case) {
      comparison.assign(1, Comparison(case_of(question), all.size()));
      for (int round = 0; round < rounds; ++round) {
        if (!comparison.front().add_round(all, [&] { return progress(done++ / whole); })) return results;
      }
    }
    comparison.front().rows_of(question, all, results.rows);
    before = &question;
  }
  return results;
}

}  // namespace aurasim::lab
