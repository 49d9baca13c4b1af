#include "dds/watch.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>

namespace aurasim::dds {

using eprosima::fastrtps::rtps::iHandle2GUID;

namespace {

constexpr std::string_view kUserDataKey = "region=";
/// Most dead writers that a reader remembers. They are remembered so that observers can show "lost".
constexpr std::size_t kMaxLost = 1000;

}  // namespace

void ReaderWatch::on_data_available(eprosima::fastdds::dds::DataReader*) {
  tell_data_ ? tell_data_() : wakeup_.notify();
}

void ReaderWatch::on_subscription_matched(eprosima::fastdds::dds::DataReader*,
                                          const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) {
  const Guid guid = iHandle2GUID(status.last_publication_handle);
  {
    const std::lock_guard lock(mutex_);
    ++changes_;
    if (status.current_count_change > 0) {
      RemoteWriter writer;
      writer.guid = guid;
      if (region_of_) writer.region = region_of_(guid);
      writer.order = ++order_;
      writer.since = std::chrono::steady_clock::now();
      writers_.push_back(writer);
    } else if (RemoteWriter* writer = find_matched(guid)) {
      writer->matched = false;
      writer->alive = false;
      forget_all_but_newest_lost();
    }
  }
  if (tell_match_) tell_match_(guid, status.current_count_change > 0);
  wakeup_.notify();
}

void ReaderWatch::on_liveliness_changed(eprosima::fastdds::dds::DataReader*,
                                        const eprosima::fastdds::dds::LivelinessChangedStatus& status) {
  const Guid guid = iHandle2GUID(status.last_publication_handle);
  {
    const std::lock_guard lock(mutex_);
    RemoteWriter* writer = find_matched(guid);
    if (writer == nullptr || status.alive_count_change == 0) {
      return;
    }
    ++changes_;
    writer->alive = status.alive_count_change > 0;
    const auto now = std::chrono::steady_clock::now();
    if (writer->alive && std::exchange(writer->silent_since, std::nullopt)) writer->since = now;
    if (!writer->alive) writer->silent_since = now;
  }
  wakeup_.notify();
}

std::vector<RemoteWriter> ReaderWatch::writers() const {
  const std::lock_guard lock(mutex_);
  std::vector<RemoteWriter> result;
  for (const RemoteWriter& writer : writers_) {
    result.push_back(judged(writer));
  }
  return result;
}

RemoteWriter ReaderWatch::latest(const std::optional<ProcessPrefix>& node,
                                 const std::optional<core::RegionId>& region) const {
  const std::lock_guard lock(mutex_);
  const RemoteWriter* first_here = nullptr;  // the first that is not lost
  const RemoteWriter* last = nullptr;
  for (const RemoteWriter& writer : writers_) {
    if ((node && writer.guid.guidPrefix != *node) || !is_of(writer, region)) continue;
    last = &writer;
    if (first_here == nullptr && !node && !judged(writer).lost) first_here = &writer;
  }
  if (last == nullptr) return {};
  if (first_here == nullptr) return judged(*last);
  for (const RemoteWriter& writer : writers_) {
    if (writer.guid.guidPrefix == first_here->guid.guidPrefix && is_of(writer, region)) last = &writer;
  }
  return judged(*last);
}

bool ReaderWatch::any_matched(const std::optional<ProcessPrefix>& node,
                              const std::optional<core::RegionId>& region) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(writers_, [&](const RemoteWriter& writer) {
    return writer.matched && (!node || writer.guid.guidPrefix == *node) && is_of(writer, region);
  });
}

bool ReaderWatch::is_of(const RemoteWriter& writer, const std::optional<core::RegionId>& region) const {
  if (!region || writer.region == region) return true;
  return !writer.region && region_of_ && region_of_(writer.guid) == region;
}

std::uint64_t ReaderWatch::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

RemoteWriter ReaderWatch::judged(RemoteWriter writer) const {
  const bool silent = writer.silent_since && std::chrono::steady_clock::now() - *writer.silent_since >= grace_;
  writer.lost = !writer.matched || silent;
  return writer;
}

RemoteWriter* ReaderWatch::find_matched(const Guid& guid) {
  const auto found =
      std::ranges::find_if(writers_, [&](const RemoteWriter& writer) { return writer.matched && writer.guid == guid; });
  return found == writers_.end() ? nullptr : &*found;
}

void ReaderWatch::forget_all_but_newest_lost() {
  while (writers_.size() > kMaxLost) {
    const auto oldest = std::ranges::find(writers_, false, &RemoteWriter::matched);
    if (oldest == writers_.end()) {
      return;
    }
    writers_.erase(oldest);
  }
}

void WriterWatch::on_publication_matched(eprosima::fastdds::dds::DataWriter*,
                                         const eprosima::fastdds::dds::PublicationMatchedStatus& status) {
  const Guid guid = iHandle2GUID(status.last_subscription_handle);
  {
    const std::lock_guard lock(mutex_);
    std::erase(readers_, guid);
    if (status.current_count_change > 0) {
      readers_.push_back(guid);
      ++matches_;
    }
  }
  wakeup_.notify();
}

std::uint64_t WriterWatch::matches() const {
  const std::lock_guard lock(mutex_);
  return matches_;
}

std::vector<Guid> WriterWatch::readers() const {
  const std::lock_guard lock(mutex_);
  return readers_;
}

void Directory::add(const Guid& endpoint, core::RegionId region) {
  const std::lock_guard lock(mutex_);
  regions_.insert_or_assign(endpoint, region);
}

void Directory::remove(const Guid& endpoint) {
  const std::lock_guard lock(mutex_);
  regions_.erase(endpoint);
}

std::int64_t Directory::region_of(const Guid& endpoint) const {
  const std::lock_guard lock(mutex_);
  const auto found = regions_.find(endpoint);
  return found == regions_.end() ? -1 : std::int64_t{core::value_of(found->second)};
}

std::vector<unsigned char> user_data_of(core::RegionId region) {
  const std::string text = std::string(kUserDataKey) + std::to_string(core::value_of(region));
  return {text.begin(), text.end()};
}

std::int64_t region_in(const std::vector<unsigned char>& user_data) {
  const std::string text(user_data.begin(), user_data.end());
  if (!text.starts_with(kUserDataKey)) {
    return -1;
  }
  std::uint32_t region = 0;
  const char* first = text.data() + kUserDataKey.size();
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(first, last, region);
  return error == std::errc{} && end == last ? std::int64_t{region} : -1;
}

}  // namespace aurasim::dds
