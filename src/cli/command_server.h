// Where a node takes commands of clients (core/command.h). Every node answers rays; one node, the lead, looks whether
// the rest can be done and turns it into orders (core/order.h).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/order_issuer.h"
#include "cli/saved_world.h"
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
  /// Nodes that are alive and have not said that they have this mesh.
  std::function<std::vector<core::RegionId>(std::uint64_t hash)> lacking;
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
  void take_over(node::Node& node, core::Generation generation);
  void tell_again(const core::Order& order, const node::Node& node);
  void refuse(std::uint64_t request, std::string why);
  bool is_everywhere(std::uint64_t hash, const Asked& asked, const RunView& run);
  void wait_for_mesh(Asked asked, const core::MeshRef& mesh, const RunView& run);
  void publish_additions(const node::StepReport& report);
  std::string problem_with_world(const core::Ask& ask) const;
  std::optional<core::Shape> make_mesh(const core::MeshRef& mesh);

  const config::Launch& launch_;
  core::RegionId region_;
  std::filesystem::path saves_;
  dds::CommandServerEndpoint endpoint_;
  OrderIssuer issuer_;
  dds::MeshReader mesh_reader_;
  dds::SceneAdditionsWriter additions_writer_;
  dds::SceneAdditions additions_;
  bool leads_ = false;
  std::vector<Asked> waiting_for_mesh_;
  std::map<std::uint64_t, Due> due_;     ///< requests to report as done at their step
  std::vector<std::uint64_t> not_kept_;  ///< requests of orders about the run as a whole
  std::optional<double> wanted_rate_;
  core::Step decided_at_ = -1;
  std::size_t decided_ = 0;  ///< commands in that state
};

}  // namespace aurasim::cli
