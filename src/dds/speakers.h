// Who may say what. Everything on the wire names a region as its source; by whom it was really said, DDS tells by the
// writer's id. So what a process says in the name of another's region is found out, counted, and, when there is too
// much of it, not listened to any more.
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
#include "dds/datagram_findings.h"
#include "dds/watch.h"

namespace aurasim::dds {

class DatagramGuard;  // datagram_guard.h

/// Thread-safe.
class Speakers {
 public:
  /// `guard`, if there is one, is told who is a node and who is not listened to.
  explicit Speakers(std::shared_ptr<DatagramGuard> guard = nullptr) : guard_(std::move(guard)) {}

  /// Of this process: it may say everything.
  void set_self(const ProcessPrefix& self);
  /// A writer was discovered, with the partitions that it announces, or is gone.
  void add(const Guid& writer, const std::vector<std::string>& partitions);
  void remove(const Guid& writer);

  /// `process` is the node of `region`.
  void set(core::RegionId region, const ProcessPrefix& process);
  std::optional<ProcessPrefix> of(core::RegionId region) const;

  /// Does all that it publishes go to partitions of this region? What is not known is believed.
  bool is_at_home(const Guid& writer, core::RegionId region) const;
  /// Is it an endpoint of the process that is the node of `region`? Before that one is known, everybody's is.
  bool may_speak(const Guid& endpoint, core::RegionId region) const;
  /// Is it an endpoint of a node of this run, of whatever region? Before any is known, everybody's is.
  bool is_node(const Guid& endpoint) const;

  /// What `writer` has said was not its to say, or cannot be. A process of no node is not listened to any more after
  /// kPatience of them. Of one that was a node, the last words may come late: they are not told.
  void refuse(const Guid& writer, const std::string& what);
  /// `writer` has said more than it is given; what is over is dropped. Counted, and told once of each process and
  /// topic, but nobody is shut out for it: who asks for much at once has done nothing else wrong.
  void ration(const Guid& writer, const std::string& what);
  /// It is not listened to from now on, unless it is a node's.
  void shun(const ProcessPrefix& process, const std::string& why);
  bool shuns(const ProcessPrefix& process) const;
  /// Samples refused of processes that are no nodes, in all.
  std::uint64_t refused() const;

  /// For the log: the first refusal of each process, when it is not listened to any more, and what others say here.
  void say(std::string text);
  std::vector<std::string> take_said();

  static constexpr std::uint64_t kPatience = 100;

 private:
  bool is_node_locked(const ProcessPrefix& process) const;
  void shun_locked(const ProcessPrefix& process, const std::string& why);
  void say_locked(std::string text);

  void tell_guard_of_nodes() const;

  std::shared_ptr<DatagramGuard> guard_;
  mutable std::mutex mutex_;
  std::optional<ProcessPrefix> self_;
  std::map<Guid, std::int64_t> homes_;  ///< of writers: their region; -1: of none, or of several
  std::deque<Guid> gone_;               ///< what they have published may still be waiting here
  std::map<core::RegionId, ProcessPrefix> nodes_;
  std::deque<ProcessPrefix> former_;  ///< nodes until others took their regions over, oldest first
  std::map<ProcessPrefix, std::uint64_t> refused_of_;
  std::set<ProcessPrefix> shunned_;
  std::set<std::pair<ProcessPrefix, std::string>> rationed_;
  std::uint64_t refused_ = 0;
  std::vector<std::string> said_;
};

GuidPrefix prefix_of(const ProcessPrefix& process);
ProcessPrefix process_of(const GuidPrefix& prefix);
/// "01.0f.6a...": as Fast DDS and other tools print it.
std::string text_of(const ProcessPrefix& process);

}  // namespace aurasim::dds
