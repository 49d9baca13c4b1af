// Takes meshes apart into convex parts, each once, beside the thread that asks.
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <variant>

#include "core/scene.h"

namespace aurasim::cli {

/// Used by one thread. Its end waits for what is under way.
class PartFinder {
 public:
  using Parts = std::variant<core::TriangleMesh, std::string>;

  /// The mesh's parts or why there are none; null while they are being found. `hash`: of the mesh. Valid until the next
  /// call.
  const Parts* parts_of(std::uint64_t hash, const std::shared_ptr<const core::TriangleMesh>& mesh);

 private:
  std::map<std::uint64_t, std::shared_future<Parts>> found_;
};

}  // namespace aurasim::cli
