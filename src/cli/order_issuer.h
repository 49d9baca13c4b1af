// Turns commands of clients (core/command.h) into orders (core/order.h), on the one node that leads: looks whether they
// can be done, gives new bodies and statics their ids and clients' shapes their indices. No DDS in here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/command.h"
#include "node/node.h"

namespace aurasim::cli {

/// What has become of a command. One of the two:
struct Issued {
  std::string refused;  ///< why
  std::optional<core::Order> order;
  std::optional<core::ObjectRef> object;  ///< the new body or static
};

/// Of the whole run, beyond what a node knows.
struct RunFacts {
  bool complete = true;  ///< no node has died
  std::uint64_t bodies = 0;
};

class OrderIssuer {
 public:
  /// The launch is that of the run as it is now, also after it has changed. It outlives the issuer.
  explicit OrderIssuer(const config::Launch& launch) : launch_(launch) {}

  void begin_generation();
  /// Orders as they come, in sequence: also those of who has led before.
  void note(const core::Order& order);
  /// The run goes on after a change.
  void reopen() { closed_ = false; }

  /// `meshes`: those that clients have brought. Not for rays and rates, which are no orders.
  Issued issue(const core::Command& command, const RunFacts& run, const node::MeshSource& meshes, node::Node& node);

 private:
  Issued spawn(const core::Command& command, const core::NewBody& body, node::Node& node);
  Issued place(const core::Command& command, const core::NewStatic& fixed, node::Node& node);
  Issued move(const core::Command& command, const core::SendStatic& sent, node::Node& node);
  std::uint32_t shape_index(const core::ClientShape& shape, std::uint64_t request, node::Node& node);
  core::PrototypeId prototype_id(const core::NewBody& body, std::uint64_t request, node::Node& node);
  std::optional<core::Shape> shape_of(const core::ClientShape& shape, const node::MeshSource& meshes,
                                      const core::Scene& scene) const;

  const config::Launch& launch_;
  bool closed_ = false;  ///< until the run has changed: an order that not all have received would be forgotten
  // Orders under way are not in the scene yet: the lead counts ahead.
  std::size_t shapes_ = 0, prototypes_ = 0, statics_ = 0;
  std::uint64_t bodies_ =
      0;  ///< whatever else was ordered in between: the same bodies have the same numbers in every run
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
  std::size_t noted_shapes_ = 0, noted_kinds_ = 0;
};

/// The mesh that a command brings a shape by, if it does.
const core::MeshRef* mesh_in(const core::Ask& ask);

}  // namespace aurasim::cli
