#include "cli/part_finder.h"

#include <chrono>

namespace aurasim::cli {

const PartFinder::Parts* PartFinder::parts_of(std::uint64_t hash,
                                              const std::shared_ptr<const core::TriangleMesh>& mesh) {
  auto& parts = found_[hash];
  if (!parts.valid()) {
    parts = std::async(std::launch::async, [mesh] { return config::decompose(*mesh); }).share();
  }
  return parts.wait_for(std::chrono::seconds(0)) == std::future_status::ready ? &parts.get() : nullptr;
}

}  // namespace aurasim::cli
