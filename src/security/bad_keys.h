#pragma once

#include <stdexcept>

namespace aurasim::security {

/// Keys that are missing, wrong, or not to be trusted. what() names the file and what is allowed.
class BadKeys : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace aurasim::security
