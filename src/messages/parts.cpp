#include "messages/parts.h"

#include <algorithm>
#include <utility>

namespace aurasim::messages {

Part part_of(std::span<const std::uint8_t> whole, std::uint64_t message, std::uint32_t number, std::size_t part_B) {
  const std::size_t begin = number * part_B;
  return {message, number, parts_of(whole.size(), part_B),
          whole.subspan(begin, std::min(part_B, whole.size() - begin))};
}

bool PartAssembly::is_sound(const Part& part) const {
  return part.message >= 1 && part.count >= 2 && part.count <= limits_.most_parts && part.number < part.count &&
         !part.octets.empty();
}

PartAssembly::Added PartAssembly::add(const Stream& stream, const Part& part, Time now) {
  const std::lock_guard lock(mutex_);
  Added added;
  if (!is_sound(part)) return added;
  Incoming* const incoming = incoming_of(stream, part, now);
  if (incoming == nullptr) return added;
  added.lost = std::exchange(incoming->lost, 0);
  Message* const message = message_of(stream, *incoming, part, added);
  if (message == nullptr || message->is_over) return added;
  const std::size_t octets = part.octets.size();
  if (message->count != part.count || message->bytes + octets > limits_.message_B) {
    added.lost += end(stream, *message);
    return added;
  }
  message->touched = now;
  if (message->parts.contains(part.number)) return added;
  if (!has_room_for(stream, octets)) make_room(now);
  if (!has_room_for(stream, octets)) {
    added.lost += end(stream, *message);
    return added;
  }
  message->parts[part.number].assign(part.octets.begin(), part.octets.end());
  message->bytes += octets;
  bytes_ += octets;
  of_processes_[stream.process] += octets;
  if (message->parts.size() < message->count) return added;
  added.whole.emplace().reserve(message->bytes);
  for (const auto& [number, bytes] : message->parts)
    added.whole->insert(added.whole->end(), bytes.begin(), bytes.end());
  message->is_over = true;
  empty(stream, *message);
  return added;
}

/// Returns what is known of a stream; null when there are too many.
PartAssembly::Incoming* PartAssembly::incoming_of(const Stream& stream, const Part& part, Time now) {
  if (const auto known = streams_.find(stream); known != streams_.end()) return &known->second;
  if (streams_.size() >= limits_.streams) make_room(now);
  if (streams_.size() >= limits_.streams) return nullptr;
  Incoming& incoming = streams_[stream];
  if (part.number > 0) incoming.messages[part.message].is_seen_from_begin = false;
  return &incoming;
}

/// Returns the message that a part belongs to; null for one that is older than the window. Gives up messages that a
/// newer one leaves behind.
PartAssembly::Message* PartAssembly::message_of(const Stream& stream, Incoming& incoming, const Part& part,
                                                Added& added) {
  if (part.message < incoming.oldest) return nullptr;
  Message& message = incoming.messages[part.message];
  if (message.count == 0) message.count = part.count;
  while (incoming.messages.size() > kWindow) {
    const auto oldest = incoming.messages.begin();
    incoming.oldest = oldest->first + 1;
    added.lost += end(stream, oldest->second);
    incoming.messages.erase(oldest);
  }
  return part.message < incoming.oldest ? nullptr : &message;
}

bool PartAssembly::has_room_for(const Stream& stream, std::size_t octets) const {
  const auto of_process = of_processes_.find(stream.process);
  return bytes_ + octets <= limits_.all_B &&
         (of_process == of_processes_.end() || of_process->second + octets <= limits_.of_a_process_B);
}

/// Drops messages that have got no part for long, and streams that are quiet for as long. Looks once a second at most.
void PartAssembly::make_room(Time now) {
  if (now - room_made_ < std::chrono::seconds(1)) return;
  room_made_ = now;
  for (auto it = streams_.begin(); it != streams_.end();) {
    const auto is_given_up = [&](const Message& message) { return now - message.touched > limits_.until_given_up; };
    bool is_quiet = true;
    for (auto& [number, message] : it->second.messages) {
      if (is_given_up(message)) it->second.lost += end(it->first, message);
      is_quiet = is_quiet && is_given_up(message);
    }
    it = is_quiet ? streams_.erase(it) : std::next(it);
  }
}

/// Frees the octets of a message.
void PartAssembly::empty(const Stream& stream, Message& message) {
  bytes_ -= message.bytes;
  if (const auto of_process = of_processes_.find(stream.process); of_process != of_processes_.end()) {
    of_process->second -= message.bytes;
    if (of_process->second == 0) of_processes_.erase(of_process);
  }
  message.bytes = 0;
  message.parts.clear();
}

/// Gives a message up. Returns 1 if it counts as lost.
std::uint32_t PartAssembly::end(const Stream& stream, Message& message) {
  empty(stream, message);
  const bool is_lost = !message.is_over && message.is_seen_from_begin;
  message.is_over = true;
  return is_lost ? 1 : 0;
}

std::size_t PartAssembly::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace aurasim::messages
