// One writer or reader with the publisher or subscriber that gives it its partitions, by profile name.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "core/ids.h"
#include "dds/domain.h"
#include "dds/watch.h"
#include "dds/wire_error.h"

namespace aurasim::dds {

struct EndpointSpec {
  TopicId topic = TopicId::kAura;
  std::vector<std::string> partitions;
  std::optional<core::RegionId> region;  ///< whose endpoint this is; peers are told (user data)
  std::string profile = {};              ///< of the QoS; empty: the topic's
  /// A reader that asks for no history gets no repeats either, whatever its profile says.
  bool best_effort_if_volatile = false;
};

inline EndpointSpec in_world(TopicId topic) { return {topic, {kWorldPartition}, {}, {}}; }

enum class WriteResult : std::uint8_t { kSent, kSentAtSecondTry, kFailed };

/// QoS by profile `<topic>_writer`, or as the spec says. A writer with MANUAL_BY_TOPIC liveliness is kept alive by the
/// domain's liveliness asserter.
class Writer {
 public:
  Writer(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// `sample` is the generated type of the topic.
  WriteResult write(void* sample);
  /// Forgets all samples if every reader has them all; returns how many there were. A reader that acknowledges nothing
  /// for as many calls as the history is deep is named in the log. For volatile writers of which only
  /// the caller's thread writes. Fast DDS 2.9 forgets them by itself, except those that a reader was still to
  /// acknowledge when another one was matched: these stay for ever, and each heartbeat then lists what is missing after
  /// them, one by one.
  std::size_t forget_acknowledged();
  /// Every matched reader has every sample. Does not wait.
  bool all_acknowledged();
  /// True when a reader of `region` is matched.
  bool reaches(core::RegionId region) const;
  std::size_t reader_count() const { return watch_.readers().size(); }
  /// Readers that have come so far, those that left again included.
  std::uint64_t matches() const { return watch_.matches(); }
  /// Matched readers in other processes.
  std::size_t foreign_reader_count() const;
  const Guid& guid() const { return writer_->guid(); }

 private:
  void say_who_does_not_read();

  Domain& domain_;
  WriterWatch watch_;
  bool is_of_nodes_ = false;  ///< what it writes, nodes say to each other
  std::int32_t unread_ = 0;   ///< calls of forget_acknowledged() since every reader had everything
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::DataWriter* writer_ = nullptr;
};

/// Where a sample comes from.
struct Origin {
  Guid writer;
  /// The writer's wall clock when it was sent, minus ours when it came: how far that clock is ahead, less the way.
  std::chrono::nanoseconds clock_ahead{0};
};

/// QoS by profile `<topic>_reader`, or as the spec says.
class Reader {
 public:
  Reader(Domain& domain, const EndpointSpec& spec, Wakeup& wakeup);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Takes the next sample that carries data into `sample` (the generated type). False when there is none.
  bool take(void* sample, Origin* origin = nullptr);

  /// It is counted against who has sent it, if it is no message of ours at all: other versions, runs and maps, and what
  /// somebody has typed, are nobody's fault.
  void refuse_from(const Origin& origin, WireError error);
  /// Likewise: it is not its to say.
  void refuse_from(const Origin& origin, const std::string& what);
  /// It is more than its sender is given: `what` says how much that is.
  void ration(const Origin& origin, const std::string& what);

  const ReaderWatch& watch() const { return watch_; }
  /// As the QoS says.
  std::vector<std::string> partitions() const;

 private:
  Domain& domain_;
  ReaderWatch watch_;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  eprosima::fastdds::dds::DataReader* reader_ = nullptr;
};

}  // namespace aurasim::dds
