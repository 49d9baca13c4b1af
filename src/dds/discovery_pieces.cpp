#include "dds/discovery_pieces.h"

#include <algorithm>

#include "dds/made_datagrams.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kLargest_B = 64U << 10;
constexpr std::size_t kMost = 2048;
constexpr TokenBucket::Time kPatience = 10s;

}  // namespace

void DiscoveryPieces::make_room(Time now) {
  std::erase_if(samples_, [&](const auto& entry) { return now - entry.second.since > kPatience; });
  if (samples_.size() < kMost) return;
  const auto oldest = std::min_element(samples_.begin(), samples_.end(),
                                       [](const auto& a, const auto& b) { return a.second.since < b.second.since; });
  samples_.erase(oldest);
}

std::optional<std::vector<std::uint8_t>> DiscoveryPieces::add(const Claim& claim,
                                                              std::span<const std::uint8_t> datagram, Time now) {
  if (claim.sample_B > kLargest_B) return std::nullopt;
  const Key key{claim.guid.prefix, claim.guid.entity, claim.first};
  auto it = samples_.find(key);
  if (it == samples_.end()) {
    if (samples_.size() >= kMost) make_room(now);
    Sample sample{claim.fragment_B, (claim.sample_B + claim.fragment_B - 1) / claim.fragment_B, {}, {}, now};
    sample.here.resize(sample.missing);
    sample.bytes.resize(claim.sample_B);
    it = samples_.emplace(key, std::move(sample)).first;
  }
  Sample& sample = it->second;
  if (sample.fragment_B != claim.fragment_B || sample.bytes.size() != claim.sample_B) return std::nullopt;
  for (std::uint32_t i = 0; i < claim.fragments; ++i) {
    const std::size_t index = claim.first_fragment - 1 + i;
    if (sample.here[index]) continue;
    sample.here[index] = true;
    --sample.missing;
    const std::size_t offset = index * sample.fragment_B;
    const std::size_t size = std::min<std::size_t>(sample.fragment_B, sample.bytes.size() - offset);
    std::copy_n(datagram.begin() + static_cast<std::ptrdiff_t>(claim.payload + std::size_t{i} * sample.fragment_B),
                size, sample.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  if (sample.missing > 0) return std::nullopt;
  auto whole = datagram_of_data(claim, datagram, sample.bytes);
  samples_.erase(it);
  return whole;
}

}  // namespace aurasim::dds
