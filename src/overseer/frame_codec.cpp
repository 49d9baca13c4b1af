#include "overseer/frame_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

namespace aurasim::overseer {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

constexpr std::uint16_t kVersion = 2;
constexpr std::uint8_t kFrame = 1;
constexpr std::uint8_t kOverlays = 2;
constexpr std::uint8_t kKeyFrame = 1;
constexpr std::uint16_t kAsleep = 1, kUnderWay = 2, kHandedOver = 4;

// Bits for each slot of a client: what it has, and what it has to be sent.
constexpr std::uint8_t kKnown = 1;     ///< the client has the body in this slot
constexpr std::uint8_t kOutlived = 2;  ///< the client has a body that is no longer in this slot
constexpr std::uint8_t kHostNews = 4;
constexpr std::uint8_t kMoveNews = 8;
constexpr std::uint8_t kHandOffNews = 16;
constexpr std::uint8_t kListed = 32;
constexpr std::uint8_t kNew = 64;  ///< within encode(): the whole pose has to be sent

// Encoding of a pose, in the head of its row.
constexpr std::uint8_t kByteSteps = 1, kWordSteps = 2, kWholePosition = 3;
constexpr std::uint8_t kByteLevels = 1 << 2, kWholeRotation = 2 << 2;
constexpr std::uint8_t kFarSlot = 15;  ///< the slot number follows; lower values: number of slots skipped
/// Angle of one level of a rotation's component.
constexpr double kLevel_rad = 2 * std::numbers::sqrt2 / 1023;
/// Distance from a body's centre at which its rotation is judged, metres.
constexpr double kReach_m = 1;

class Writer {
 public:
  explicit Writer(std::size_t size) { bytes_.reserve(size); }

  template <class Number>
  void put(Number value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void put_count(std::size_t count) { put(static_cast<std::uint32_t>(count)); }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

ToldPose told_pose(const ViewBody& body) {
  ToldPose told;
  for (std::size_t i = 0; i < 3; ++i) told.p[i] = std::llround(body.p_WB[static_cast<Eigen::Index>(i)] / kGrid_m);
  told.q = pack_rotation(body.q_WB);
  return told;
}

int level(std::uint32_t packed, unsigned shift) { return static_cast<int>((packed >> shift) & 1023U); }

/// Returns the greatest difference of a component, in levels. If another component is left out, returns more than the
/// number of levels.
int levels_between(std::uint32_t a, std::uint32_t b) {
  if (a >> 30U != b >> 30U) return 1024;
  int most = 0;
  for (const unsigned shift : {20U, 10U, 0U}) most = std::max(most, std::abs(level(a, shift) - level(b, shift)));
  return most;
}

void put_host(const ViewBody& body, bool handed_over, Writer& out) {
  std::uint16_t flags = 0;
  if (body.asleep) flags |= kAsleep;
  if (body.under_way) flags |= kUnderWay;
  if (handed_over) flags |= kHandedOver;
  out.put(body.slot);
  out.put(static_cast<std::uint16_t>(core::value_of(body.host)));
  out.put(flags);
  out.put(body.epoch);
}

/// Writes the rows of poses. Rows must come by ascending slot.
class PoseRows {
 public:
  explicit PoseRows(Writer& out) : out_(out) {}

  void put(Slot slot, const ToldPose& before, const ToldPose& now, bool is_new) {
    const std::uint8_t position = is_new ? kWholePosition : way_of_position(before, now);
    const std::uint8_t rotation = is_new ? kWholeRotation : way_of_rotation(before.q, now.q);
    const Slot gap = slot - next_;
    next_ = slot + 1;
    const auto passed = static_cast<std::uint8_t>(gap < kFarSlot ? gap : kFarSlot);
    out_.put(static_cast<std::uint8_t>(position | rotation | passed << 4U));
    if (passed == kFarSlot) out_.put(slot);
    put_position(position, before, now);
    put_rotation(rotation, before.q, now.q);
  }

 private:
  static std::uint8_t way_of_position(const ToldPose& before, const ToldPose& now) {
    std::int64_t most = 0;
    for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(now.p[i] - before.p[i]));
    if (most == 0) return 0;
    return most <= 127 ? kByteSteps : most <= 32767 ? kWordSteps : kWholePosition;
  }

  static std::uint8_t way_of_rotation(std::uint32_t before, std::uint32_t now) {
    if (before == now) return 0;
    return levels_between(before, now) <= 127 ? kByteLevels : kWholeRotation;
  }

  void put_position(std::uint8_t way, const ToldPose& before, const ToldPose& now) {
    for (std::size_t i = 0; i < 3 && way != 0; ++i) {
      if (way == kByteSteps) out_.put(static_cast<std::int8_t>(now.p[i] - before.p[i]));
      if (way == kWordSteps) out_.put(static_cast<std::int16_t>(now.p[i] - before.p[i]));
      if (way != kWholePosition) continue;
      out_.put(static_cast<std::uint32_t>(now.p[i]));
      out_.put(static_cast<std::int16_t>(now.p[i] >> 32));
    }
  }

  void put_rotation(std::uint8_t way, std::uint32_t before, std::uint32_t now) {
    if (way == kWholeRotation) out_.put(now);
    if (way != kByteLevels) return;
    for (const unsigned shift : {20U, 10U, 0U})
      out_.put(static_cast<std::int8_t>(level(now, shift) - level(before, shift)));
  }

  Writer& out_;
  Slot next_ = 0;
};

}  // namespace

void SlotTable::apply(const WorldFrame& frame) {
  if (frame.restart) {
    bodies_.clear();
    alive_.clear();
    count_ = 0;
  }
  for (const Slot slot : frame.deleted) {
    count_ -= alive_[slot];
    alive_[slot] = 0;
  }
  for (const BodyChange& change : frame.changed) {
    const Slot slot = change.body.slot;
    if (slot >= bodies_.size()) {
      bodies_.resize(slot + 1);
      alive_.resize(slot + 1, 0);
    }
    count_ += 1U - alive_[slot];
    alive_[slot] = 1;
    bodies_[slot] = change.body;
  }
  generation_ = frame.generation;
  stamp_ = frame.stamp;
}

void ClientFrames::forget() {
  states_.clear();
  listed_.clear();
  key_ = true;
}

std::uint8_t& ClientFrames::state(Slot slot) {
  if (slot >= states_.size()) states_.resize(slot + 1, 0);
  if ((states_[slot] & kListed) == 0) {
    states_[slot] |= kListed;
    listed_.push_back(slot);
  }
  return states_[slot];
}

void ClientFrames::note(const WorldFrame& frame) {
  if (has_news_) ++merged_;
  has_news_ = true;
  if (frame.restart) forget();
  if (key_) return;  // a key frame lists everything anyway
  for (const Slot slot : frame.deleted) {
    std::uint8_t& bits = state(slot);
    if ((bits & kKnown) != 0) bits |= kOutlived;
    bits &= kOutlived | kListed;
  }
  for (const BodyChange& change : frame.changed) {
    std::uint8_t& bits = state(change.body.slot);
    if (change.host_changed) bits |= kHostNews;
    if (change.moved) bits |= kMoveNews;
    if (change.handed_over) bits |= kHandOffNews;
  }
}

void ClientFrames::list_everything(const SlotTable& table) {
  states_.assign(table.slot_count(), 0);
  listed_.clear();
  for (Slot slot = 0; slot < table.slot_count(); ++slot) state(slot);
}

ClientFrames::Move ClientFrames::move_of(const ViewBody& body) const {
  const ToldPose now = told_pose(body);
  const ToldPose& told = told_[body.slot];
  if (now.p == told.p && now.q == told.q) return Move::kNone;
  if (!eye_) return Move::kSeen;
  const core::Vec3 off(static_cast<double>(now.p[0] - told.p[0]), static_cast<double>(now.p[1] - told.p[1]),
                       static_cast<double>(now.p[2] - told.p[2]));
  const double unseen_m = unseen_error_m(*eye_, body.p_WB);
  const double turned_m = kReach_m * kLevel_rad * levels_between(now.q, told.q);
  return off.norm() * kGrid_m <= unseen_m && turned_m <= unseen_m ? Move::kUnseen : Move::kSeen;
}

ClientFrames::Lists ClientFrames::sort_out(const SlotTable& table) {
  Lists lists;
  told_.resize(table.slot_count());
  std::vector<Slot> unseen;
  std::sort(listed_.begin(), listed_.end());
  for (const Slot slot : listed_) {
    std::uint8_t& bits = states_[slot];
    const bool is_new = (bits & kKnown) == 0 || (bits & kOutlived) != 0;
    if ((bits & kOutlived) != 0) lists.deleted.push_back(slot);
    if (table.body(slot) == nullptr) {
      bits = 0;
      continue;
    }
    if (is_new) lists.created.push_back(slot);
    if (is_new || (bits & (kHostNews | kHandOffNews)) != 0) lists.hosts.push_back(slot);
    const Move move = is_new ? Move::kSeen : (bits & kMoveNews) != 0 ? move_of(*table.body(slot)) : Move::kNone;
    if (move == Move::kSeen) lists.moved.push_back(slot);
    bits = static_cast<std::uint8_t>(kKnown | (bits & kHandOffNews) | (is_new ? kNew : 0));
    if (move != Move::kUnseen) continue;
    bits |= kMoveNews | kListed;
    unseen.push_back(slot);
  }
  listed_ = std::move(unseen);
  return lists;
}

Bytes ClientFrames::encode(const SlotTable& table) {
  const bool key = std::exchange(key_, false);
  has_news_ = false;
  if (key) list_everything(table);
  const Lists lists = sort_out(table);
  Writer out(32 + 4 * lists.deleted.size() + 16 * lists.created.size() + 12 * lists.hosts.size() +
             12 * lists.moved.size());
  out.put(kFrame);
  out.put(key ? kKeyFrame : std::uint8_t{0});
  out.put(kVersion);
  out.put(table.generation());
  out.put(static_cast<double>(table.stamp()));
  for (const auto* list : {&lists.deleted, &lists.created, &lists.hosts, &lists.moved}) out.put_count(list->size());
  for (const Slot slot : lists.deleted) out.put(slot);
  for (const Slot slot : lists.created) {
    const std::uint64_t id = core::value_of(table.body(slot)->id);
    out.put(slot);
    out.put(core::value_of(table.body(slot)->prototype));
    out.put(static_cast<std::uint32_t>(id));
    out.put(static_cast<std::uint32_t>(id >> 32U));
  }
  for (const Slot slot : lists.hosts) {
    put_host(*table.body(slot), (states_[slot] & kHandOffNews) != 0, out);
    states_[slot] = static_cast<std::uint8_t>(states_[slot] & ~kHandOffNews);
  }
  PoseRows rows(out);
  for (const Slot slot : lists.moved) {
    const ToldPose now = told_pose(*table.body(slot));
    rows.put(slot, told_[slot], now, (states_[slot] & kNew) != 0);
    told_[slot] = now;
    states_[slot] = static_cast<std::uint8_t>(states_[slot] & ~kNew);
  }
  return out.take();
}

std::uint32_t pack_rotation(const Eigen::Quaternionf& q) {
  const std::array<float, 4> c = {q.w(), q.x(), q.y(), q.z()};
  std::uint32_t largest = 0;
  for (std::uint32_t i = 1; i < 4; ++i) {
    if (std::abs(c[i]) > std::abs(c[largest])) largest = i;
  }
  const float sign = c[largest] < 0 ? -1.0F : 1.0F;
  std::uint32_t packed = largest << 30U;
  std::uint32_t shift = 20;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const float scaled = (sign * c[i] * std::sqrt(2.0F) + 1) / 2 * 1023;
    packed |= static_cast<std::uint32_t>(std::lround(std::clamp(scaled, 0.0F, 1023.0F))) << shift;
    shift -= 10;
  }
  return packed;
}

Eigen::Quaternionf unpack_rotation(std::uint32_t packed) {
  const std::uint32_t largest = packed >> 30U;
  std::array<float, 4> c{};
  float squares = 0;
  std::uint32_t shift = 20;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    c[i] = (static_cast<float>((packed >> shift) & 1023U) / 1023 * 2 - 1) / std::sqrt(2.0F);
    squares += c[i] * c[i];
    shift -= 10;
  }
  c[largest] = std::sqrt(std::max(0.0F, 1 - squares));
  return {c[0], c[1], c[2], c[3]};
}

Bytes encode_overlays(std::span<const AuraDisc> auras, std::span<const SlotPair> links,
                      std::span<const SlotPair> contacts) {
  Writer out(16 + 8 * (auras.size() + links.size() + contacts.size()));
  out.put(kOverlays);
  out.put(std::uint8_t{0});
  out.put(kVersion);
  for (const std::size_t count : {auras.size(), links.size(), contacts.size()}) out.put_count(count);
  for (const AuraDisc& aura : auras) {
    out.put(aura.slot);
    out.put(aura.radius_m);
  }
  for (const auto pairs : {links, contacts}) {
    for (const SlotPair& pair : pairs) {
      out.put(pair.a);
      out.put(pair.b);
    }
  }
  return out.take();
}

}  // namespace aurasim::overseer
