#include "dds/peer_book.h"

#include <algorithm>
#include <utility>

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

/// Fast DDS forgets a silent participant after its lease; this book never before it.
constexpr TokenBucket::Time kLonger = 10s;
/// Samples of one writer that are told apart; an older one counts as new when more of it comes.
constexpr std::size_t kMostSamples = 1024;
constexpr std::size_t kMostReaders = 64;
/// Discovery and handshakes: a description of an endpoint has some kB.
constexpr std::uint32_t kLargestDiscovery_B = 64U << 10;

}  // namespace

void PeerBook::hear(const GuidPrefix& participant, Time now) {
  if (const auto it = peers_.find(participant); it != peers_.end()) it->second.heard = now;
}

std::optional<Refusal> PeerBook::judge(const Claim& claim, std::span<const std::uint8_t> datagram, Source source,
                                       SourceLimits& rates, Time now) {
  if (claim.kind == Claim::Kind::kParticipant) return take_participant(claim, source, now);
  const auto it = peers_.find(claim.guid.prefix);
  if (it == peers_.end()) return std::nullopt;  // Fast DDS does not know it either
  Peer& peer = it->second;
  if (claim.kind == Claim::Kind::kEndpoint) return take_endpoint(peer, claim);
  if (claim.kind == Claim::Kind::kEndpointGone) {
    const auto gone = peer.endpoints.find(claim.guid.entity);
    if (gone != peer.endpoints.end() && !is_built_in(claim.guid.entity)) {
      for (const auto& [sequence, sample] : gone->second.samples) forget(peer, sample);
      peer.endpoints.erase(gone);
    }
    return std::nullopt;
  }
  Endpoint* writer = endpoint_of(peer, claim.guid.entity);
  if (writer == nullptr) return Refusal::kTooMany;
  if (claim.kind == Claim::Kind::kData) return take_data(*writer, claim);
  if (claim.kind == Claim::Kind::kHeartbeat) return take_heartbeat(peer, *writer, claim, source, rates, now);
  if (claim.kind == Claim::Kind::kGap) return take_gap(peer, *writer, claim, source, rates, now);
  return take_fragments(peer, *writer, claim, datagram);
}

std::optional<Refusal> PeerBook::take_participant(const Claim& claim, Source source, Time now) {
  const auto lease = std::chrono::duration_cast<Time>(std::chrono::duration<double>(claim.lease_s));
  if (const auto it = peers_.find(claim.guid.prefix); it != peers_.end()) {
    it->second.heard = now;
    it->second.lease = std::max(it->second.lease, lease);
    return std::nullopt;
  }
  const auto full = [&] {
    return peers_.size() >= limits_.participants ||
           peers_of_address_[source.address] >= limits_.participants_of_an_address;
  };
  if (full()) forget_the_silent(now);
  if (full()) return Refusal::kTooMany;
  Peer& peer = peers_[claim.guid.prefix];
  peer.address = source.address;
  peer.heard = now;
  peer.lease = lease;
  ++peers_of_address_[source.address];
  return std::nullopt;
}

std::optional<Refusal> PeerBook::take_endpoint(Peer& peer, const Claim& claim) {
  Endpoint* endpoint = endpoint_of(peer, claim.guid.entity);
  if (endpoint == nullptr) return Refusal::kTooMany;
  endpoint->announced = true;
  return std::nullopt;
}

/// Null: there are too many. What was never announced (built-in, or announced in secret) makes room for others.
PeerBook::Endpoint* PeerBook::endpoint_of(Peer& peer, std::uint32_t entity) {
  if (const auto it = peer.endpoints.find(entity); it != peer.endpoints.end()) return &it->second;
  if (peer.endpoints.size() >= limits_.endpoints_of_a_participant) {
    std::erase_if(peer.endpoints, [&](const auto& entry) {
      const auto& samples = entry.second.samples;
      const auto is_open = [](const auto& sample) { return sample.second.missing > 0 || sample.second.refused; };
      if (entry.second.announced) return false;
      if (is_built_in(entry.first) && std::ranges::any_of(samples, is_open)) return false;
      for (const auto& [sequence, sample] : samples) forget(peer, sample);
      return true;
    });
  }
  if (peer.endpoints.size() >= limits_.endpoints_of_a_participant) return nullptr;
  return &peer.endpoints[entity];
}

/// A sample beyond what a heartbeat has come to makes the way there expensive (take_heartbeat). It is sent again.
bool PeerBook::is_far_ahead(Endpoint& writer, const Claim& claim) const {
  std::uint64_t reached = writer.highest;
  for (const auto& [reader, first] : writer.first) reached = std::max(reached, first);
  if (claim.first > reached + limits_.farthest_ahead) return true;
  writer.highest = std::max(writer.highest, claim.first);
  return false;
}

/// Two of one number, one of them unfinished: Fast DDS takes either for whole, and may end itself.
std::optional<Refusal> PeerBook::take_data(Endpoint& writer, const Claim& claim) const {
  const auto unfinished = writer.samples.find(claim.first);
  if (unfinished != writer.samples.end() && unfinished->second.missing > 0) return Refusal::kFragment;
  return is_far_ahead(writer, claim) ? std::optional(Refusal::kJump) : std::nullopt;
}

/// Fast DDS counts from the number that it has last told of to the heartbeat's first, with its reader locked; if there
/// is a sample on the way it looks all of them up in its history. Who joins late hears a heartbeat before samples.
std::optional<Refusal> PeerBook::take_heartbeat(Peer& peer, Endpoint& writer, const Claim& claim, Source source,
                                                SourceLimits& rates, Time now) {
  forget_samples(peer, writer, claim.reader, 0, claim.first);
  if (writer.first.size() >= kMostReaders && !writer.first.contains(claim.reader)) writer.first.clear();
  std::uint64_t& first = writer.first[claim.reader];
  const std::uint64_t known = std::max(first, writer.first[0]);  // what is for all is for this one, too
  if (claim.first <= known) return std::nullopt;
  const std::uint64_t jump = claim.first - known;
  if (jump > limits_.longest_jump) return Refusal::kJump;
  const double price = static_cast<double>(jump) * (writer.highest > 0 ? limits_.price_with_samples : 1);
  if (jump > limits_.free_jump && !rates.take_jump(source.address, price, now)) return Refusal::kJump;
  first = claim.first;
  return std::nullopt;
}

/// Fast DDS goes through all numbers of a gap, and keeps those that do not follow on what it has.
std::optional<Refusal> PeerBook::take_gap(Peer& peer, Endpoint& writer, const Claim& claim, Source source,
                                          SourceLimits& rates, Time now) {
  const std::uint64_t numbers = claim.last + 1 - claim.first;
  if (numbers > limits_.longest_gap) return Refusal::kJump;
  if (numbers > limits_.free_gap && !rates.take_gap(source.address, static_cast<double>(numbers), now)) {
    return Refusal::kJump;
  }
  forget_samples(peer, writer, claim.reader, claim.first, claim.last + 1);
  return std::nullopt;
}

/// What is forgotten of a writer's discovery, Fast DDS must not have parts of.
bool PeerBook::make_room_for_sample(Peer& peer, Endpoint& writer, bool built_in) {
  if (writer.samples.size() < kMostSamples) return true;
  const auto oldest = std::ranges::find_if(writer.samples, [&](const auto& entry) {
    return !built_in || (entry.second.missing == 0 && !entry.second.refused);
  });
  if (oldest == writer.samples.end()) return false;
  forget(peer, oldest->second);
  writer.samples.erase(oldest);
  return true;
}

/// Fast DDS takes memory for the whole sample at its first fragment, and sizes from the first one that comes.
std::optional<Refusal> PeerBook::take_fragments(Peer& peer, Endpoint& writer, const Claim& claim,
                                                std::span<const std::uint8_t> datagram) {
  const bool built_in = is_built_in(claim.guid.entity);
  if (built_in && claim.sample_B > kLargestDiscovery_B) return Refusal::kFragment;
  if (is_far_ahead(writer, claim)) return Refusal::kJump;
  auto it = writer.samples.find(claim.first);
  if (it == writer.samples.end()) {
    if (unfinished_B_ + claim.sample_B > limits_.unfinished_B ||
        peer.unfinished_B + claim.sample_B > limits_.unfinished_of_a_participant_B) {
      return Refusal::kUnfinished;
    }
    if (!make_room_for_sample(peer, writer, built_in)) return Refusal::kUnfinished;
    Sample sample;
    sample.sample_B = claim.sample_B;
    sample.fragment_B = claim.fragment_B;
    sample.missing = (claim.sample_B + claim.fragment_B - 1) / claim.fragment_B;
    sample.here.resize(sample.missing);
    sample.reader = claim.reader;
    if (built_in) sample.bytes.resize(claim.sample_B);
    it = writer.samples.emplace(claim.first, std::move(sample)).first;
    unfinished_B_ += claim.sample_B;
    peer.unfinished_B += claim.sample_B;
  }
  Sample& sample = it->second;
  if (sample.refused) return sample.refused;
  if (sample.sample_B != claim.sample_B || sample.fragment_B != claim.fragment_B) return Refusal::kFragment;
  if (sample.missing == 0) return std::nullopt;
  for (std::uint32_t i = 0; i < claim.fragments; ++i) {
    const std::size_t index = claim.first_fragment - 1 + i;
    if (sample.here[index]) continue;  // Fast DDS keeps the first, too
    sample.here[index] = true;
    --sample.missing;
    if (!built_in) continue;
    const std::size_t offset = index * sample.fragment_B;
    const std::size_t size = std::min<std::size_t>(sample.fragment_B, sample.bytes.size() - offset);
    std::ranges::copy(datagram.subspan(claim.payload + std::size_t{i} * sample.fragment_B, size),
                      sample.bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  if (sample.missing == 0) {
    unfinished_B_ -= sample.sample_B;
    peer.unfinished_B -= sample.sample_B;
    sample.here = {};
  }
  return std::nullopt;
}

PeerBook::Sample* PeerBook::find(const Claim& claim) {
  const auto peer = peers_.find(claim.guid.prefix);
  if (peer == peers_.end()) return nullptr;
  const auto writer = peer->second.endpoints.find(claim.guid.entity);
  if (writer == peer->second.endpoints.end()) return nullptr;
  const auto sample = writer->second.samples.find(claim.first);
  return sample == writer->second.samples.end() ? nullptr : &sample->second;
}

std::optional<std::vector<std::uint8_t>> PeerBook::take_whole(const Claim& claim) {
  Sample* const sample = find(claim);
  if (sample == nullptr || sample->missing > 0 || sample->bytes.empty()) return std::nullopt;
  return std::exchange(sample->bytes, {});
}

void PeerBook::refuse(const Claim& claim, Refusal why) {
  if (Sample* const sample = find(claim)) sample->refused = why;
}

void PeerBook::forget(Peer& peer, const Sample& sample) {
  if (sample.missing == 0) return;
  unfinished_B_ -= sample.sample_B;
  peer.unfinished_B -= sample.sample_B;
}

/// Numbers in [from, to), as far as they are for this reader alone or this is for all: what one reader is told does not
/// make another forget.
void PeerBook::forget_samples(Peer& peer, Endpoint& writer, std::uint32_t reader, std::uint64_t from,
                              std::uint64_t to) {
  for (auto it = writer.samples.lower_bound(from); it != writer.samples.end() && it->first < to;) {
    const bool is_told = reader == 0 || it->second.reader == reader;
    if (is_told) forget(peer, it->second);
    it = is_told ? writer.samples.erase(it) : std::next(it);
  }
}

void PeerBook::forget_the_silent(Time now) {
  for (auto it = peers_.begin(); it != peers_.end();) {
    const auto next = std::next(it);
    if (now - it->second.heard > 2 * it->second.lease + kLonger) erase(it);
    it = next;
  }
}

void PeerBook::erase(Peers::iterator peer) {
  unfinished_B_ -= peer->second.unfinished_B;
  const auto count = peers_of_address_.find(peer->second.address);
  if (--count->second == 0) peers_of_address_.erase(count);
  peers_.erase(peer);
}

}  // namespace aurasim::dds
