#include "physics/soft/lanes.h"

namespace aurasim::physics::soft {

Kernel fastest_kernel() {
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) return kernel_avx512();
  if (__builtin_cpu_supports("avx2")) return kernel_avx2();
  return kernel_sse2();
}

}  // namespace aurasim::physics::soft
