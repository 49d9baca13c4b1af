// Checks which process may publish as which region. Every message names a region as its source; the writer's id in DDS
// tells which process really sent it. Messages in the name of another's region are refused and counted, and a process
// that sends too many of them is shut out.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.h"
#include "dds/watch.h"
#include "rtps/datagram_findings.h"

namespace aurasim::rtps {
class DatagramGuard;
}

namespace aurasim::dds {

/// Thread-safe.
class Speakers {
 public:
  /// `guard`, if there is one, learns which processes are nodes and which are shut out.
  explicit Speakers(std::shared_ptr<rtps::DatagramGuard> guard = nullptr) : guard_(std::move(guard)) {}

  /// Sets the own process, which may publish as any region.
  void set_self(const ProcessPrefix& self);
  /// Takes note of a discovered writer and the partitions that it announces, or of a writer that is gone. A writer that
  /// changes its partitions to those of another region is of no region any more: Fast DDS 2.9.1 checks the new ones
  /// against the writer's key, but does not end the matches that the old ones have made.
  void add(const Guid& writer, const std::vector<std::string>& partitions);
  void remove(const Guid& writer);

  /// Takes note that a process is a hub of the run, or is gone. A hub publishes what others have published.
  void add_hub(const ProcessPrefix& process);
  void remove_hub(const ProcessPrefix& process);
  bool is_hub(const ProcessPrefix& process) const;
  bool has_hub() const;

  /// Sets `process` as the node of `region`.
  void set(core::RegionId region, const ProcessPrefix& process);
  std::optional<ProcessPrefix> of(core::RegionId region) const;

  /// The region to which all partitions of `writer` belong. Nothing: none, several, or the writer is unknown.
  std::optional<core::RegionId> home_of(const Guid& writer) const;
  /// True when all partitions of `writer` belong to `region`. Also true for an unknown writer.
  bool is_at_home(const Guid& writer, core::RegionId region) const;
  /// True when `endpoint` belongs to the process that is the node of `region`. Also true while that node is unknown.
  bool may_speak(const Guid& endpoint, core::RegionId region) const;
  /// True when `endpoint` belongs to a node of this run, of whatever region. Also true while no node is known.
  bool is_node(const Guid& endpoint) const;

  /// Counts a sample that `writer` had no right to publish, or that is invalid. A process that is no node is shut out
  /// after kPatience of them. Refusals of a former node are not reported, because its last messages may arrive late.
  void refuse(const Guid& writer, const std::string& what);
  /// Counts a sample of `writer` that exceeded a rate limit and was dropped. Reported once per process and topic. No
  /// process is shut out for it, because sending much at once is no other fault.
  void ration(const Guid& writer, const std::string& what);
  /// Shuts `process` out from now on, unless it is a node.
  void shun(const ProcessPrefix& process, const std::string& why);
  bool shuns(const ProcessPrefix& process) const;
  /// Total number of samples refused from processes that are no nodes.
  std::uint64_t refused() const;

  /// Adds a message for the log. The log gets the first refusal of each process, each shut-out, and these.
  void say(std::string text);
  std::vector<std::string> take_said();

  static constexpr std::uint64_t kPatience = 100;

 private:
  bool is_node_locked(const ProcessPrefix& process) const;
  void shun_locked(const ProcessPrefix& process, const std::string& why);
  void say_locked(std::string text);

  void tell_guard_of_nodes() const;

  std::shared_ptr<rtps::DatagramGuard> guard_;
  mutable std::mutex mutex_;
  std::optional<ProcessPrefix> self_;
  std::map<Guid, std::int64_t> homes_;  ///< region of each writer; -1: no region, or several
  std::deque<Guid> gone_;               ///< removed writers whose samples may still be waiting here
  std::map<core::RegionId, ProcessPrefix> nodes_;
  std::deque<ProcessPrefix> former_;  ///< processes that were nodes until others took over their regions, oldest first
  std::map<ProcessPrefix, std::uint64_t> refused_of_;
  std::set<ProcessPrefix> hubs_;
  std::set<ProcessPrefix> shunned_;
  std::set<std::pair<ProcessPrefix, std::string>> rationed_;
  std::uint64_t refused_ = 0;
  std::vector<std::string> said_;
};

rtps::GuidPrefix prefix_of(const ProcessPrefix& process);
ProcessPrefix process_of(const rtps::GuidPrefix& prefix);
/// Text of a process id, "01.0f.6a...", as Fast DDS and other tools print it.
std::string text_of(const ProcessPrefix& process);

}  // namespace aurasim::dds
