#include "dds/peer_book.h"

#include <algorithm>
#include <utility>

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

/// How much longer than its lease a silent participant stays in the book. Fast DDS forgets it after its lease; the book
/// must not forget it earlier.
constexpr core::TokenBucket::Time kLonger = 10s;
/// Most unfinished samples of one writer.
constexpr std::size_t kMostSamples = 1024;
constexpr std::size_t kMostReaders = 64;
constexpr std::size_t kMostStrangers = 64;
/// Largest sample of discovery and handshakes: a description of an endpoint has some kB.
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
    return announces ? take_stranger(claim, datagram, now) : std::nullopt;
  }
  Peer& peer = it->second;
  if (claim.kind == Claim::Kind::kEndpoint) return take_endpoint(peer, claim);
  if (claim.kind == Claim::Kind::kEndpointGone) {
    const auto gone = peer.endpoints.find(claim.guid.entity);
    if (gone != peer.endpoints.end() && !is_built_in(claim.guid.entity)) erase(peer, gone);
    return std::nullopt;
  }
  Endpoint* writer = endpoint_of(peer, claim.guid.entity);
  if (writer == nullptr) return Refusal::kTooMany;
  if (claim.kind == Claim::Kind::kData) {
    return is_far_ahead(*writer, claim) ? std::optional(Refusal::kJump) : std::nullopt;
  }
  if (claim.kind == Claim::Kind::kHeartbeat) return take_heartbeat(peer, *writer, claim, source, rates, now);
  if (claim.kind == Claim::Kind::kGap) return take_gap(peer, *writer, claim, source, rates, now);
  return take_fragments(peer, *writer, claim, datagram, now);
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

/// Returns the record of an endpoint; null if there are too many. Endpoints that were never announced (built-in, or
/// announced in secret) make room for others.
PeerBook::Endpoint* PeerBook::endpoint_of(Peer& peer, std::uint32_t entity) {
  if (const auto it = peer.endpoints.find(entity); it != peer.endpoints.end()) return &it->second;
  if (peer.endpoints.size() >= limits_.endpoints_of_a_participant) {
    for (auto it = peer.endpoints.begin(); it != peer.endpoints.end();) {
      it = it->second.announced ? std::next(it) : erase(peer, it);
    }
  }
  if (peer.endpoints.size() >= limits_.endpoints_of_a_participant) return nullptr;
  return &peer.endpoints[entity];
}

/// True when a sample is too far beyond the last heartbeat: the following heartbeat would be expensive
/// (take_heartbeat). The sample is retransmitted later.
bool PeerBook::is_far_ahead(Endpoint& writer, const Claim& claim) const {
  std::uint64_t reached = writer.highest;
  for (const auto& [reader, first] : writer.first) reached = std::max(reached, first);
  if (claim.first > reached + limits_.farthest_ahead) return true;
  writer.highest = std::max(writer.highest, claim.first);
  return false;
}

/// Judges a heartbeat. Fast DDS counts from the number that it has last reported up to the heartbeat's first, with its
/// reader locked; if there are samples between them it looks them all up in its history. A late joiner receives a
/// heartbeat before samples.
std::optional<Refusal> PeerBook::take_heartbeat(Peer& peer, Endpoint& writer, const Claim& claim, Source source,
                                                SourceLimits& rates, Time now) {
  forget_samples(peer, writer, claim.reader, 0, claim.first);
  if (writer.first.size() >= kMostReaders && !writer.first.contains(claim.reader)) writer.first.clear();
  std::uint64_t& first = writer.first[claim.reader];
  // Heartbeats for all readers count for this reader, too.
  const std::uint64_t known = std::max(first, writer.first[0]);
  if (claim.first <= known) return std::nullopt;
  const std::uint64_t jump = claim.first - known;
  if (jump > limits_.longest_jump) return Refusal::kJump;
  const double price = static_cast<double>(jump) * (writer.highest > 0 ? limits_.price_with_samples : 1);
  if (jump > limits_.free_jump && !rates.take_jump(source.address, price, now)) return Refusal::kJump;
  first = claim.first;
  return std::nullopt;
}

/// Judges a gap. Fast DDS iterates over all its numbers, and stores those that do not directly follow on what it has.
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

PeerBook::Sample::Sample(const Claim& claim)
    : first(claim),
      missing((claim.sample_B + claim.fragment_B - 1) / claim.fragment_B),
      here(missing),
      datagram(claim.sample_B) {}

bool PeerBook::Sample::is_like(const Claim& claim) const {
  return first.sample_B == claim.sample_B && first.fragment_B == claim.fragment_B;
}

void PeerBook::Sample::take(const Claim& claim, std::span<const std::uint8_t> from, Time now) {
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

bool PeerBook::has_room_for(const Peer& peer, const Claim& claim) const {
  return unfinished_B_ + claim.sample_B <= limits_.unfinished_B &&
         peer.unfinished_B + claim.sample_B <= limits_.unfinished_of_a_participant_B;
}

/// Judges fragments. Memory for the whole sample is allocated at its first fragment, and the sizes are those that the
/// first one names.
std::optional<Refusal> PeerBook::take_fragments(Peer& peer, Endpoint& writer, const Claim& claim,
                                                std::span<const std::uint8_t> datagram, Time now) {
  if (is_built_in(claim.guid.entity) && claim.sample_B > kLargestDiscovery_B) return Refusal::kFragment;
  if (is_far_ahead(writer, claim)) return Refusal::kJump;
  auto it = writer.samples.find(claim.first);
  if (it == writer.samples.end()) {
    for (auto old = writer.samples.begin(); old != writer.samples.end() && !has_room_for(peer, claim);) {
      old = now - old->second.touched > limits_.until_given_up ? forget(peer, writer, old) : std::next(old);
    }
    if (!has_room_for(peer, claim)) return Refusal::kUnfinished;
    if (writer.samples.size() >= kMostSamples) forget(peer, writer, writer.samples.begin());
    it = writer.samples.emplace(claim.first, Sample(claim)).first;
    unfinished_B_ += claim.sample_B;
    peer.unfinished_B += claim.sample_B;
  }
  if (!it->second.is_like(claim)) return Refusal::kFragment;
  it->second.take(claim, datagram, now);
  return std::nullopt;
}

/// Keeps a fragment of an unknown participant's newest announcement: it has to be read before the participant is known.
std::optional<Refusal> PeerBook::take_stranger(const Claim& claim, std::span<const std::uint8_t> datagram, Time now) {
  if (claim.sample_B > kLargestDiscovery_B) return Refusal::kFragment;
  auto it = strangers_.find(claim.guid.prefix);
  if (it == strangers_.end()) {
    if (strangers_.size() >= kMostStrangers) strangers_.erase(strangers_.begin());
    it = strangers_.emplace(claim.guid.prefix, Sample(claim)).first;
  } else if (it->second.first.first != claim.first || !it->second.is_like(claim)) {
    it->second = Sample(claim);
  }
  it->second.take(claim, datagram, now);
  return std::nullopt;
}

std::optional<MadeDatagram> PeerBook::take_whole(const Claim& claim, std::span<const std::uint8_t> header) {
  const auto made_of = [&](Sample& sample) {
    make_data(sample.datagram, sample.first, header);
    return std::move(sample.datagram);
  };
  const auto peer = peers_.find(claim.guid.prefix);
  if (peer == peers_.end()) {
    const auto stranger = strangers_.find(claim.guid.prefix);
    if (stranger == strangers_.end() || stranger->second.missing > 0) return std::nullopt;
    std::optional<MadeDatagram> made = made_of(stranger->second);
    strangers_.erase(stranger);
    return made;
  }
  const auto writer = peer->second.endpoints.find(claim.guid.entity);
  if (writer == peer->second.endpoints.end()) return std::nullopt;
  const auto sample = writer->second.samples.find(claim.first);
  if (sample == writer->second.samples.end() || sample->second.missing > 0) return std::nullopt;
  std::optional<MadeDatagram> made = made_of(sample->second);
  forget(peer->second, writer->second, sample);
  return made;
}

std::optional<MissingFragments> PeerBook::missing_of(const WireGuid& writer, std::uint64_t number) const {
  const auto peer = peers_.find(writer.prefix);
  if (peer == peers_.end()) return std::nullopt;
  const auto endpoint = peer->second.endpoints.find(writer.entity);
  if (endpoint == peer->second.endpoints.end()) return std::nullopt;
  const auto it = endpoint->second.samples.find(number);
  if (it == endpoint->second.samples.end()) return std::nullopt;
  const std::vector<bool>& here = it->second.here;
  const auto begin = static_cast<std::uint32_t>(std::ranges::find(here, false) - here.begin());
  MissingFragments missing;
  missing.base = begin + 1;
  const auto end = std::min(static_cast<std::uint32_t>(here.size()), begin + kMostBits);
  for (std::uint32_t i = begin; i < end; ++i) {
    if (here[i]) continue;
    const std::uint32_t bit = i - begin;
    missing.count = bit + 1;
    missing.words.resize(bit / 32 + 1);
    missing.words.back() |= 1U << (31 - bit % 32);
  }
  return missing;
}

PeerBook::Samples::iterator PeerBook::forget(Peer& peer, Endpoint& writer, Samples::iterator sample) {
  const std::uint32_t sample_B = sample->second.first.sample_B;
  unfinished_B_ -= sample_B;
  peer.unfinished_B -= sample_B;
  return writer.samples.erase(sample);
}

/// Drops unfinished samples with numbers in [from, to). With a `reader`, only samples for that reader alone: a message
/// to one reader must not make another lose a sample.
void PeerBook::forget_samples(Peer& peer, Endpoint& writer, std::uint32_t reader, std::uint64_t from,
                              std::uint64_t to) {
  for (auto it = writer.samples.lower_bound(from); it != writer.samples.end() && it->first < to;) {
    const bool is_told = reader == 0 || it->second.first.reader == reader;
    it = is_told ? forget(peer, writer, it) : std::next(it);
  }
}

void PeerBook::forget_the_silent(Time now) {
  for (auto it = peers_.begin(); it != peers_.end();) {
    const auto next = std::next(it);
    if (now - it->second.heard > 2 * it->second.lease + kLonger) erase(it);
    it = next;
  }
}

PeerBook::Endpoints::iterator PeerBook::erase(Peer& peer, Endpoints::iterator endpoint) {
  forget_samples(peer, endpoint->second, 0, 0, kLargestSequenceNumber + 1);
  return peer.endpoints.erase(endpoint);
}

void PeerBook::erase(Peers::iterator peer) {
  unfinished_B_ -= peer->second.unfinished_B;
  const auto count = peers_of_address_.find(peer->second.address);
  if (--count->second == 0) peers_of_address_.erase(count);
  peers_.erase(peer);
}

}  // namespace aurasim::dds
