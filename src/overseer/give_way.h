#pragma once

namespace aurasim::overseer {

/// Makes the calling thread give way where processors are short: whatever pages do, nodes on this host go first.
void give_way();

}  // namespace aurasim::overseer
