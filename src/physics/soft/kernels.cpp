#include "physics/soft/lanes.h"

namespace aurasim::physics::soft {

namespace {

Kernel fastest() {
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) return kernel_avx512();
  if (__builtin_cpu_supports("avx2")) return kernel_avx2();
  return kernel_sse2();
}

}  // namespace

const Kernel& kernel() {
  static const Kernel of_this_machine = fastest();
  return of_this_machine;
}

}  // namespace aurasim::physics::soft
