#pragma once

namespace aurasim::overseer {

/// Lowers the calling thread's priority, so that nodes on this host run first when processors are short, whatever pages
/// do.
void give_way();

}  // namespace aurasim::overseer
