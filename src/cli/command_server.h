// Where a node takes commands of clients (core/command.h). Every node answers rays; one node, the lead, looks whether
// the rest can be done and turns it into orders (core/order.h).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/command.h"
#include "dds/command_bus.h"
#include "dds/scene_additions_bus.h"
#include "node/node.h"

namespace aurasim::cli {

/// What the lead knows of the run when a command comes.
struct RunView {
  bool leads = false;
  bool complete = true;                              ///< no node has died
  std::uint64_t bodies = 0;                          ///< in the whole run
  std::function<bool(std::uint64_t hash)> all_have;  ///< has every node that is alive this mesh?
};

class CommandServer {
 public:
  /// The launch is that of the run as it is now, also after it has changed.
  CommandServer(const config::Launch& launch, dds::Participant& participant, core::RegionId region);

  /// The run has got another map; the scene stays as it has grown.
  void change_map(core::Generation generation, core::Step step);
  /// Serves what has come. Call it between steps.
  void serve(node::Node& node, const RunView& run);
  /// Replies to clients what has taken effect.
  void after_step(const node::StepReport& report);
  /// A new generation: what was under way is not any longer.
  void begin_generation(node::Node& node, core::Generation generation);

  /// Meshes that have come so far, by hash.
  const std::vector<std::uint64_t>& meshes() const { return meshes_; }

 private:
  struct Asked {
    core::Command command;
    int rounds = 0;  ///< that it has waited for its mesh
  };
  void answer(const core::Command& command, const core::Ray& ray, const node::Node& node);
  void decide(const core::Command& command, node::Node& node, const RunView& run);
  void reply_done(std::uint64_t request, core::Step step);
  void reply_all_done(core::Step step);
  void refuse(const core::Command& command, std::string why);
  void accept(const core::Command& command, const core::Order& order, std::optional<core::ObjectRef> object = {});
  void wait_for_mesh(Asked asked);
  bool has_mesh(std::uint64_t hash);
  void spawn(const core::Command& command, const core::NewBody& body, node::Node& node);
  void place(const core::Command& command, const core::NewStatic& fixed, node::Node& node);
  std::uint32_t shape_index(const core::ClientShape& shape, std::uint64_t request, node::Node& node);
  core::PrototypeId prototype_id(const core::NewBody& body, std::uint64_t request, node::Node& node);
  void publish_additions(const node::StepReport& report);
  std::optional<core::Shape> make_shape(const core::ClientShape& shape);
  std::optional<core::Shape> make_mesh(const core::MeshRef& mesh);

  const config::Launch& launch_;
  core::RegionId region_;
  dds::CommandServerEndpoint endpoint_;
  dds::MeshReader mesh_reader_;
  dds::SceneAdditionsWriter additions_writer_;
  dds::SceneAdditions additions_;
  bool leads_ = false;
  std::vector<std::uint64_t> meshes_;
  std::vector<Asked> waiting_for_mesh_;
  std::map<std::uint64_t, core::Step> due_;  ///< requests to report as done at their step
  bool closed_ = false;  ///< until the run has changed: an order that not all have received would be forgotten
  // Orders under way are not in the scene yet: the lead counts ahead.
  std::size_t shapes_ = 0, prototypes_ = 0, statics_ = 0;
  struct OwnShape {
    core::ClientShape shape;
    std::uint32_t index = 0;
  };
  struct OwnKind {
    std::uint32_t shape = 0;
    double mass_kg = 0;
    core::PrototypeId id{};
  };
  std::vector<OwnShape> own_shapes_;
  std::vector<OwnKind> own_kinds_;
};

}  // namespace aurasim::cli
