#include "rtps/peer_book.h"

#include <algorithm>
#include <iterator>

namespace aurasim::rtps {
namespace {

using namespace std::chrono_literals;

/// How much longer than its lease a silent participant stays in the book. Fast DDS forgets it after its lease; the book
/// must not forget it earlier.
constexpr core::TokenBucket::Time kLonger = 10s;
constexpr std::size_t kMostReaders = 64;

}  // namespace

void PeerBook::hear(const GuidPrefix& participant, Time now) {
  if (const auto it = peers_.find(participant); it != peers_.end()) it->second.heard = now;
}

std::optional<Refusal> PeerBook::judge(const Claim& claim, Source source, SourceLimits& rates, Time now) {
  if (claim.kind == Claim::Kind::kParticipant) return take_participant(claim, source, now);
  const auto it = peers_.find(claim.guid.prefix);
  if (it == peers_.end()) return std::nullopt;  // Fast DDS does not know it either
  Peer& peer = it->second;
  if (claim.kind == Claim::Kind::kEndpoint) return take_endpoint(peer, claim);
  if (claim.kind == Claim::Kind::kEndpointGone) {
    const auto gone = peer.endpoints.find(claim.guid.entity);
    if (gone != peer.endpoints.end() && !is_built_in(claim.guid.entity)) peer.endpoints.erase(gone);
    return std::nullopt;
  }
  Endpoint* writer = endpoint_of(peer, claim.guid.entity);
  if (writer == nullptr) return Refusal::kTooMany;
  if (claim.kind == Claim::Kind::kData || claim.kind == Claim::Kind::kFragments) {
    return is_far_ahead(*writer, claim) ? std::optional(Refusal::kJump) : std::nullopt;
  }
  if (claim.kind == Claim::Kind::kHeartbeat) return take_heartbeat(*writer, claim, source, rates, now);
  return take_gap(claim, source, rates, now);
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

/// Returns the record of an endpoint; null if there are too many. Endpoints that were never announced (built-in, or
/// announced in secret) make room for others.
PeerBook::Endpoint* PeerBook::endpoint_of(Peer& peer, std::uint32_t entity) {
  if (const auto it = peer.endpoints.find(entity); it != peer.endpoints.end()) return &it->second;
  if (peer.endpoints.size() >= limits_.endpoints_of_a_participant) {
    for (auto it = peer.endpoints.begin(); it != peer.endpoints.end();) {
      it = it->second.announced ? std::next(it) : peer.endpoints.erase(it);
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
std::optional<Refusal> PeerBook::take_heartbeat(Endpoint& writer, const Claim& claim, Source source,
                                                SourceLimits& rates, Time now) {
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
std::optional<Refusal> PeerBook::take_gap(const Claim& claim, Source source, SourceLimits& rates, Time now) const {
  const std::uint64_t numbers = claim.last + 1 - claim.first;
  if (numbers > limits_.longest_gap) return Refusal::kJump;
  if (numbers > limits_.free_gap && !rates.take_gap(source.address, static_cast<double>(numbers), now)) {
    return Refusal::kJump;
  }
  return std::nullopt;
}

void PeerBook::forget_the_silent(Time now) {
  for (auto it = peers_.begin(); it != peers_.end();) {
    const auto next = std::next(it);
    if (now - it->second.heard > 2 * it->second.lease + kLonger) erase(it);
    it = next;
  }
}

void PeerBook::erase(Peers::iterator peer) {
  const auto count = peers_of_address_.find(peer->second.address);
  if (--count->second == 0) peers_of_address_.erase(count);
  peers_.erase(peer);
}

}  // namespace aurasim::rtps
