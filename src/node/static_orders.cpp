#include "node/static_orders.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/fnv1a.h"

namespace aurasim::node {
namespace {

/// Maximum number of move orders given in one state. The limit exists because every node repeats each order.
constexpr std::size_t kMostMovesInAState = 256;

/// A run that went back kMostDoubts times within kDoubtsWithin states, because setpoints of statics came late to some
/// nodes, waits for orders instead.
constexpr std::size_t kMostDoubts = 3;
constexpr core::Step kDoubtsWithin = 1800;

constexpr std::size_t kMostLateWords = 256;

}  // namespace

std::uint64_t request_of(const core::Setpoints& said, core::StaticId id) {
  core::Fnv1a hash;
  for (const std::uint64_t part :
       {said.client, said.sequence, static_cast<std::uint64_t>(said.at_step), std::uint64_t{core::value_of(id)}}) {
    hash.add_word(part);
  }
  return std::max<std::uint64_t>(hash.value(), 1);
}

std::uint64_t request_of(const core::StaticEffect& recorded) {
  core::Setpoints said;
  said.client = core::kRecordedClient;
  said.at_step = recorded.step;
  return request_of(said, recorded.setpoint.id);
}

StaticOrders::StaticOrders(const std::vector<core::Setpoints>& recorded) {
  for (const core::Setpoints& said : recorded) {
    for (const core::StaticSetpoint& goal : said.statics) recorded_.push_back({said.at_step, goal});
  }
  std::ranges::stable_sort(recorded_, {}, &core::StaticEffect::step);
}

const core::StaticEffect* StaticOrders::next_recorded(core::Step until) const {
  const bool is_due = next_recorded_ < recorded_.size() && recorded_[next_recorded_].step <= until;
  return is_due ? &recorded_[next_recorded_] : nullptr;
}

bool StaticOrders::may_order(core::Step now) {
  if (std::exchange(ordered_for_, now) != now) ordered_ = 0;
  return ++ordered_ <= kMostMovesInAState;
}

bool StaticOrders::are_believed(core::Step now) const {
  const auto lately = std::ranges::count_if(doubted_, [now](core::Step step) { return step > now - kDoubtsWithin; });
  return static_cast<std::size_t>(lately) < kMostDoubts;
}

void LateWords::note(core::Step at_step, core::Step heard) {
  words_.push_back({at_step, heard});
  if (words_.size() > kMostLateWords) words_.erase(words_.begin());
}

std::vector<LateWords::Word> LateWords::that_matter(core::Step from, core::Step until) const {
  std::vector<Word> matter;
  std::ranges::copy_if(words_, std::back_inserter(matter),
                       [&](const Word& word) { return word.heard >= from && word.at_step <= until; });
  return matter;
}

}  // namespace aurasim::node
