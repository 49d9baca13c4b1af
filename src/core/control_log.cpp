#include "core/control_log.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace aurasim::core {
namespace {

/// Messages for a state further ahead are refused.
constexpr Step kFarthestAhead = 3600;
/// Limit of the entries of all programs together, whether in effect or for later states.
constexpr std::size_t kMostEntries = 4'000'000;
constexpr std::size_t kMostClients = 1000;

}  // namespace

Heard ControlLog::hear(const Setpoints& setpoints, Step computed, Step notice, std::size_t joint_count) {
  const auto is_unknown = [joint_count](const JointSetpoint& joint) { return core::value_of(joint.id) >= joint_count; };
  const std::size_t entries = bodies_.size() + joints_.size() + setpoints.bodies.size() + setpoints.joints.size();
  const bool has_room = entries <= kMostEntries && (words_.size() < kMostClients || words_.contains(setpoints.client));
  if (!has_room || setpoints.at_step > computed + kFarthestAhead || std::ranges::any_of(setpoints.joints, is_unknown)) {
    return Heard::kRefused;
  }
  const bool is_late = setpoints.at_step != 0 && setpoints.at_step <= computed;
  if (is_late && rules_.late == LateSetpoint::kDropped) {
    note_word(setpoints.client, computed + 1);  // the message still shows that the program is alive
    return Heard::kLate;
  }
  const bool names_none = setpoints.at_step == 0;
  take_in(setpoints, names_none ? computed + notice : is_late ? computed + 1 : setpoints.at_step);
  return is_late ? Heard::kLate : Heard::kInTime;
}

void ControlLog::recall(const Setpoints& setpoints) { take_in(setpoints, setpoints.at_step); }

void ControlLog::take_in(const Setpoints& setpoints, Step from) {
  const MessageStamp stamp{from, setpoints.client, setpoints.sequence};
  std::vector<SaidOfBody> bodies;
  bodies.reserve(setpoints.bodies.size());
  for (const BodySetpoint& body : setpoints.bodies) bodies.push_back({{body.id, body.quantity}, body.value});
  std::vector<OfJoints::Said> joints;
  joints.reserve(setpoints.joints.size());
  for (const JointSetpoint& joint : setpoints.joints) joints.push_back({joint.id, joint.drive});
  bodies_.add(stamp, std::move(bodies));
  joints_.add(stamp, std::move(joints));
  note_word(setpoints.client, from);
}

void ControlLog::note_word(std::uint64_t client, Step from) {
  if (client == kRecordedClient) return;
  std::deque<Step>& words = words_[client];
  const auto place = std::ranges::lower_bound(words, from);
  if (place == words.end() || *place != from) words.insert(place, from);
}

bool ControlLog::is_silent(std::uint64_t client, Step step) const {
  const auto words = words_.find(client);
  if (words == words_.end()) return client != kRecordedClient;
  const auto later = first_later(words->second, step, std::identity{});
  return later == words->second.begin() || step - *(later - 1) > rules_.silence;
}

std::optional<Vec3> ControlLog::value_in_silence(const HeldOfBody& held) const {
  const Quantity quantity = held.key.second;
  const bool stands_still =
      quantity == Quantity::kVelocity || quantity == Quantity::kSpin || quantity == Quantity::kDriving;
  if (rules_.on_silence == OnSilence::kZero || !stands_still) return std::nullopt;
  return Vec3(Vec3::Zero());
}

std::optional<JointDrive> ControlLog::value_in_silence(const HeldOfJoint& held) const {
  if (rules_.on_silence == OnSilence::kZero) return std::nullopt;
  JointDrive stopped = *held.value;
  stopped.speed = stopped.effort = 0;
  return stopped;
}

std::vector<Setpoints> ControlLog::since(Step step) const {
  std::map<MessageStamp, Setpoints> messages;
  const auto message = [&](const MessageStamp& stamp) -> Setpoints& {
    Setpoints& made = messages[stamp];
    made.at_step = stamp.from, made.client = stamp.client, made.sequence = stamp.sequence;
    return made;
  };
  const auto all = [](const auto&) { return true; };
  const auto of_body = [&](const MessageStamp& stamp, const BodyKey& key, const std::optional<Vec3>& value) {
    message(stamp).bodies.push_back({key.first, key.second, value});
  };
  const auto of_joint = [&](const MessageStamp& stamp, JointId id, const std::optional<JointDrive>& drive) {
    message(stamp).joints.push_back({id, drive});
  };
  // First the setpoints in effect in `step`, then all later ones.
  constexpr Step kEver = std::numeric_limits<Step>::max();
  bodies_.for_each(step, all, [&](const HeldOfBody& held) { of_body(held.stamp, held.key, held.value); });
  bodies_.for_each_later(step, kEver,
                         [&](const auto& stamp, const auto& said) { of_body(stamp, said.key, said.value); });
  joints_.for_each(step, all, [&](const HeldOfJoint& held) { of_joint(held.stamp, held.key, held.value); });
  joints_.for_each_later(step, kEver,
                         [&](const auto& stamp, const auto& said) { of_joint(stamp, said.key, said.value); });
  for (const auto& [client, words] : words_) {
    for (const Step word : words) message({word, client, 0});
  }
  std::vector<Setpoints> list;
  for (auto& [stamp, one] : messages) list.push_back(std::move(one));
  return list;
}

void ControlLog::forget_before(Step step) {
  bodies_.forget_before(step);
  joints_.forget_before(step);
  for (auto& [client, words] : words_) {
    const auto later = std::ranges::upper_bound(words, step);
    if (later - words.begin() > 1) words.erase(words.begin(), later - 1);
  }
  std::erase_if(words_, [&](const auto& of_client) { return of_client.second.back() + rules_.silence < step - 1; });
}

}  // namespace aurasim::core
