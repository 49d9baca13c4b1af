#include "rtps/repeats.h"

#include <algorithm>

namespace aurasim::rtps {

void Repeats::note_sent(std::uint32_t writer, std::uint64_t number, std::uint32_t sample_B) {
  if (sent_.size() >= kMostWriters) sent_.clear();
  Sent& sent = sent_[writer];
  sent.last = std::max(sent.last, number);
  sent.sample_B = std::max(sent.sample_B - sent.sample_B / 16, sample_B);
}

std::uint64_t Repeats::last_of(std::uint32_t writer) const {
  const auto sent = sent_.find(writer);
  return sent == sent_.end() ? 0 : sent->second.last;
}

double Repeats::price_of(const Request& request) const {
  const auto sent = sent_.find(request.writer);
  const double known_B = sent == sent_.end() ? 0 : sent->second.sample_B;
  const double each_B = std::max(known_B, limits_.smallest_sample_B);
  return std::min(request.wanted * each_B, limits_.bytes_burst);
}

Repeats::Answer Repeats::judge(const Request& request, Time now) {
  if (nodes_.empty() || nodes_.contains(request.reader.prefix)) return Answer::kPass;
  const bool is_of_nodes = of_nodes_.contains(request.writer);
  if (request.wanted == 0 && !is_of_nodes) return Answer::kPass;
  Asker& asker = askers_.find(request.reader.prefix, kMostAskers, [&] {
    return Asker{{limits_.bytes_per_s, limits_.bytes_burst, now}, Time(0), false, false};
  });
  if (is_of_nodes && is_too_late(asker, request, now)) {
    if (request.wanted > 0) tell(asker.is_said_of_nodes, request, Answer::kHasAll);
    return Answer::kHasAll;
  }
  const double price = price_of(request);
  if (asker.bytes.take(price, now) && (is_built_in(request.writer) || all_.take(price, now))) return Answer::kPass;
  tell(asker.is_said, request, Answer::kDrop);
  return Answer::kDrop;
}

/// True when a process that is no node asks for messages between nodes later than RepeatLimits::until_known after its
/// first request. A reader that has just joined (base 0) or lacks nothing is never too late.
bool Repeats::is_too_late(Asker& asker, const Request& request, Time now) const {
  if (asker.since == Time(0)) asker.since = now;
  if (now - asker.since < limits_.until_known) return false;
  return request.base > 0 && request.base <= last_of(request.writer);
}

void Repeats::tell(bool& is_said, const Request& request, Answer answer) {
  if (is_said || news_.size() >= kMostNews) return;
  is_said = true;
  news_.emplace_back(request.reader.prefix, answer);
}

}  // namespace aurasim::rtps
