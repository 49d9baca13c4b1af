// A Fast DDS without the check on its own side: it believes that it may do everything, while others get the true
// permissions of its keys.
#pragma once

#include "scratch_store.h"

namespace aurasim::security {

/// For participants that this thread creates while it lives.
class ForgedPermissions {
 public:
  explicit ForgedPermissions(const Member& member);
  ~ForgedPermissions();
  ForgedPermissions(const ForgedPermissions&) = delete;
  ForgedPermissions& operator=(const ForgedPermissions&) = delete;
};

}  // namespace aurasim::security
