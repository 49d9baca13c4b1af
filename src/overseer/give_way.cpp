#include "overseer/give_way.h"

#include <cstdint>

#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace aurasim::overseer {
namespace {

constexpr int kNiceness = 10;
/// Time slice of this thread, ns: the shortest that Linux takes. A thread that wakes up waits for the end of the
/// running thread's slice, however nice that one is: 3 ms by default (Linux 6.12 and later; earlier ones ignore this
/// value and do not wait).
constexpr std::uint64_t kSlice_ns = 100'000;

/// sched_setattr(2); glibc has none before 2.41.
struct SchedulingAttributes {
  std::uint32_t size = sizeof(SchedulingAttributes), policy = SCHED_OTHER;
  std::uint64_t flags = 0;
  std::int32_t nice = kNiceness;
  std::uint32_t priority = 0;
  std::uint64_t runtime = kSlice_ns, deadline = 0, period = 0;
};

}  // namespace

void give_way() {
  SchedulingAttributes attributes;
  ::syscall(SYS_sched_setattr, 0, &attributes, 0);  // applies to this thread; if refused, it runs like the others
}

}  // namespace aurasim::overseer
