#include "rtps/discovery_fragments.h"

#include <algorithm>
#include <utility>

namespace aurasim::rtps {

DiscoveryFragments::Sample::Sample(const Claim& claim)
    : first(claim),
      missing((claim.sample_B + claim.fragment_B - 1) / claim.fragment_B),
      here(missing),
      datagram(claim.sample_B) {}

void DiscoveryFragments::Sample::take(const Claim& claim, std::span<const std::uint8_t> from, Time now) {
  touched = now;
  if (claim.reader != first.reader) first.reader = 0;
  const auto payload = datagram.payload();
  for (std::uint32_t i = 0; i < claim.fragments; ++i) {
    const std::size_t index = claim.first_fragment - 1 + i;
    if (here[index]) continue;
    here[index] = true;
    --missing;
    const std::size_t offset = index * claim.fragment_B;
    const std::size_t size = std::min<std::size_t>(claim.fragment_B, payload.size() - offset);
    std::ranges::copy(from.subspan(claim.payload + std::size_t{i} * claim.fragment_B, size),
                      payload.begin() + static_cast<std::ptrdiff_t>(offset));
  }
}

DiscoveryFragments::Key DiscoveryFragments::key_of(const Claim& claim, bool is_known) {
  return {is_known ? claim.guid.prefix : GuidPrefix{}, claim.guid.prefix, claim.guid.entity, claim.first};
}

std::optional<Refusal> DiscoveryFragments::add(const Claim& claim, bool is_known,
                                               std::span<const std::uint8_t> datagram, Time now) {
  const Key key = key_of(claim, is_known);
  auto sample = samples_.find(key);
  if (sample == samples_.end()) {
    if (!make_room(key, claim, now)) return Refusal::kUnfinished;
    sample = samples_.emplace(key, Sample(claim)).first;
    bytes_ += claim.sample_B;
    ++counts_[key.of];
  }
  const Claim& first = sample->second.first;
  if (first.sample_B != claim.sample_B || first.fragment_B != claim.fragment_B) return Refusal::kFragment;
  sample->second.take(claim, datagram, now);
  return std::nullopt;
}

/// Makes room for a new sample. Returns false when there is none.
bool DiscoveryFragments::make_room(const Key& key, const Claim& claim, Time now) {
  const std::size_t most = key.of == GuidPrefix{} ? limits_.of_strangers : limits_.of_a_participant;
  if (const auto count = counts_.find(key.of); count != counts_.end() && count->second >= most) {
    erase(samples_.lower_bound({key.of, {}, 0, 0}));
  }
  if (bytes_ + claim.sample_B <= limits_.all_B) return true;
  for (auto it = samples_.begin(); it != samples_.end();) {
    it = now - it->second.touched > limits_.until_given_up ? erase(it) : std::next(it);
  }
  return bytes_ + claim.sample_B <= limits_.all_B;
}

std::optional<MadeDatagram> DiscoveryFragments::take_whole(const Claim& claim, bool is_known,
                                                           std::span<const std::uint8_t> header) {
  const auto sample = samples_.find(key_of(claim, is_known));
  if (sample == samples_.end() || sample->second.missing > 0) return std::nullopt;
  make_data(sample->second.datagram, sample->second.first, header);
  std::optional<MadeDatagram> made = std::move(sample->second.datagram);
  erase(sample);
  return made;
}

DiscoveryFragments::Samples::iterator DiscoveryFragments::erase(Samples::iterator sample) {
  bytes_ -= sample->second.first.sample_B;
  const auto count = counts_.find(sample->first.of);
  if (--count->second == 0) counts_.erase(count);
  return samples_.erase(sample);
}

}  // namespace aurasim::rtps
