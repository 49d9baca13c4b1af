// The parts of the world that a node keeps while it runs: parts of saved worlds as files, states for survival.disk, and
// checkpoints to go back to when a node has died. Decides which states are kept and when a part counts; the
// caller passes in what happens, and no topic is named here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "config/launch.h"
#include "core/order.h"
#include "core/world_cut.h"
#include "cut/part_writer.h"
#include "cut/saved_world.h"
#include "dds/control.h"
#include "node/node.h"
#include "process/checkpoints.h"
#include "process/command_server.h"
#include "process/node_options.h"
#include "records/recorder.h"

namespace aurasim::process {

class Saving {
 public:
  /// Both must outlive this object. `launch` may be replaced by another launch of the same run.
  Saving(const config::Launch& launch, const NodeOptions& options)
      : launch_(launch),
        options_(options),
        writer_({options.saves, {}}, options.region, launch.regions.size(), options.save_keep) {}

  /// Begins a generation in state `step`. `start`: request id of the command that started it. A run whose nodes were
  /// started by hand has no number, so this id serves.
  void begin(std::uint64_t start, core::Generation generation, core::Step step);
  /// Goes on with other regions, which is a generation without a beginning: what is being kept stays.
  void change_map(std::uint64_t start, core::Generation generation);

  /// Asks `node` for its next checkpoint, unless it is asked for already. Every node does so by itself, in the same
  /// states.
  void plan_checkpoint(node::Node& node);
  /// Notes an order to save. Its part comes with the state that it names.
  void expect(const core::Order& order) { writer_.expect(order); }
  /// Records up to this state have been given to the recorder.
  void note_recorded(core::Step step) { recorded_ = std::max(recorded_, step); }
  /// Keeps the parts that `node` has completed: writes them on threads beside the run, and gives them to `checkpoints`.
  /// `recorder` may be null.
  void keep_parts(node::Node& node, CommandServer& server, Checkpoints& checkpoints, records::Recorder* recorder);
  /// Saves the state in which `node` is paused, where a client has asked for that, once everything that was under way
  /// has arrived.
  void save_as_it_stands(node::Node& node, CommandServer& server);
  /// Looks at worlds that were saved in a pause before their state was confirmed. `back_to`: the state that all have
  /// gone back to; later states are computed again, so saves of them are void.
  void look_at_doubtful(const node::Node& node, std::optional<core::Step> back_to);
  /// Orders the regular saves (--save-every). Only the lead calls this. `first`: the state that the run began with.
  void save_regularly(node::Node& node, core::Step first);

  /// Applies what the nodes' statuses contain about their parts.
  void receive(const std::map<core::RegionId, messages::SeenStatus>& statuses);
  /// Replies to the clients whose parts have been written. Every node replies for its own part.
  void reply(CommandServer& server);
  /// Returns when everything is written. `is_over`: the run has come to its end, so states kept on disk for it are of
  /// no use; if there is a launcher, it removes them.
  void conclude(CommandServer& server, const std::map<core::RegionId, messages::SeenStatus>& statuses, bool is_over);

  /// This node's part with what a reader has to know of it.
  cut::SavedWorld as_saved(core::WorldCut part) const;
  /// The run that saved worlds have to belong to, and the folders of this host where they are looked for.
  cut::SavedBy saved_by() const;
  std::vector<std::filesystem::path> folders() const;
  const cut::SaveLedger& ledger() const { return writer_.ledger(); }
  bool regular_ones_failed() const { return writer_.regular_ones_failed(); }
  /// Messages for users since the last call. They have been logged.
  std::vector<std::string> take_words() { return std::exchange(words_, {}); }

 private:
  cut::SaveOf save_of() const;
  core::Step kept_every() const;
  void keep_on_disk(const core::WorldCut& part, CommandServer& server);
  void keep_checkpoints(Checkpoints& checkpoints, records::Recorder* recorder);
  void report(std::string words);

  const config::Launch& launch_;
  const NodeOptions& options_;
  cut::PartWriter writer_;
  std::uint64_t start_ = 0;
  core::Generation generation_ = 0;
  std::vector<std::uint64_t> runs_;     ///< numbers of this run and of those that it goes on from
  std::vector<StandingSave> standing_;  ///< saves asked for in a pause and not written yet
  std::vector<StandingSave> doubtful_;  ///< saves written whose states a redo may still make void
  core::Step saved_last_ = 0;           ///< state of the last regular save; only the lead uses it
  core::Step checkpoint_ = 0;           ///< the last state that the node was asked to keep
  core::Step recorded_ = 0;
  core::Step secured_ = 0;  ///< records up to this state are on disk
  bool left_out_reported_ = false;
  std::vector<std::string> words_;
};

}  // namespace aurasim::process
