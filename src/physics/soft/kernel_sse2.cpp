#include "physics/soft/kernel.h"

namespace aurasim::physics::soft {

Kernel kernel_sse2() { return kThis; }

}  // namespace aurasim::physics::soft
