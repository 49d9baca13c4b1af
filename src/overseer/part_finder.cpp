#include "overseer/part_finder.h"

#include <chrono>

#include "overseer/mesh_process.h"

namespace aurasim::overseer {
namespace {

constexpr std::size_t kMostKept = 64;
constexpr std::chrono::seconds kLimit{60};

}  // namespace

const PartFinder::Parts* PartFinder::parts_of(std::uint64_t hash,
                                              const std::shared_ptr<const core::TriangleMesh>& mesh) {
  const auto is_found = [](const auto& parts) {
    return parts.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  if (!found_.contains(hash) && found_.size() >= kMostKept)
    std::erase_if(found_, [&](const auto& entry) { return is_found(entry.second); });
  auto& parts = found_[hash];
  if (!parts.valid()) {
    const MeshProcess process{.limit = kLimit};
    parts = std::async(std::launch::async, [mesh, process] { return process.decompose(*mesh); }).share();
  }
  return is_found(parts) ? &parts.get() : nullptr;
}

}  // namespace aurasim::overseer
