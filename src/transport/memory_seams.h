// Parcels between coupled regions of one process, each of which steps in a thread of its own. Only one of the threads
// runs at a time, so what they share needs no lock.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/seam_mail.h"

namespace aurasim::transport {

struct ParcelCount {
  std::size_t count = 0;
  std::size_t bytes = 0;
};

class MemorySeams {
 public:
  explicit MemorySeams(std::size_t regions);
  ~MemorySeams();

  core::SeamMail& of(core::RegionId region);
  /// Runs the works, one for each region, until all have ended. Throws what the first work threw that ended so.
  void run(std::span<const std::function<void()>> works);
  /// In the next run() this region's work ends when it has posted so many parcels, as that of a process that dies.
  void end_after(core::RegionId region, std::size_t parcels) { ending_ = {region, parcels}; }
  /// True if all parcels have been fetched.
  bool is_empty() const;
  /// Number of parcels so far.
  std::size_t count() const { return posted_.count; }
  const ParcelCount& posted() const { return posted_; }

 private:
  class Box;

  void put(core::RegionId from, core::RegionId to, std::span<const std::byte> parcel);
  std::vector<std::byte> take(core::RegionId from, core::RegionId to);

  std::mutex mutex_;  ///< held by the thread that runs
  std::condition_variable arrived_;
  std::map<std::pair<core::RegionId, core::RegionId>, std::deque<std::vector<std::byte>>> parcels_;
  ParcelCount posted_;
  std::optional<std::pair<core::RegionId, std::size_t>> ending_;  ///< the parcels that this region posts yet
  bool closed_ = false;
  std::vector<std::unique_ptr<Box>> boxes_;
};

}  // namespace aurasim::transport
