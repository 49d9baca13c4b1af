#include "physics/soft/kernel.h"

namespace aurasim::physics::soft {

Kernel kernel_avx512() { return kThis; }

}  // namespace aurasim::physics::soft
