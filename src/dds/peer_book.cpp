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
constexpr std::size_t kMostStrangers = 64;
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
  if (it == peers_.end()) {  // Fast DDS does not know it either
    const bool announces = claim.kind == Claim::Kind::kFragments && claim.guid.entity == kParticipantWriter;
    return announces ? take_stranger(claim, datagram) : std::nullopt;
  }
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
  strangers_.erase(claim.guid.prefix);
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
      if (entry.second.announced) return false;
      for (const auto& [sequence, sample] : entry.second.samples) forget(peer, sample);
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

PeerBook::Sample::Sample(const Claim& first)
    : sample_B(first.sample_B),
      fragment_B(first.fragment_B),
      missing((first.sample_B + first.fragment_B - 1) / first.fragment_B),
      here(missing),
      reader(first.reader),
      bytes(is_built_in(first.guid.entity) ? first.sample_B : 0) {}

bool PeerBook::Sample::is_like(const Claim& claim) const {
  return sample_B == claim.sample_B && fragment_B == claim.fragment_B;
}

void PeerBook::Sample::take(const Claim& claim, std::span<const std::uint8_t> datagram) {
  for (std::uint32_t i = 0; i < claim.fragments; ++i) {
    const std::size_t index = claim.first_fragment - 1 + i;
    if (here[index]) continue;  // Fast DDS keeps the first, too
    here[index] = true;
    --missing;
    if (bytes.empty()) continue;
    const std::size_t offset = index * fragment_B;
    const std::size_t size = std::min<std::size_t>(fragment_B, bytes.size() - offset);
    std::ranges::copy(datagram.subspan(claim.payload + std::size_t{i} * fragment_B, size),
                      bytes.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  if (missing == 0) here = {};
}

/// Fast DDS takes memory for the whole sample at its first fragment, and sizes from the first one that comes.
std::optional<Refusal> PeerBook::take_fragments(Peer& peer, Endpoint& writer, const Claim& claim,
                                                std::span<const std::uint8_t> datagram) {
  if (is_built_in(claim.guid.entity) && claim.sample_B > kLargestDiscovery_B) return Refusal::kFragment;
  if (is_far_ahead(writer, claim)) return Refusal::kJump;
  auto it = writer.samples.find(claim.first);
  if (it == writer.samples.end()) {
    if (unfinished_B_ + claim.sample_B > limits_.unfinished_B ||
        peer.unfinished_B + claim.sample_B > limits_.unfinished_of_a_participant_B) {
      return Refusal::kUnfinished;
    }
    if (writer.samples.size() >= kMostSamples) {
      forget(peer, writer.samples.begin()->second);
      writer.samples.erase(writer.samples.begin());
    }
    it = writer.samples.emplace(claim.first, Sample(claim)).first;
    unfinished_B_ += claim.sample_B;
    peer.unfinished_B += claim.sample_B;
  }
  Sample& sample = it->second;
  if (!sample.is_like(claim)) return Refusal::kFragment;
  if (sample.missing == 0) return std::nullopt;
  sample.take(claim, datagram);
  if (sample.missing == 0) {
    unfinished_B_ -= sample.sample_B;
    peer.unfinished_B -= sample.sample_B;
  }
  return std::nullopt;
}

/// Its newest announcement: somebody has to be met first.
std::optional<Refusal> PeerBook::take_stranger(const Claim& claim, std::span<const std::uint8_t> datagram) {
  if (claim.sample_B > kLargestDiscovery_B) return Refusal::kFragment;
  auto it = strangers_.find(claim.guid.prefix);
  if (it == strangers_.end()) {
    if (strangers_.size() >= kMostStrangers) strangers_.erase(strangers_.begin());
    it = strangers_.emplace(claim.guid.prefix, Announcement{claim.first, Sample(claim)}).first;
  } else if (it->second.number != claim.first || !it->second.sample.is_like(claim)) {
    it->second = {claim.first, Sample(claim)};
  }
  it->second.sample.take(claim, datagram);
  return std::nullopt;
}

std::optional<std::vector<std::uint8_t>> PeerBook::take_whole(const Claim& claim) {
  if (!is_built_in(claim.guid.entity)) return std::nullopt;
  const auto take_from = [](auto& samples, auto at, Sample& sample) -> std::optional<std::vector<std::uint8_t>> {
    if (sample.missing > 0) return std::nullopt;
    auto bytes = std::move(sample.bytes);
    samples.erase(at);
    return bytes;
  };
  const auto peer = peers_.find(claim.guid.prefix);
  if (peer == peers_.end()) {
    const auto stranger = strangers_.find(claim.guid.prefix);
    return stranger == strangers_.end() ? std::nullopt : take_from(strangers_, stranger, stranger->second.sample);
  }
  const auto writer = peer->second.endpoints.find(claim.guid.entity);
  if (writer == peer->second.endpoints.end()) return std::nullopt;
  auto& samples = writer->second.samples;
  const auto sample = samples.find(claim.first);
  if (sample == samples.end()) return std::nullopt;
  return take_from(samples, sample, sample->second);
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
