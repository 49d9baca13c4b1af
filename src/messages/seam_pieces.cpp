#include "messages/seam_pieces.h"

#include <algorithm>

namespace aurasim::messages {

const PostedPieces::Piece& PostedPieces::add(std::span<const std::byte> octets, bool goes_on) {
  if (pieces_.size() == count_) pieces_.emplace_back();
  Piece& piece = pieces_[count_++];
  piece.number = count_;
  piece.goes_on = goes_on;
  piece.octets.assign(octets.begin(), octets.end());
  return piece;
}

void ArrivedPieces::begin(core::Generation generation, core::Step step) {
  step_ = {generation, step};
  for (std::size_t i = 0; i < count_; ++i) slots_[i].is_here = false;
  count_ = next_ = without_gaps_ = size_B_ = 0;
  whole_ = taken_ = 0;
  const std::vector<Later> later = std::exchange(later_, {});
  for (const Later& one : later) add({one.header, one.piece.goes_on, one.piece.octets, {}});
}

bool ArrivedPieces::add(const SeamPiece& piece) {
  const Key key = key_of(piece.header);
  if (key < step_ || piece.header.number == 0 || piece.header.number > kMostPieces) return false;
  if (piece.octets.size() > kMost_B - size_B_) return false;
  if (key == step_) return put(piece.header.number, piece.goes_on, piece.octets);
  if (later_.size() == kMostPieces) return false;
  size_B_ += piece.octets.size();
  later_.push_back({piece.header, {true, piece.goes_on, {piece.octets.begin(), piece.octets.end()}}});
  return true;
}

bool ArrivedPieces::put(std::uint32_t number, bool goes_on, std::span<const std::byte> octets) {
  const std::size_t at = number - 1;
  if (slots_.size() <= at) slots_.resize(at + 1);
  count_ = std::max(count_, at + 1);
  Slot& slot = slots_[at];
  if (slot.is_here) return false;
  size_B_ += octets.size();
  slot.is_here = true;
  slot.goes_on = goes_on;
  slot.octets.assign(octets.begin(), octets.end());
  while (without_gaps_ < count_ && slots_[without_gaps_].is_here) {
    if (!slots_[without_gaps_++].goes_on) ++whole_;
  }
  return true;
}

bool ArrivedPieces::take(std::vector<std::byte>& octets) {
  if (whole_ == 0) return false;
  --whole_, ++taken_;
  octets.clear();
  for (bool goes_on = true; goes_on;) {
    Slot& slot = slots_[next_++];
    goes_on = slot.goes_on;
    size_B_ -= slot.octets.size();
    if (octets.empty()) {
      std::swap(octets, slot.octets);
    } else {
      octets.insert(octets.end(), slot.octets.begin(), slot.octets.end());
    }
  }
  return true;
}

std::vector<std::uint32_t> ArrivedPieces::lacking() const {
  std::vector<std::uint32_t> lacking;
  for (std::size_t i = without_gaps_; i <= count_ && lacking.size() < kMostLacking; ++i) {
    if (i == count_ || !slots_[i].is_here) lacking.push_back(static_cast<std::uint32_t>(i + 1));
  }
  return lacking;
}

std::optional<SeamHeader> ArrivedPieces::ahead() const {
  if (later_.empty()) return std::nullopt;
  return later_.front().header;
}

}  // namespace aurasim::messages
