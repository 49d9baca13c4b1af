// Encodes the binary messages of docs/viewer.md, for any number of clients at any speed. For each client a few bytes
// per body remember what it was sent. So a slow client gets fewer frames and never costs more memory, and all clients
// get differences.
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

/// Unit of positions in frames, metres. A power of two, so that no sum of multiples is rounded.
inline constexpr double kGrid_m = 1.0 / 2048;

/// A pose as it is sent.
struct ToldPose {
  std::array<std::int64_t, 3> p{};  ///< position in units of kGrid_m
  std::uint32_t q = 0;              ///< rotation, packed
};

/// The world as of the last frame.
class SlotTable {
 public:
  void apply(const WorldFrame& frame);

  core::Generation generation() const { return generation_; }
  core::Step stamp() const { return stamp_; }
  std::size_t slot_count() const { return bodies_.size(); }
  std::size_t body_count() const { return count_; }
  /// Body in a slot; null if the slot is empty.
  const ViewBody* body(Slot slot) const { return slot < alive_.size() && alive_[slot] ? &bodies_[slot] : nullptr; }

 private:
  std::vector<ViewBody> bodies_;
  std::vector<std::uint8_t> alive_;
  std::size_t count_ = 0;
  core::Generation generation_ = 0;
  core::Step stamp_ = 0;
};

/// The state that one client has been sent. A new client has nothing, so its first frame is a key frame.
class ClientFrames {
 public:
  /// Takes note of a frame. Call it after the table has applied the frame.
  void note(const WorldFrame& frame);
  /// True when there has been a frame since the last one that was encoded.
  bool has_news() const { return has_news_; }
  /// Number of frames that were merged into a later one, because the client was too slow for them.
  std::uint64_t merged() const { return merged_; }
  /// Sets the client's viewpoint; nothing: it wants everything exactly. Changes that it cannot see are sent later.
  void look(const std::optional<Eye>& eye) { eye_ = eye; }
  /// Encodes the next frame for this client, which then counts as sent.
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

/// Decodes frames of recordings.
class FrameDecoder {
 public:
  /// Decodes a frame as a difference to `before`. Nothing: the bytes are no frame, or do not continue `before` and the
  /// frames decoded earlier. After that only a key frame is sure to be right.
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
