// The binary messages of docs/viewer.md, for any number of clients at any speed. What a client has not been sent yet is
// remembered as one byte per body, so a slow one gets fewer frames and never more memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "overseer/world_frame.h"

namespace aurasim::overseer {

using Bytes = std::vector<std::uint8_t>;

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

  std::vector<std::uint8_t> states_;  ///< by slot: bits in the .cpp
  std::vector<Slot> listed_;          ///< slots with news
  bool key_ = true;
  bool has_news_ = false;
  std::uint64_t merged_ = 0;
};

/// A frame as a difference to `before`; nothing, if the bytes are no frame or do not fit to it. For recordings.
std::optional<WorldFrame> decode_frame(std::span<const std::uint8_t> bytes, const SlotTable& before);

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
