#include "lab/real_trials.h"

#include <algorithm>
#include <span>

#include "lab/trial.h"

namespace aurasim::lab {
namespace {

constexpr double kSideBySide_m = 2000;

/// One scene of all pairs side by side; pair k is bodies 2k and 2k+1.
core::Scene together(std::span<const Draw> draws) {
  core::Scene scene = draws.front().pair.scene;
  scene.bodies.clear();
  for (const Draw& draw : draws) {
    for (core::InitialBody body : draw.pair.scene.bodies) {
      body.id = core::BodyId{scene.bodies.size()};
      scene.bodies.push_back(body);
    }
  }
  return scene;
}

bool is_of(std::size_t pair, core::BodyId body) { return core::value_of(body) / 2 == pair; }

/// Number of broken promises of all nodes before the state in which region `seer` saw the contact. Late messages of
/// that state count, too, because they are known before it is computed.
std::uint64_t broken_before(core::Step step, const std::vector<Course>& courses, std::size_t seer) {
  std::uint64_t sum = 0;
  const auto at = [](const Course& course, core::Step s) {
    const auto i = static_cast<std::size_t>(std::max<core::Step>(0, s));
    return course.promises.empty() ? Course::Promises{} : course.promises[std::min(i, course.promises.size() - 1)];
  };
  for (std::size_t r = 0; r < courses.size(); ++r) {
    const Course::Promises before = at(courses[r], step - 1);
    sum += before.broken;
    if (r == seer) sum += at(courses[r], step).latency - before.latency;
  }
  return sum;
}

Trial trial_of(std::size_t pair, const std::vector<Course>& courses, const std::optional<Contact>& central,
               core::Step last) {
  Trial trial;
  if (central) trial.central_step = central->step;
  HandOffs hand_offs;
  std::size_t seer = courses.size();
  for (std::size_t r = 0; r < courses.size(); ++r) {
    for (const node::SeenCollision& seen : courses[r].contacts) {
      if (seen.missed || !is_of(pair, seen.collision.a) || !is_of(pair, seen.collision.b)) continue;
      if (trial.contact && trial.contact->step <= seen.collision.step) continue;
      trial.contact = contact_of(seen);
      trial.flagged = seen.flagged;
      seer = r;
    }
    for (const node::HandOffRow& row : courses[r].departures) {
      if (is_of(pair, row.body)) hand_offs.emplace(row.stamp, row.source, row.destination, row.reason);
    }
    trial.slow_down = std::max(trial.slow_down, courses[r].slow_down);
  }
  const core::Step met = trial.contact ? trial.contact->step : trial.central_step.value_or(last);
  trial.violations = broken_before(met, courses, seer);
  count_hand_offs(trial, hand_offs, met);
  trial.same_bits = trial.contact == central;
  return trial;
}

}  // namespace

RealLaboratory::RealLaboratory(std::uint32_t domain, std::filesystem::path profiles)
    : domain_(domain), profiles_(std::move(profiles)) {}

RealLaboratory::~RealLaboratory() = default;

RealCluster& RealLaboratory::cluster_for(const core::RegionMap& map, const Conditions& conditions) {
  const bool fits = cluster_ && map_version_ == map.version() && network_.latency_s == conditions.latency_s &&
                    network_.loss == conditions.loss;
  if (fits) return *cluster_;
  cluster_.reset();
  map_version_ = map.version();
  network_ = {domain_, profiles_, conditions.latency_s, conditions.loss, 1};
  cluster_ = std::make_unique<RealCluster>(map, network_);
  return *cluster_;
}

std::vector<Trial> RealLaboratory::run_job(const Campaign& campaign, const Job& job) {
  const Conditions conditions = conditions_at(job.series, job.value, campaign.substeps);
  std::vector<Trial> trials;
  const std::uint32_t at_once = job.pairs == PairKind::kCorner ? 1 : kPairsAtOnce;
  for (std::uint32_t first = 0; first < campaign.repeats; first += at_once) {
    std::vector<Draw> draws;
    std::vector<std::optional<Contact>> controls;
    core::Step last = 0;
    for (std::uint32_t repeat = first; repeat < std::min(first + at_once, campaign.repeats); ++repeat) {
      const double aside_m = kSideBySide_m * static_cast<double>(repeat - first);
      Draw& draw = draws.emplace_back(draw_pair(campaign, job, repeat, aside_m));
      const Trial control = control_of(draw, conditions);
      controls.push_back(control.contact);
      last = std::max(last, last_step(draw.pair, conditions, control.contact));
      trials.push_back(labelled(control, job, kControl, repeat));
    }
    const core::Scene scene = together(draws);
    for (const Variant& variant : campaign.variants) {
      const ClusterRules rules = rules_of(conditions, variant, draws.front().disorder);
      const std::vector<Course> courses = cluster_for(draws.front().pair.map, conditions).run(scene, rules, last);
      for (std::size_t k = 0; k < draws.size(); ++k) {
        Trial trial = trial_of(k, courses, controls[k], last);
        trials.push_back(labelled(trial, job, variant, first + static_cast<std::uint32_t>(k)));
      }
    }
  }
  return trials;
}

}  // namespace aurasim::lab
