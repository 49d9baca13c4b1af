// Where a node takes commands of clients (core/command.h). Every node answers rays; one node, the lead, looks whether
// the rest can be done and turns it into orders (core/order.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/order_issuer.h"
#include "cli/part_writer.h"
#include "config/launch.h"
#include "core/command.h"
#include "dds/command_bus.h"
#include "dds/scene_additions_bus.h"
#include "node/node.h"

namespace aurasim::cli {

/// What the lead knows of the run when a command comes.
struct RunView {
  bool leads = false;
  RunFacts facts;
  std::optional<core::Step> holds_at;  ///< a pause: once this state is computed, no other is
  /// Nodes that are alive and have not said that they have this mesh.
  std::function<std::vector<core::RegionId>(std::uint64_t hash)> lacking;
};

/// A world that is to be saved in the state in which the run stands.
struct StandingSave {
  std::uint64_t request = 0;
  core::Step step = 0;
  std::string file;
};

class CommandServer {
 public:
  /// The launch is that of the run as it is now, also after it has changed.
  /// `saves`: its node's folder of saved worlds.
  CommandServer(const config::Launch& launch, dds::Participant& participant, core::RegionId region,
                std::filesystem::path saves);

  /// The run has got another map; the scene stays as it has grown.
  void change_map(core::Generation generation, core::Step step);
  /// Serves what has come. Call it between steps.
  void serve(node::Node& node, const RunView& run);
  /// Meshes of a saved world that the run goes on from.
  void bring(const std::vector<core::SavedMesh>& meshes);
  /// Gives a part of the world the meshes that its orders name, as far as they are here.
  void add_meshes(core::WorldCut& part);
  /// This region's part of a saved world is written, or is not.
  void reply_saved(const PartWriter::Written& written);
  /// Replies to clients what has taken effect.
  void after_step(const node::StepReport& report);
  /// A new generation: what was under way is not any longer.
  void begin_generation(node::Node& node, core::Generation generation);
  /// The run has gone back to an earlier state: what was ordered will be done again, but for orders about the run as a
  /// whole, which are not kept; whoever still asks for those is heard anew.
  void go_back(node::Node& node, core::Generation generation);

  /// Meshes that are here, by hash.
  std::vector<std::uint64_t> meshes() { return mesh_reader_.meshes().hashes(); }
  /// The rate that somebody has asked for since the last call; only on the lead.
  std::optional<double> take_wanted_rate() { return std::exchange(wanted_rate_, std::nullopt); }
  /// Asked for in a pause since the last call.
  std::vector<StandingSave> take_standing_saves() { return std::exchange(standing_saves_, {}); }
  /// On the lead: the state after which the run is to change as a whole.
  std::optional<core::Step> change_at() const { return change_at_; }
  /// On the lead: somebody has asked to go back to an earlier state, whichever is kept.
  std::optional<core::Command> take_wanted_back() { return std::exchange(wanted_back_, std::nullopt); }
  /// The answer to that: all go back to that state, or to the saved world of that name, or cannot.
  void go_back_to(const core::Command& back, core::Step step);
  void load_instead(core::Command back, std::string file, node::Node& node, const RunView& run);
  void refuse(std::uint64_t request, std::string why);

 private:
  using Clock = std::chrono::steady_clock;
  struct Asked {
    core::Command command;
    Clock::time_point since;
  };
  struct Due {
    core::Step step = 0;
    std::optional<core::ObjectRef> object;
  };
  void answer(const core::Command& command, const core::Ray& ray, const node::Node& node);
  void decide(const core::Command& command, node::Node& node, const RunView& run);
  void take_rate(const core::Command& command, const core::SetRate& ask, const node::Node& node);
  void reply_done(std::uint64_t request, core::Step step, std::optional<core::ObjectRef> object = {});
  void reply_all_done(core::Step step);
  void tell_what_is_taken(const node::Node& node, const RunView& run);
  void take_over(node::Node& node, core::Generation generation);
  void tell_again(const core::Order& order, const node::Node& node);
  bool comes_after_the_pause(const core::Command& command, const node::Node& node, const RunView& run) const;
  void save_as_it_stands(const core::Command& command, const core::Save& ask, const node::Node& node,
                         const RunView& run);
  bool is_everywhere(std::uint64_t hash, const Asked& asked, const RunView& run);
  void wait_for_mesh(Asked asked, const core::MeshRef& mesh, const RunView& run);
  void publish_additions(const node::StepReport& report);
  void send_additions();
  std::string problem_with_world(const core::Ask& ask) const;
  std::optional<core::Shape> make_mesh(const core::MeshRef& mesh);

  const config::Launch& launch_;
  core::RegionId region_;
  std::filesystem::path saves_;
  dds::CommandServerEndpoint endpoint_;
  OrderIssuer issuer_;
  dds::MeshReader mesh_reader_;
  dds::Participant& participant_;
  dds::SceneAdditionsWriter additions_writer_;
  std::optional<dds::MeshWriter> mesh_writer_;  ///< once there is something to tell
  std::set<std::uint64_t> meshes_told_;
  dds::SceneAdditions additions_;
  bool leads_ = false;
  std::vector<Asked> waiting_for_mesh_;
  std::map<std::uint64_t, Due> due_;  ///< requests to report as done at their step
  /// An order that nobody waits for to show: it is told to be taken once others know it, too, whoever dies then.
  struct Taken {
    core::Step known_at = 0;
    std::chrono::steady_clock::time_point since;
    bool went_back = false;  ///< others have died meanwhile
    core::CommandReply reply;
  };
  std::vector<Taken> taken_;
  std::vector<std::uint64_t> not_kept_;  ///< requests of orders about the run as a whole
  std::optional<double> wanted_rate_;
  std::optional<core::Command> wanted_back_;
  std::optional<core::Step> change_at_;
  std::vector<StandingSave> standing_saves_;
  core::Step decided_at_ = -1;
  std::size_t decided_ = 0;  ///< commands in that state
};

}  // namespace aurasim::cli
