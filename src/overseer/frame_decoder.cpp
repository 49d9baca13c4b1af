#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "overseer/frame_codec.h"

namespace aurasim::overseer {
namespace {

constexpr std::uint32_t kMostSlots = 1'000'000;

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  /// Reads a number. Returns 0 beyond the end; ok() is false from then on.
  template <class Number>
  Number get() {
    Number value{};
    if (bytes_.size() < sizeof value) {
      ok_ = false;
      return value;
    }
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
    return value;
  }
  void refuse() { ok_ = false; }
  bool ok() const { return ok_; }
  bool at_end() const { return bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool ok_ = true;
};

class FrameReader {
 public:
  FrameReader(std::span<const std::uint8_t> bytes, const SlotTable& before, std::vector<ToldPose>& told)
      : in_(bytes), before_(before), told_(told) {}

  std::optional<WorldFrame> read() {
    read_header();
    if (!in_.ok()) return std::nullopt;
    for (std::uint32_t i = 0; i < counts_[0]; ++i) read_deleted();
    for (std::uint32_t i = 0; i < counts_[1]; ++i) read_created();
    for (std::uint32_t i = 0; i < counts_[2]; ++i) read_host();
    for (std::uint32_t i = 0; i < counts_[3]; ++i) read_pose();
    if (!in_.ok() || !in_.at_end()) return std::nullopt;
    for (const auto& [slot, change] : changes_) frame_.changed.push_back(change);
    return std::move(frame_);
  }

 private:
  void read_header() {
    const auto type = in_.get<std::uint8_t>();
    const auto flags = in_.get<std::uint8_t>();
    const auto version = in_.get<std::uint16_t>();
    frame_.generation = in_.get<std::uint32_t>();
    const auto stamp = in_.get<double>();
    for (std::uint32_t& count : counts_) count = in_.get<std::uint32_t>();
    frame_.restart = (flags & 1) != 0;
    const std::uint64_t rows = std::uint64_t{counts_[0]} + counts_[1] + counts_[2] + counts_[3];
    const bool sound = type == 1 && version == 2 && stamp >= 0 && stamp < 1e15 && rows <= in_.left();
    if (!sound) return in_.refuse();
    frame_.stamp = static_cast<core::Step>(stamp);
  }

  bool is_there(Slot slot) const { return !frame_.restart && before_.body(slot) != nullptr; }

  void read_deleted() {
    const auto slot = in_.get<Slot>();
    if (!is_there(slot)) return in_.refuse();
    frame_.deleted.push_back(slot);
  }

  void read_created() {
    const auto slot = in_.get<Slot>();
    BodyChange change;
    change.created = true;
    change.body.slot = slot;
    change.body.prototype = core::PrototypeId{in_.get<std::uint32_t>()};
    const std::uint64_t low = in_.get<std::uint32_t>();
    change.body.id = core::BodyId{low | std::uint64_t{in_.get<std::uint32_t>()} << 32U};
    if (slot >= kMostSlots || !changes_.emplace(slot, change).second) return in_.refuse();
    if (slot >= told_.size()) told_.resize(slot + 1);
  }

  BodyChange& change_of(Slot slot) {
    const auto found = changes_.find(slot);
    if (found != changes_.end()) return found->second;
    if (!is_there(slot)) {
      in_.refuse();
      return nowhere_;
    }
    BodyChange change;
    change.body = *before_.body(slot);
    return changes_.emplace(slot, change).first->second;
  }

  void read_host() {
    BodyChange& change = change_of(in_.get<Slot>());
    change.host_changed = true;
    change.body.host = core::RegionId{in_.get<std::uint16_t>()};
    const auto flags = in_.get<std::uint16_t>();
    change.body.asleep = (flags & 1) != 0;
    change.body.under_way = (flags & 2) != 0;
    change.handed_over = (flags & 4) != 0;
    change.body.epoch = in_.get<std::uint32_t>();
  }

  void read_pose() {
    const auto head = in_.get<std::uint8_t>();
    const auto passed = static_cast<std::uint8_t>(head >> 4U);
    const Slot slot = passed == 15 ? in_.get<Slot>() : next_ + passed;
    next_ = slot + 1;
    BodyChange& change = change_of(slot);
    if (!in_.ok()) return;
    ToldPose& told = told_.at(slot);
    read_position(head & 3U, told);
    read_rotation((head >> 2U) & 3U, told.q);
    change.moved = true;
    for (std::size_t i = 0; i < 3; ++i)
      change.body.p_WB[static_cast<Eigen::Index>(i)] = static_cast<double>(told.p[i]) * kGrid_m;
    change.body.q_WB = unpack_rotation(told.q);
  }

  void read_position(unsigned way, ToldPose& told) {
    for (std::int64_t& p : told.p) {
      if (way == 1) p += in_.get<std::int8_t>();
      if (way == 2) p += in_.get<std::int16_t>();
      if (way != 3) continue;
      const std::int64_t low = in_.get<std::uint32_t>();
      p = low + (std::int64_t{in_.get<std::int16_t>()} << 32);
    }
  }

  void read_rotation(unsigned way, std::uint32_t& packed) {
    if (way == 3) in_.refuse();
    if (way == 2) packed = in_.get<std::uint32_t>();
    if (way != 1) return;
    std::uint32_t turned = packed & 3U << 30U;
    for (const unsigned shift : {20U, 10U, 0U}) {
      const std::uint32_t level = ((packed >> shift) & 1023U) + static_cast<std::uint32_t>(in_.get<std::int8_t>());
      turned |= (level & 1023U) << shift;
    }
    packed = turned;
  }

  Reader in_;
  const SlotTable& before_;
  std::vector<ToldPose>& told_;
  WorldFrame frame_;
  Slot next_ = 0;  ///< next slot of the poses
  std::array<std::uint32_t, 4> counts_{};
  std::map<Slot, BodyChange> changes_;
  BodyChange nowhere_;
};

}  // namespace

std::optional<WorldFrame> FrameDecoder::decode(std::span<const std::uint8_t> bytes, const SlotTable& before) {
  if (told_.size() < before.slot_count()) told_.resize(before.slot_count());
  return FrameReader(bytes, before, told_).read();
}

}  // namespace aurasim::overseer
