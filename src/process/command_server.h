// Receives the commands of clients on a node (core/command.h). Every node answers rays. The lead checks all other
// commands and turns them into orders (core/order.h).
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

#include "config/launch.h"
#include "core/command.h"
#include "cut/part_writer.h"
#include "dds/command_bus.h"
#include "dds/scene_additions_bus.h"
#include "node/node.h"
#include "process/order_issuer.h"

namespace aurasim::process {

/// The lead's knowledge of the run when a command comes.
struct RunView {
  bool leads = false;
  RunFacts facts;
  std::optional<core::Step> holds_at;  ///< the state in which the run pauses; nothing: no pause
  /// Returns the regions whose live nodes have not published that they have this mesh.
  std::function<std::vector<core::RegionId>(std::uint64_t hash)> lacking;
};

/// A world to be saved in the state in which the run is paused.
struct StandingSave {
  std::uint64_t request = 0;
  core::Step step = 0;
  std::string file;
};

class CommandServer {
 public:
  /// `launch`: the run's present launch, also after changes; it must outlive the server. `saves`: the node's folder of
  /// saved worlds.
  CommandServer(const config::Launch& launch, dds::Participant& participant, core::RegionId region,
                std::filesystem::path saves);

  /// To be called when the run has got another map. The scene stays, with its additions.
  void change_map(core::Generation generation, core::Step step);
  /// Serves the commands that have come. To be called between steps.
  void serve(node::Node& node, const RunView& run);
  /// Takes in the meshes of a saved world that the run goes on from.
  void bring(const std::vector<core::SavedMesh>& meshes);
  /// Adds the meshes that the part's orders name, as far as this node has them.
  void add_meshes(core::WorldCut& part);
  /// Replies to clients that this region's part of a saved world is written, or why it is not.
  void reply_saved(const cut::PartWriter::Written& written);
  /// Replies to the clients whose requests have taken effect.
  void after_step(const node::StepReport& report);
  /// Begins a new generation. Orders under way end with the old one, and pending changes of the run are reported as
  /// done.
  void begin_generation(node::Node& node, core::Generation generation);
  /// To be called when the run has gone back to an earlier state. Its orders will be executed again, except orders
  /// about the run as a whole, which are not kept. A client that repeats such a request is served anew.
  void go_back(node::Node& node, core::Generation generation);

  /// Hashes of the meshes that this node has.
  std::vector<std::uint64_t> meshes() { return mesh_reader_.meshes().hashes(); }
  /// The rate that a client has asked for since the last call. Only the lead gets one.
  std::optional<double> take_wanted_rate() { return std::exchange(wanted_rate_, std::nullopt); }
  /// Saves that clients have asked for in a pause, since the last call.
  std::vector<StandingSave> take_standing_saves() { return std::exchange(standing_saves_, {}); }
  /// The state after which the run is to change as a whole. Only the lead knows it.
  std::optional<core::Step> change_at() const { return change_at_; }
  /// A client's request to go back to an earlier state that is kept. Only the lead gets one.
  std::optional<core::Command> take_wanted_back() { return std::exchange(wanted_back_, std::nullopt); }
  /// Answers such a request: all nodes go back to state `step`. load_instead() loads the saved world `file`, and
  /// refuse() replies why it cannot be done.
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
  void reply_accepted(const node::Node& node, const RunView& run);
  void take_over(node::Node& node, core::Generation generation);
  void reply_again(const core::Order& order, const node::Node& node);
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
  std::optional<dds::MeshWriter> mesh_writer_;  ///< made when the first mesh is published
  std::set<std::uint64_t> meshes_published_;
  dds::SceneAdditions additions_;
  bool leads_ = false;
  std::vector<Asked> waiting_for_mesh_;
  std::map<std::uint64_t, Due> due_;  ///< requests to report as done at their step
  /// An order whose effect the client does not wait for. It is acknowledged once other nodes have it, so that it
  /// survives the death of the lead.
  struct Taken {
    core::Step known_at = 0;
    std::chrono::steady_clock::time_point since;
    bool went_back = false;  ///< a node has died meanwhile, and the run has gone back
    core::CommandReply reply;
  };
  std::vector<Taken> taken_;
  std::vector<std::uint64_t> not_kept_;  ///< requests of orders about the run as a whole
  std::optional<double> wanted_rate_;
  std::optional<core::Command> wanted_back_;
  std::optional<core::Step> change_at_;
  std::vector<StandingSave> standing_saves_;
  core::Step decided_at_ = -1;
  std::size_t decided_ = 0;  ///< commands turned into orders in state decided_at_, by weight
};

}  // namespace aurasim::process
