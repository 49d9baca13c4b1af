// The binary messages of docs/viewer.md, for any number of clients at any speed. What each client has been told is
// remembered, a few bytes per body, so a slow one gets fewer frames and never more memory, and all get differences.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "overseer/eye.h"
#include "overseer/world_frame.h"

namespace aurasim::overseer {

using Bytes = std::vector<std::uint8_t>;

/// Positions are told as whole numbers of this, metres: a power of two, so that no sum of them is rounded.
inline constexpr double kGrid_m = 1.0 / 2048;

/// A pose as it is told.
struct ToldPose {
  std::array<std::int64_t, 3> p{};  ///< in kGrid_m
  std::uint32_t q = 0;              ///< packed
};

/// The world as of the last frame.
class SlotTable {
 public:
  void apply(const WorldFrame& frame);

  core::Generation generation() const { return generation_; }
  core::Step stamp() const { return stamp_; }
  std::size_t slot_count() const { return bodies_.size(); }
  std::size_t body_count() const { return count_; }
  /// Null if the slot is empty.
  const ViewBody* body(Slot slot) const { return slot < alive_.size() && alive_[slot] ? &bodies_[slot] : nullptr; }

 private:
  std::vector<ViewBody> bodies_;
  std::vector<std::uint8_t> alive_;
  std::size_t count_ = 0;
  core::Generation generation_ = 0;
  core::Step stamp_ = 0;
};

/// What one client knows. Begins with nothing: its first frame is a key frame.
class ClientFrames {
 public:
  /// After the table has applied it.
  void note(const WorldFrame& frame);
  /// There has been a frame since the last one that was encoded.
  bool has_news() const { return has_news_; }
  /// Frames put into the next one, which was not sent in time for them.
  std::uint64_t merged() const { return merged_; }
  /// From where the client looks; nothing: it wants all as it is. What it cannot see it is told later.
  void look(const std::optional<Eye>& eye) { eye_ = eye; }
  /// The next frame for this client; it counts as sent.
  Bytes encode(const SlotTable& table);

 private:
  struct Lists {
    std::vector<Slot> deleted, created, hosts, moved;
  };
  void forget();
  std::uint8_t& state(Slot slot);
  void list_everything(const SlotTable& table);
  Lists sort_out(const SlotTable& table);
  enum class Move : std::uint8_t { kNone, kUnseen, kSeen };
  Move move_of(const ViewBody& body) const;

  std::vector<std::uint8_t> states_;  ///< by slot: bits in the .cpp
  std::vector<ToldPose> told_;        ///< by slot
  std::vector<Slot> listed_;          ///< slots with news
  std::optional<Eye> eye_;
  bool key_ = true;
  bool has_news_ = false;
  std::uint64_t merged_ = 0;
};

/// Reads frames, for recordings.
class FrameDecoder {
 public:
  /// A frame as a difference to `before`; nothing, if the bytes are no frame or do not fit to it and to those that were
  /// read before: then only a key frame is sure to be right.
  std::optional<WorldFrame> decode(std::span<const std::uint8_t> bytes, const SlotTable& before);

 private:
  std::vector<ToldPose> told_;  ///< by slot
};

/// A rotation in 32 bits: the smallest three of the components w x y z, 10 bits each.
std::uint32_t pack_rotation(const Eigen::Quaternionf& q);
Eigen::Quaternionf unpack_rotation(std::uint32_t packed);

struct AuraDisc {
  Slot slot = 0;
  float radius_m = 0;
};
struct SlotPair {
  Slot a = 0;
  Slot b = 0;
};
Bytes encode_overlays(std::span<const AuraDisc> auras, std::span<const SlotPair> links,
                      std::span<const SlotPair> contacts);

}  // namespace aurasim::overseer
