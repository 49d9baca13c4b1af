#include "core/own_index.h"

namespace aurasim::core {
namespace {

/// Bodies that have come to rest are added to the index of those when there are so many of them.
constexpr std::size_t kFew = 256;

}  // namespace

void OwnIndex::build(std::span<const Path> paths) {
  is_moving_.assign(paths.size(), 0);
  movers_.clear();
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    if (!paths[i].moves) continue;
    is_moving_[i] = 1;
    movers_.push_back(i);
  }
  moving_.build(paths, movers_);
  index_resting(paths);
}

void OwnIndex::renew(std::span<const Path> paths, std::span<const std::uint32_t> changed) {
  for (const std::uint32_t i : changed) {
    if (is_moving_[i]) continue;
    is_moving_[i] = 1;
    movers_.push_back(i);
  }
  const std::size_t settled = movers_.size() - changed.size();
  if (settled > kFew + changed.size() / 2 + paths.size() / 64) {
    for (const std::uint32_t i : movers_) is_moving_[i] = 0;
    movers_.assign(changed.begin(), changed.end());
    for (const std::uint32_t i : movers_) is_moving_[i] = 1;
    index_resting(paths);
  }
  moving_.build(paths, movers_);
}

void OwnIndex::index_resting(std::span<const Path> paths) {
  rest_.clear();
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    if (!is_moving_[i]) rest_.push_back(i);
  }
  resting_.build(paths, rest_);
}

}  // namespace aurasim::core
