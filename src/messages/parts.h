// Messages that do not fit into one datagram of the link travel in parts. Cuts serialized messages, and puts the parts
// of each source together again. Knows nothing of DDS; time is passed in.
#pragma once

#include <array>
#include <chrono>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace aurasim::messages {

/// Largest message that is sent or put together. The hand-off of a whole scene (10,000 bodies with contacts) has some
/// 20 MB.
inline constexpr std::size_t kLargestMessage_B = std::size_t{64} << 20;

/// One part of a serialized message.
struct Part {
  std::uint64_t message = 0;             ///< which of the writer's messages in parts, from 1
  std::uint32_t number = 0, count = 0;   ///< of the part, from 0; of all parts of the message
  std::span<const std::uint8_t> octets;  ///< of the message
};

/// Number of parts of at most `part_B` bytes that a message of `message_B` bytes is cut into.
inline std::uint32_t parts_of(std::size_t message_B, std::size_t part_B) {
  return static_cast<std::uint32_t>((message_B + part_B - 1) / part_B);
}
/// Part `number` of a message that is cut into parts of `part_B` bytes.
Part part_of(std::span<const std::uint8_t> whole, std::uint64_t message, std::uint32_t number, std::size_t part_B);

struct PartLimits {
  using Time = std::chrono::nanoseconds;

  std::size_t message_B = kLargestMessage_B;
  std::size_t of_a_process_B = std::size_t{96} << 20, all_B = std::size_t{192} << 20;  ///< of unfinished messages
  std::uint32_t most_parts = 1U << 17;
  std::size_t streams = 1U << 14;
  /// Time after which an unfinished message that gets no more parts makes room for others.
  Time until_given_up = std::chrono::seconds(10);
};

/// Puts messages together. Memory is taken only for octets that have come. Thread-safe.
class PartAssembly {
 public:
  using Time = PartLimits::Time;  ///< time of any monotonic clock

  /// The messages from one writer to one reader.
  struct Stream {
    std::array<std::uint8_t, 12> process{};  ///< of the writer
    std::uint64_t endpoints = 0;             ///< writer and reader
    auto operator<=>(const Stream&) const = default;
  };
  struct Added {
    /// The whole message, if this was the last part of it that was missing.
    std::optional<std::vector<std::uint8_t>> whole;
    /// Messages of this stream that will never be whole. A message that had begun before the stream was first received
    /// is not counted.
    std::uint32_t lost = 0;
  };

  explicit PartAssembly(const PartLimits& limits = {}) : limits_(limits) {}

  /// Takes in a part. Parts of a message may come in any order, and twice.
  Added add(const Stream& stream, const Part& part, Time now);
  /// Bytes of unfinished messages.
  std::size_t bytes() const;

  /// A message that is so many messages older than the newest of its stream is given up.
  static constexpr std::size_t kWindow = 8;

 private:
  struct Message {
    std::uint32_t count = 0;
    std::map<std::uint32_t, std::vector<std::uint8_t>> parts;
    std::size_t bytes = 0;
    bool is_over = false;            ///< handed on, or given up: what else comes of it is dropped
    bool is_seen_from_begin = true;  ///< false: it had begun before the stream was first received
    Time touched{0};                 ///< when a part was added
  };
  using Messages = std::map<std::uint64_t, Message>;  ///< by number; the newest kWindow
  struct Incoming {
    Messages messages;
    std::uint64_t oldest = 1;  ///< messages with smaller numbers are no longer taken
    std::uint32_t lost = 0;    ///< messages lost that add() has not returned yet
  };
  using Streams = std::map<Stream, Incoming>;

  bool is_sound(const Part& part) const;
  Incoming* incoming_of(const Stream& stream, const Part& part, Time now);
  Message* message_of(const Stream& stream, Incoming& incoming, const Part& part, Added& added);
  bool has_room_for(const Stream& stream, std::size_t octets) const;
  void make_room(Time now);
  void empty(const Stream& stream, Message& message);
  std::uint32_t end(const Stream& stream, Message& message);

  PartLimits limits_;
  mutable std::mutex mutex_;
  Streams streams_;
  std::map<std::array<std::uint8_t, 12>, std::size_t> of_processes_;  ///< bytes of unfinished messages
  std::size_t bytes_ = 0;
  Time room_made_{std::chrono::hours(-1)};
};

}  // namespace aurasim::messages
