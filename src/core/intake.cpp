#include "core/intake.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace aurasim::core {
namespace {

/// A message further ahead of the neighbour's newest batch is refused. Batches arrive in order, so those missing in
/// between will never arrive.
constexpr Step kMostStatesAhead = 4096;
/// Most messages of one kind that are kept for a later generation or redo, which begins within seconds.
constexpr std::ptrdiff_t kMostForLater = 10'000;

/// Calls take(message) for the messages of this generation and redo or earlier ones. Keeps those of later ones in
/// `messages`, up to kMostForLater.
template <class Message, class Take>
void take_all(std::vector<Message>& messages, const IntakeSettings& settings, Take take) {
  auto kept = messages.begin();
  for (Message& message : messages) {
    if (std::pair(message.generation, message.redo) > std::pair(settings.generation, settings.redo)) {
      if (&*kept != &message) *kept = std::move(message);
      ++kept;
    } else {
      take(message);
    }
  }
  messages.erase(std::min(kept, messages.begin() + std::min(std::ssize(messages), kMostForLater)), messages.end());
}

/// Concatenates what each neighbour returns.
template <class Row>
std::vector<Row> take_from(std::vector<Neighbour>& neighbours, std::vector<Row> (Neighbour::*take)()) {
  std::vector<Row> all;
  for (Neighbour& neighbour : neighbours) {
    const std::vector<Row> rows = (neighbour.*take)();
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

}  // namespace

Intake::Intake(const IntakeSettings& settings, const Vicinity& vicinity, DepartureLedger& departures)
    : settings_(settings), vicinity_(vicinity), map_version_(vicinity.map.version()), departures_(departures) {
  for (const RegionId id : vicinity.neighbours) {
    neighbours_.emplace_back(id, vicinity.self, settings.start);
    if (settings.knows_start) neighbours_.back().await_gathering();
  }
}

const Neighbour* Intake::find(RegionId id) const {
  const auto found = std::lower_bound(neighbours_.begin(), neighbours_.end(), id,
                                      [](const Neighbour& n, RegionId region) { return n.id() < region; });
  return found != neighbours_.end() && found->id() == id ? &*found : nullptr;
}

Neighbour* Intake::find(RegionId id) { return const_cast<Neighbour*>(std::as_const(*this).find(id)); }

/// The region that has published state `stamp`, or is to: one that leaves, or a neighbour.
Neighbour* Intake::speaker(RegionId id, Step stamp) {
  for (Leaver& leaver : leavers_) {
    if (leaver.neighbour.id() == id && stamp < leaver.end) return &leaver.neighbour;
  }
  return find(id);
}

template <class Message>
bool Intake::belongs(const Message& message, std::uint64_t map_version) {
  const Neighbour* neighbour = speaker(message.source, message.stamp);
  const bool is_current = message.generation == settings_.generation && map_version == map_version_;
  if (neighbour && neighbour->alive() && is_current) return message.redo == settings_.redo;
  ++counters_.strangers;
  return false;
}

/// True if the message is of a region that is not a neighbour of this node yet. That region may have received the
/// introduction before this node.
template <class Message>
bool Intake::is_early(const Message& message) {
  const bool is_region = value_of(message.source) < vicinity_.map.size() && message.source != vicinity_.self;
  return is_region && speaker(message.source, message.stamp) == nullptr && message.generation == settings_.generation &&
         message.redo == settings_.redo && message.map_version == map_version_;
}

/// Drops early messages of regions that were never introduced to us.
void Intake::forget_early(Step before) {
  std::erase_if(early_.auras, [before](const AuraBatch& batch) { return batch.stamp < before; });
  std::erase_if(early_.hand_offs, [before](const HandOff& hand_off) { return hand_off.stamp < before; });
}

void Intake::listen_to(RegionId region, Step begin) {
  if (find(region) != nullptr) return;
  const auto place = std::lower_bound(neighbours_.begin(), neighbours_.end(), region,
                                      [](const Neighbour& n, RegionId id) { return n.id() < id; });
  neighbours_.insert(place, Neighbour(region, vicinity_.self, begin));
  Inbox came = std::exchange(early_, {});
  accept(came);
}

void Intake::leave(RegionId region, Step end) {
  const auto place = std::ranges::find(neighbours_, region, &Neighbour::id);
  if (place == neighbours_.end()) return;
  leavers_.push_back({std::move(*place), end});
  neighbours_.erase(place);
}

bool Intake::is_alive(RegionId region) const {
  const Neighbour* const neighbour = find(region);
  return neighbour == nullptr || neighbour->alive();
}

/// Forgets those of which everything had taken effect when receive() was called last.
void Intake::forget_leavers() {
  std::erase_if(leavers_, [this](const Leaver& leaver) {
    if (leaver.neighbour.alive() && leaver.neighbour.applied() < leaver.end - 1) return false;
    if (!has_all(leaver.neighbour, leaver.end - 1)) return false;
    left_.push_back(leaver.neighbour.id());
    return true;
  });
}

void Intake::accept(Inbox& inbox) {
  take_all(inbox.auras, settings_, [this](AuraBatch& batch) {
    if (is_early(batch)) {
      if (std::ssize(early_.auras) < kMostForLater) early_.auras.push_back(std::move(batch));
      return;
    }
    if (!belongs(batch, batch.map_version)) return;
    Neighbour& neighbour = *speaker(batch.source, batch.stamp);
    if (batch.word > 0) {
      const bool is_new = batch.word == kGathered ? batch.stamp == settings_.start && neighbour.note_gathered(batch)
                                                  : neighbour.accept_word(std::move(batch));
      if (!is_new) ++counters_.copies;
      return;
    }
    if (batch.stamp > neighbour.received() + kMostStatesAhead) {
      return accept(Refusal{batch.source, batch.generation, batch.stamp, MessageKind::kAura, "far ahead", batch.redo});
    }
    note_adopted(batch);
    if (!neighbour.accept(std::move(batch), arrived_)) ++counters_.copies;
  });
  take_all(inbox.hand_offs, settings_, [this](HandOff& hand_off) { accept(hand_off); });
  take_all(inbox.refusals, settings_, [this](const Refusal& refusal) { accept(refusal); });
  for (const PeerEvent& event : inbox.peers) accept(event);
  inbox.peers.clear();
}

void Intake::accept(HandOff& hand_off) {
  if (hand_off.destination != vicinity_.self) return;
  if (is_early(hand_off)) {
    if (std::ssize(early_.hand_offs) < kMostForLater) early_.hand_offs.push_back(std::move(hand_off));
    return;
  }
  if (!belongs(hand_off, hand_off.map_version)) return;
  if (hand_off.stamp > speaker(hand_off.source, hand_off.stamp)->received() + kMostStatesAhead) {
    return accept(Refusal{hand_off.source, hand_off.generation, hand_off.stamp, MessageKind::kHandOff, "far ahead",
                          hand_off.redo});
  }
  if (arrivals_.first_copy(hand_off.source, hand_off.sequence)) {
    waiting_.push_back(std::move(hand_off));
  } else {
    ++counters_.copies;
  }
}

/// Forgets the hand-offs that the source of the batch has adopted. A batch that comes twice says nothing new.
void Intake::note_adopted(const AuraBatch& batch) {
  for (const HandOffMark& mark : batch.adopted) {
    if (mark.region == vicinity_.self) departures_.acknowledge(batch.source, mark.last_sequence);
  }
}

/// Marks the source of a refused message dead. The message is lost and later ones are useless without it, so waiting
/// for that neighbour would never end.
void Intake::accept(const Refusal& refusal) {
  Neighbour* const neighbour = speaker(refusal.source, refusal.stamp);
  if (!neighbour || !neighbour->alive() || refusal.generation != settings_.generation) {
    ++counters_.strangers;
    return;
  }
  refusals_.push_back(refusal);
  mark_dead(*neighbour);
}

void Intake::accept(const PeerEvent& event) {
  Neighbour* neighbour = find(event.region);
  if (neighbour && neighbour->alive() && event.change == PeerChange::kLost) mark_dead(*neighbour);
  for (Leaver& leaver : leavers_) {
    const bool is_lost = leaver.neighbour.id() == event.region && event.change == PeerChange::kLost;
    if (is_lost && leaver.neighbour.alive()) mark_dead(leaver.neighbour);
  }
}

void Intake::mark_dead(Neighbour& neighbour) {
  neighbour.mark_dead();
  std::erase_if(waiting_, [&](const HandOff& h) { return h.source == neighbour.id(); });
}

/// The stamp up to which all messages have to be here before state `n` is computed.
Step Intake::needed_for(Step n) const {
  return settings_.knows_start ? std::max(n - settings_.lookahead, settings_.start) : n - settings_.lookahead;
}

bool Intake::keeps_waiting(const Neighbour& neighbour, Step n) const {
  const Step needed = needed_for(n);
  if (neighbour.alive() && !neighbour.has_gathered()) return true;
  return needed >= settings_.start && !has_all(neighbour, needed);
}

/// Nothing is waited for that it does not publish any more.
bool Intake::keeps_waiting(const Leaver& leaver, Step n) const {
  return keeps_waiting(leaver.neighbour, std::min(n, leaver.end - 1 + settings_.lookahead));
}

bool Intake::knows_all_of_start() const {
  return std::ranges::all_of(neighbours_, [&](const Neighbour& q) { return has_all(q, settings_.start); });
}

void Intake::take_start() {
  for (Neighbour& neighbour : neighbours_) {
    if (neighbour.alive()) neighbour.apply_until(settings_.start);
  }
}

bool Intake::has_all(const Neighbour& neighbour, Step until) const {
  return !neighbour.alive() ||
         (neighbour.received() >= until && arrivals_.has_all_up_to(neighbour.id(), neighbour.hand_offs_until(until)));
}

bool Intake::has_all(RegionId region, Step until) const {
  const Neighbour* const neighbour = find(region);
  return neighbour == nullptr || has_all(*neighbour, until);
}

/// A region that begins to listen in a later state is not waited for: the first words may have gone out before its
/// reader was matched, and no body of the two can meet before that state.
bool Intake::all_have_said(Step stamp, std::uint32_t number) const {
  return std::ranges::all_of(neighbours_, [&](const Neighbour& neighbour) {
    return !neighbour.alive() || neighbour.start() > stamp || neighbour.word(stamp, number) != nullptr;
  });
}

bool Intake::ready(Step n) const {
  if (settings_.sync == SyncMode::kFreeRunning) return true;
  return std::ranges::none_of(neighbours_, [&](const Neighbour& q) { return keeps_waiting(q, n); }) &&
         std::ranges::none_of(leavers_, [&](const Leaver& q) { return keeps_waiting(q, n); });
}

std::vector<RegionId> Intake::missing(Step n) const {
  std::vector<RegionId> regions;
  for (const Neighbour& neighbour : neighbours_) {
    if (keeps_waiting(neighbour, n)) regions.push_back(neighbour.id());
  }
  for (const Leaver& leaver : leavers_) {
    if (keeps_waiting(leaver, n)) regions.push_back(leaver.neighbour.id());
  }
  return regions;
}

/// Messages with stamps up to the returned one take effect in state `n`: exactly K steps late in deterministic mode,
/// else as soon as they are here, but never before the state that they describe.
Step Intake::effect_limit(Step n) const { return settings_.sync == SyncMode::kDeterministic ? needed_for(n) : n - 1; }

std::vector<Adoption> Intake::receive(Step n, ViolationLog& violations, Joining joining) {
  forget_leavers();
  const Step limit = effect_limit(n);
  for (Leaver& leaver : leavers_) leaver.neighbour.apply_until(limit);
  for (Neighbour& neighbour : neighbours_) {
    if (!neighbour.alive()) continue;
    neighbour.apply_until(limit);
    const Step age = n - neighbour.applied();
    if (age > settings_.lookahead && n - settings_.start > settings_.lookahead) {
      violations.add({ViolationKind::kLatency, n, neighbour.id(), {}, double(age), double(settings_.lookahead)});
    }
  }
  adopt_due(joining == Joining::kAll ? std::numeric_limits<Step>::max() : limit, n, violations);
  constexpr Step kEarlyMemory = 256;
  forget_early(n - kEarlyMemory);
  return std::exchange(adoptions_, {});
}

void Intake::adopt_due(Step limit, Step n, ViolationLog& violations) {
  std::sort(waiting_.begin(), waiting_.end(), [](const HandOff& a, const HandOff& b) {
    return std::tie(a.stamp, a.source, a.sequence) < std::tie(b.stamp, b.source, b.sequence);
  });
  auto due_end = waiting_.begin();
  for (; due_end != waiting_.end() && due_end->stamp <= limit; ++due_end) {
    if (n - due_end->stamp > settings_.lookahead) {
      violations.add(
          {ViolationKind::kLatency, n, due_end->source, {}, double(n - due_end->stamp), double(settings_.lookahead)});
    }
    adopt(*due_end);
  }
  waiting_.erase(waiting_.begin(), due_end);
}

void Intake::adopt(HandOff& hand_off) {
  if (hand_off.cluster.bodies.empty()) return;
  counters_.adopted += hand_off.cluster.bodies.size();
  adoptions_.push_back(
      {hand_off.source, hand_off.stamp, hand_off.sequence, hand_off.reason, std::move(hand_off.cluster)});
}

std::vector<RegionId> Intake::dead_regions() const {
  std::vector<RegionId> dead;
  for (const Neighbour& neighbour : neighbours_) {
    if (!neighbour.alive()) dead.push_back(neighbour.id());
  }
  return dead;
}

std::vector<Order> Intake::take_orders(const Inbox& inbox) {
  std::vector<Order> orders = take_from(neighbours_, &Neighbour::take_orders);
  for (const AuraBatch& batch : inbox.auras) {
    const Neighbour* const neighbour = find(batch.source);
    if (!neighbour || !neighbour->alive() || batch.generation != settings_.generation) continue;
    orders.insert(orders.end(), batch.orders.begin(), batch.orders.end());
  }
  return orders;
}

std::vector<Alarm> Intake::take_alarms() { return take_from(neighbours_, &Neighbour::take_alarms); }

std::vector<Neighbour::Introduced> Intake::take_introductions() {
  std::vector<Neighbour::Introduced> all = take_from(neighbours_, &Neighbour::take_introductions);
  for (Leaver& leaver : leavers_) {
    const std::vector<Neighbour::Introduced> last = leaver.neighbour.take_introductions();
    all.insert(all.end(), last.begin(), last.end());
  }
  return all;
}

std::vector<HandOffMark> Intake::adopted() const {
  std::vector<HandOffMark> marks = arrivals_.all_arrived();
  for (HandOffMark& mark : marks) {
    for (const HandOff& waiting : waiting_) {
      if (waiting.source == mark.region) mark.last_sequence = std::min(mark.last_sequence, waiting.sequence - 1);
    }
  }
  std::erase_if(marks, [](const HandOffMark& mark) { return mark.last_sequence == 0; });
  return marks;
}

}  // namespace aurasim::core
