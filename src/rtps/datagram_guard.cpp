#include "rtps/datagram_guard.h"

#include <algorithm>

#include "rtps/datagram_check.h"
#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

namespace {

constexpr std::size_t kMostAddresses = 256;

/// Calls visit(writer, number, size) for each sample of a datagram that this process sends.
template <class Visit>
void for_each_sample(std::span<const std::uint8_t> datagram, Visit&& visit) {
  constexpr std::uint8_t kData = 0x15;
  std::size_t at = kHeaderBytes;
  while (datagram.size() >= at + 4) {
    const std::uint8_t id = datagram[at];
    const bool little = (datagram[at + 1] & 1) != 0;
    std::size_t length = WireCursor(datagram, at + 2, at + 4, little).u16();
    at += 4;
    if ((length == 0 && id == kData) || length > datagram.size() - at) length = datagram.size() - at;
    WireCursor body(datagram, at, at + length, little);
    at += length;
    if (id != kData) continue;
    body.skip(8);
    const std::uint32_t writer = body.entity();
    visit(writer, body.sequence_number(), static_cast<std::uint32_t>(length));
  }
}

}  // namespace

void DatagramGuard::set_own(const GuidPrefix& own) {
  const std::lock_guard lock(mutex_);
  own_ = own;
}

DatagramGuard::Admitted DatagramGuard::admit(std::span<std::uint8_t> bytes, Source source, Time now) {
  thread_local Findings findings;
  const std::optional<Refusal> malformed = check_datagram(bytes, findings);
  Admitted admitted;
  const std::lock_guard lock(mutex_);
  std::optional<Refusal> refusal = malformed;
  if (!refusal && !rates_.take_datagram(source, bytes.size(), now)) refusal = Refusal::kRate;
  if (!refusal) refusal = judge(findings, bytes, source, now, admitted);
  if (refusal) {
    refuse(*refusal, source);
    return {};
  }
  ++passed_;
  answer_requests(findings, source, now);
  findings.hide(bytes);
  admitted.size = findings.size;
  admitted.is_alone = findings.introduces;
  return admitted;
}

std::optional<Refusal> DatagramGuard::judge(const Findings& findings, std::span<const std::uint8_t> bytes,
                                            Source source, Time now, Admitted& admitted) {
  GuidPrefix sender;
  std::copy_n(bytes.begin() + 8, sender.size(), sender.begin());
  if (is_of_shunned(findings, sender)) return Refusal::kShunned;
  peers_.hear(sender, now);
  for (const Claim& claim : findings.claims) {
    if (own_ && claim.destination != GuidPrefix{} && claim.destination != *own_) continue;
    if (const auto refused = peers_.judge(claim, source, rates_, now)) return refused;
    if (claim.kind == Claim::Kind::kFragments) {
      if (const auto refused = judge_fragments(claim, bytes, source, now, admitted)) return refused;
    }
    if (!claim.has_payload) admitted.before.push_back(datagram_of_gap(claim, bytes));
  }
  return std::nullopt;
}

/// Takes in fragments of discovery or of a handshake. Once the sample is whole it is checked like any other, its hidden
/// parameters are hidden, and it is passed on in one piece. From unknown participants only announcements are taken.
std::optional<Refusal> DatagramGuard::judge_fragments(const Claim& claim, std::span<const std::uint8_t> bytes,
                                                      Source source, Time now, Admitted& admitted) {
  const bool is_known = peers_.knows(claim.guid.prefix);
  if (!is_known && claim.guid.entity != kParticipantWriter) return std::nullopt;
  if (const auto refused = fragments_.add(claim, is_known, bytes, now)) return refused;
  auto whole = fragments_.take_whole(claim, is_known, bytes);
  if (!whole) return std::nullopt;
  Findings findings;
  if (const auto malformed = check_datagram(whole->bytes(), findings)) return malformed;
  if (const auto refused = judge(findings, whole->bytes(), source, now, admitted)) return refused;
  findings.hide(whole->bytes());
  admitted.before.push_back(std::move(*whole));
  return std::nullopt;
}

/// True when the sender is shut out, or when another process announces a process that is shut out or its endpoints.
bool DatagramGuard::is_of_shunned(const Findings& findings, const GuidPrefix& sender) const {
  if (shunned_.empty()) return false;
  const auto is_announcement = [](const Claim& claim) {
    return claim.kind == Claim::Kind::kParticipant || claim.kind == Claim::Kind::kEndpoint ||
           claim.kind == Claim::Kind::kEndpointGone;
  };
  return shunned_.contains(sender) ||
         std::ranges::any_of(
             findings.claims,
             [&](const Claim& claim) { return !is_announcement(claim) && shunned_.contains(claim.guid.prefix); }) ||
         std::ranges::any_of(findings.requests,
                             [&](const Request& request) { return shunned_.contains(request.reader.prefix); });
}

void DatagramGuard::answer_requests(Findings& findings, Source source, Time now) {
  for (const Request& request : findings.requests) {
    if (own_ && request.destination != GuidPrefix{} && request.destination != *own_) continue;
    heartbeats_.note_request(request, now);
    const Repeats::Answer answer = repeats_.judge(request, now);
    if (answer == Repeats::Answer::kPass) continue;
    if (request.wanted > 0) refuse(Refusal::kRepeat, source);
    if (answer == Repeats::Answer::kHasAll) {
      findings.acknowledgements.push_back({request.at, repeats_.last_of(request.writer) + 1});
    } else {
      findings.hide_submessage(request.at, request.goes_to_end);
    }
  }
}

void DatagramGuard::set_nodes(Repeats::Prefixes nodes) {
  const std::lock_guard lock(mutex_);
  repeats_.set_nodes(std::move(nodes));
}

void DatagramGuard::add_writer_of_nodes(std::uint32_t writer, bool is_steady) {
  const std::lock_guard lock(mutex_);
  repeats_.add_writer_of_nodes(writer);
  if (is_steady) heartbeats_.add_writer(writer);
}

void DatagramGuard::remove_writer_of_nodes(std::uint32_t writer) {
  const std::lock_guard lock(mutex_);
  repeats_.remove_writer_of_nodes(writer);
  heartbeats_.remove_writer(writer);
}

void DatagramGuard::note_sent(std::span<const std::uint8_t> bytes, Time now) {
  const std::lock_guard lock(mutex_);
  for_each_sample(bytes, [&](std::uint32_t writer, std::uint64_t number, std::uint32_t sample_B) {
    repeats_.note_sent(writer, number, sample_B);
    heartbeats_.note_sent(writer, number, now);
  });
}

bool DatagramGuard::allows(const Heartbeat& heartbeat, const Peer& peer, Time now) {
  const std::lock_guard lock(mutex_);
  return heartbeats_.allows(heartbeat, peer, now);
}

std::vector<std::pair<GuidPrefix, Repeats::Answer>> DatagramGuard::take_new_askers() {
  const std::lock_guard lock(mutex_);
  return repeats_.take_news();
}

void DatagramGuard::shun(const GuidPrefix& process) {
  const std::lock_guard lock(mutex_);
  shunned_.insert(process);
}

void DatagramGuard::forgive(const GuidPrefix& process) {
  const std::lock_guard lock(mutex_);
  shunned_.erase(process);
}

void DatagramGuard::refuse(Refusal why, Source source) {
  const auto index = static_cast<std::size_t>(why);
  ++refused_[index];
  auto it = addresses_.find(source.address);
  if (it == addresses_.end()) {
    if (addresses_.size() >= kMostAddresses) {
      ++of_others_;
      return;
    }
    it = addresses_.emplace(source.address, GuardReport::Address{source.address, {}}).first;
    new_addresses_.push_back(source.address);
  }
  ++it->second.refused[index];
}

GuardReport DatagramGuard::report() const {
  const std::lock_guard lock(mutex_);
  GuardReport report{passed_, refused_, {}, of_others_};
  for (const auto& [address, of_address] : addresses_) report.addresses.push_back(of_address);
  std::ranges::sort(report.addresses, {}, &GuardReport::Address::address);
  return report;
}

std::vector<GuardReport::Address> DatagramGuard::take_new_sources() {
  const std::lock_guard lock(mutex_);
  std::vector<GuardReport::Address> sources;
  for (const std::uint32_t address : new_addresses_) sources.push_back(addresses_.at(address));
  new_addresses_.clear();
  return sources;
}

}  // namespace aurasim::rtps
