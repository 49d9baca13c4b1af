// Keeps track of the remote endpoints matched with a local one. The listeners run in DDS threads with DDS locks held:
// they only record what happened and wake the owner.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/rtps/common/Guid.h>

#include "core/ids.h"
#include "dds/wakeup.h"

namespace aurasim::dds {

using Guid = eprosima::fastrtps::rtps::GUID_t;
/// Identifies a process: all its endpoints share this prefix.
using ProcessPrefix = eprosima::fastrtps::rtps::GuidPrefix_t;

/// One match of a reader with a writer. A writer that is matched anew is a new entry.
struct RemoteWriter {
  Guid guid;
  std::optional<core::RegionId> region;  ///< whose it is, if that was known when it was matched
  std::uint64_t order = 0;               ///< counts matches, from 1
  bool matched = true;
  bool alive = false;  ///< has proved its life and the proof has not run out
  /// Time when its proof of life ran out. Nothing while it is valid, or before the first one.
  std::optional<std::chrono::steady_clock::time_point> silent_since;
  std::chrono::steady_clock::time_point since;  ///< when it was matched, or came back from its last silence
  /// Unmatched, or silent for longer than the grace time. Only set in copies that ReaderWatch returns.
  bool lost = false;
};

/// Listener of a reader. Thread-safe.
///
/// Silence is believed only after a grace time. When one writer is unmatched while its lease runs out, Fast DDS 2.9.1
/// now and then calls another one dead instead, until that one's next proof of life (seen in 1 of 13 restarts under
/// load). A process that takes its leave is unmatched at once: that needs no grace.
class ReaderWatch final : public eprosima::fastdds::dds::DataReaderListener {
 public:
  using RegionOf = std::function<std::optional<core::RegionId>(const Guid&)>;

  /// `region_of` tells whose a writer is, by the partition that it announces. Thread-safe.
  explicit ReaderWatch(Wakeup& wakeup, RegionOf region_of = {}) : wakeup_(wakeup), region_of_(std::move(region_of)) {}

  static constexpr std::chrono::nanoseconds kForEver = std::chrono::nanoseconds::max();
  /// Sets the grace time. Call it before the reader exists. At least two proofs of life must fit into it. kForEver:
  /// silence is never believed.
  void set_grace(std::chrono::nanoseconds grace) { grace_ = grace; }
  /// Sets what is called for each match of a writer, and for its end. Call it before the reader exists. It runs in DDS
  /// threads.
  void tell_matches(std::function<void(const Guid&, bool is_matched)> tell) { tell_match_ = std::move(tell); }
  /// Sets what is called, instead of waking the owner, when samples have come. Call it before the reader exists. It
  /// runs in DDS threads.
  void tell_data(std::function<void()> tell) { tell_data_ = std::move(tell); }

  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;
  void on_subscription_matched(eprosima::fastdds::dds::DataReader* reader,
                               const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(eprosima::fastdds::dds::DataReader* reader,
                             const eprosima::fastdds::dds::LivelinessChangedStatus& status) override;

  /// Writers in order of match; those that are gone are kept.
  std::vector<RemoteWriter> writers() const;
  /// Returns the writer of process `node` that was matched last. Without `node`: the first writer here that is not
  /// lost, or else the one matched last. Its order is 0 when there never was one. With `region`, only writers of that
  /// region count.
  RemoteWriter latest(const std::optional<ProcessPrefix>& node = {},
                      const std::optional<core::RegionId>& region = {}) const;
  /// True when a writer is matched; with `node`, a writer of that process; with `region`, a writer of that region.
  bool any_matched(const std::optional<ProcessPrefix>& node = {},
                   const std::optional<core::RegionId>& region = {}) const;
  /// Number of matches, ends of matches, and changes of a proof of life so far.
  std::uint64_t changes() const;

 private:
  RemoteWriter* find_matched(const Guid& guid);
  void forget_all_but_newest_lost();
  /// Returns a copy with `lost` set as of now.
  RemoteWriter judged(RemoteWriter writer) const;
  bool is_of(const RemoteWriter& writer, const std::optional<core::RegionId>& region) const;

  Wakeup& wakeup_;
  RegionOf region_of_;
  std::function<void(const Guid&, bool)> tell_match_;
  std::function<void()> tell_data_;
  std::chrono::nanoseconds grace_{0};
  mutable std::mutex mutex_;
  std::vector<RemoteWriter> writers_;
  std::uint64_t order_ = 0;
  std::uint64_t changes_ = 0;
};

/// Listener of a writer. Thread-safe.
class WriterWatch final : public eprosima::fastdds::dds::DataWriterListener {
 public:
  explicit WriterWatch(Wakeup& wakeup) : wakeup_(wakeup) {}

  void on_publication_matched(eprosima::fastdds::dds::DataWriter* writer,
                              const eprosima::fastdds::dds::PublicationMatchedStatus& status) override;

  std::vector<Guid> readers() const;
  /// Number of readers matched so far, those that left again included.
  std::uint64_t matches() const;

 private:
  Wakeup& wakeup_;
  mutable std::mutex mutex_;
  std::vector<Guid> readers_;
  std::uint64_t matches_ = 0;
};

/// The regions of endpoints, from their user data. Thread-safe.
class Directory {
 public:
  void add(const Guid& endpoint, core::RegionId region);
  void remove(const Guid& endpoint);
  /// The region, or -1 for an endpoint of no region (observers, tools).
  std::int64_t region_of(const Guid& endpoint) const;

 private:
  mutable std::mutex mutex_;
  std::map<Guid, core::RegionId> regions_;
};

/// The user data of an endpoint of `region`, and back. Text ("region=3"), so that tools can print it.
std::vector<unsigned char> user_data_of(core::RegionId region);
std::int64_t region_in(const std::vector<unsigned char>& user_data);

}  // namespace aurasim::dds
