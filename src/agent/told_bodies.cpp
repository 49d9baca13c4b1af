#include "agent/told_bodies.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

namespace aurasim::agent {
namespace {

/// Knowledge of bodies that have changed host lately. Most bodies are in none of these sets.
struct Changing {
  std::set<core::BodyId> as_they_left, outside, exactly;
};

Changing changing_in(const Observations& told) {
  Changing known;
  for (const core::Observation* observation : told) {
    known.outside.insert(observation->outside.begin(), observation->outside.end());
    for (const core::ObservedBody& body : observation->bodies) {
      if (body.stale) known.as_they_left.insert(body.row.id);
    }
  }
  if (known.as_they_left.empty() && known.outside.empty()) return known;
  for (const core::Observation* observation : told) {
    for (const core::ObservedBody& body : observation->bodies) {
      const core::BodyId id = body.row.id;
      const bool matters = known.as_they_left.contains(id) || known.outside.contains(id);
      if (!body.stale && matters) known.exactly.insert(id);
    }
  }
  return known;
}

}  // namespace

std::vector<WorldBody> bodies_of(const Observations& told) {
  struct Row {
    const core::ObservedBody* body;
    bool under_way;
  };
  std::vector<Row> rows;
  for (const core::Observation* observation : told) {
    const bool is_made_up = observation->kind == core::Observation::Kind::kMadeUp;
    for (const core::ObservedBody& body : observation->bodies) {
      rows.push_back({&body, is_made_up || body.row.host != observation->source});
    }
  }
  const auto rank = [](const Row& row) {
    return std::tuple(row.body->row.id, ~row.body->row.epoch, row.body->stale, row.under_way);
  };
  std::ranges::stable_sort(rows, {}, rank);
  // A body that was in a box when it left may be outside or removed by now.
  const Changing known = changing_in(told);
  std::vector<WorldBody> bodies;
  for (const Row& row : rows) {
    const core::BodyId id = row.body->row.id;
    if (known.outside.contains(id) && !known.exactly.contains(id)) continue;
    if (bodies.empty() || bodies.back().row.id != id) bodies.push_back({row.body->row, row.under_way});
  }
  return bodies;
}

std::vector<core::BodyId> missing_in(const Observations& told) {
  const Changing known = changing_in(told);
  std::vector<core::BodyId> missing;
  std::ranges::copy_if(known.as_they_left, std::back_inserter(missing),
                       [&](core::BodyId id) { return !known.exactly.contains(id) && !known.outside.contains(id); });
  return missing;
}

}  // namespace aurasim::agent
