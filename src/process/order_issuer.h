// Turns commands of clients (core/command.h) into orders (core/order.h), on the lead. It checks whether they can be
// executed, and gives ids to new bodies and statics and indices to clients' shapes. Uses no DDS.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/command.h"
#include "node/node.h"

namespace aurasim::process {

/// Outcome of a command: either `refused` or `order` is set.
struct Issued {
  std::string refused;  ///< reason of the refusal
  std::optional<core::Order> order;
  std::optional<core::ObjectRef> object;  ///< the new body or static
};

/// Facts of the whole run that a node alone does not know.
struct RunFacts {
  bool complete = true;  ///< no node has died
  std::uint64_t bodies = 0;
};

class OrderIssuer {
 public:
  /// `launch`: the run's present launch, also after changes. It must outlive the issuer.
  explicit OrderIssuer(const config::Launch& launch) : launch_(launch) {}

  void begin_generation();
  /// Notes an order that has been published. To be called for all orders in sequence, also those of former leads.
  void note(const core::Order& order);
  /// To be called when the run goes on after a change.
  void reopen() { closed_ = false; }

  /// Checks `command` and makes its order. `meshes`: those that clients have sent. Precondition: the command is no ray
  /// and no rate, which become no orders.
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
  bool closed_ = false;  ///< until the run has changed: orders that some nodes miss would be lost
  // Counts that include orders under way, which are not in the scene yet.
  std::size_t shapes_ = 0, prototypes_ = 0, statics_ = 0;
  std::uint64_t bodies_ = 0;  ///< counts bodies only, so that the same bodies have the same numbers in every run
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

}  // namespace aurasim::process
