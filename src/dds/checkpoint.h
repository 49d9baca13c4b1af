// What the topic checkpoint says.
#pragma once

#include <cstdint>
#include <string>

#include "core/ids.h"

namespace aurasim::dds {

struct Checkpoint {
  enum class Kind : std::uint8_t {
    kToKeep,  ///< for the region that keeps it
    kGoBack,  ///< for all
    kOrders,  ///< for all: what its region knows by now of later states, without bodies
  };

  core::RegionId source{};  ///< whose part it is
  Kind kind = Kind::kToKeep;
  core::Generation generation = 0;  ///< kToKeep: the era; otherwise the generation that will begin with it
  core::Step step = 0;
  std::string octets;  ///< as in a file (cut/cut_file.h)
};

}  // namespace aurasim::dds
