// Content of a message on topic checkpoint.
#pragma once

#include <cstdint>
#include <string>

#include "core/ids.h"

namespace aurasim::messages {

struct Checkpoint {
  enum class Kind : std::uint8_t {
    kToKeep,  ///< a part for its keeper to keep; sent to that region only
    kGoBack,  ///< a part to go back to, in a recovery; sent to all nodes
    kOrders,  ///< sent to all nodes: the orders for later states that the source knows by now, without bodies
  };

  core::RegionId source{};  ///< region whose part of the world this is
  Kind kind = Kind::kToKeep;
  core::Generation generation = 0;  ///< kToKeep: the era; otherwise the generation that will begin with this part
  core::Step step = 0;
  std::string octets;  ///< encoded as in a cut file (cut/cut_file.h)
};

}  // namespace aurasim::messages
