// Takes meshes apart into convex parts, each mesh once, on threads beside the caller's.
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <variant>

#include "core/scene.h"

namespace aurasim::overseer {

/// May be used by one thread. The destructor waits for the work under way.
class PartFinder {
 public:
  using Parts = std::variant<core::TriangleMesh, std::string>;

  /// The mesh's parts, or the reason why there are none. Null while they are being computed. `hash`: hash of the mesh.
  /// The result is valid until the next call.
  const Parts* parts_of(std::uint64_t hash, const std::shared_ptr<const core::TriangleMesh>& mesh);

 private:
  std::map<std::uint64_t, std::shared_future<Parts>> found_;
};

}  // namespace aurasim::overseer
