// Parcels between two coupled regions travel in pieces that fit into a datagram, over a network that may lose, repeat
// and swap them. The receiver knows which parcels a step needs, so it asks for what has not come, and the sender keeps
// the pieces of its step for that. Knows nothing of DDS.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "messages/seam_piece.h"

namespace aurasim::messages {

/// Calls visit(octets, goes_on) for each piece of at most `most_B` bytes that a parcel is cut into. An empty parcel has
/// one.
template <class Visit>
void cut(std::span<const std::byte> parcel, std::size_t most_B, Visit&& visit) {
  do {
    const std::span<const std::byte> octets = parcel.first(std::min(most_B, parcel.size()));
    parcel = parcel.subspan(octets.size());
    visit(octets, !parcel.empty());
  } while (!parcel.empty());
}

/// The pieces that one region has posted to another in a step.
class PostedPieces {
 public:
  struct Piece {
    std::uint32_t number = 0;
    bool goes_on = false;
    std::vector<std::byte> octets;
  };

  void begin() { count_ = 0; }
  /// Keeps the next piece. Valid until the next call.
  const Piece& add(std::span<const std::byte> octets, bool goes_on);

  /// Calls send(piece) for each piece of a question (SeamPiece::lacking), for some `most_B` bytes of them at most.
  template <class Send>
  void answer(std::span<const std::uint32_t> lacking, std::size_t most_B, Send&& send) const {
    if (lacking.empty()) return;
    std::size_t sent_B = 0;
    const auto send_one = [&](std::uint32_t number) {
      if (number == 0 || number > count_ || sent_B > most_B) return false;
      sent_B += pieces_[number - 1].octets.size();
      send(pieces_[number - 1]);
      return true;
    };
    for (const std::uint32_t number : lacking) {
      if (!send_one(number)) return;
    }
    for (std::uint32_t number = lacking.back() + 1; send_one(number);) ++number;
  }

 private:
  std::vector<Piece> pieces_;  ///< the first `count_` are of this step; memory of the others is used again
  std::uint32_t count_ = 0;
};

/// The pieces that one region has received from another.
class ArrivedPieces {
 public:
  /// Parcels of this step are wanted from now on.
  void begin(core::Generation generation, core::Step step);

  /// Adds a piece. False: it is of an earlier step, has come before, or there is no room; then it is dropped.
  bool add(const SeamPiece& piece);
  /// Takes the next parcel of the step, if it is whole. The memory of `octets` is used again.
  bool take(std::vector<std::byte>& octets);

  /// Numbers of the pieces that have not come, as in SeamPiece::lacking.
  std::vector<std::uint32_t> lacking() const;
  /// A piece of a later step, if one has come.
  std::optional<SeamHeader> ahead() const;
  /// Number of the next parcel in the step, from 1.
  std::uint32_t next_parcel() const { return taken_ + 1; }

  /// Most bytes of pieces that are kept.
  static constexpr std::size_t kMost_B = std::size_t{64} << 20;
  static constexpr std::uint32_t kMostPieces = 1U << 17;  ///< of a step

 private:
  using Key = std::pair<core::Generation, core::Step>;
  struct Slot {
    bool is_here = false;
    bool goes_on = false;
    std::vector<std::byte> octets;
  };
  struct Later {
    SeamHeader header;
    Slot piece;
  };

  static Key key_of(const SeamHeader& header) { return {header.generation, header.step}; }
  bool put(std::uint32_t number, bool goes_on, std::span<const std::byte> octets);

  Key step_{0, 0};
  std::vector<Slot> slots_;  ///< by number less 1; the first `count_` are of this step
  std::size_t count_ = 0;
  std::size_t next_ = 0;          ///< slot of the next parcel's first piece
  std::size_t without_gaps_ = 0;  ///< all slots before this one are here
  std::uint32_t whole_ = 0;       ///< parcels from next_ on that are whole
  std::uint32_t taken_ = 0;       ///< parcels
  std::size_t size_B_ = 0;        ///< of pieces that are kept
  std::vector<Later> later_;      ///< pieces of later steps
};

}  // namespace aurasim::messages
