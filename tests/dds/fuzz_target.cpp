// What guard_fuzz.cpp sends its datagrams to: a participant with all endpoints of a run.
//   dds_fuzz_target DOMAIN
// Prints "ready", then five times a second "alive PASSED REFUSED": only while everything it calls comes back. SIGTERM
// ends it, silently as nodes end.
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "dds/guarding.h"
#include "run_endpoints.h"

namespace {

std::atomic<bool> stop = false;

void run(std::uint32_t domain) {
  using namespace aurasim::dds::testing;
  RunEndpoints endpoints(domain, 0, {1});
  std::cout << "ready" << std::endl;
  for (aurasim::core::Step step = 1; !stop; ++step) {
    endpoints.say(step);
    endpoints.listen();
    if (step % 12 == 0) {
      const auto report = aurasim::dds::guarded(endpoints.peer.participant);
      std::cout << "alive " << report.passed << ' ' << report.total() << std::endl;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(17));
  }
  std::cout << "refused " << aurasim::rtps::text_of(aurasim::dds::guarded(endpoints.peer.participant).refused)
            << std::endl;
  std::_Exit(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::signal(SIGTERM, [](int) { stop = true; });
  run(static_cast<std::uint32_t>(std::stoul(argv[1])));
  return 0;
}
