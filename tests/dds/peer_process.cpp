// A region in a process of its own, for tests that kill it. Prints "ready" when it is matched with its neighbour.
//   dds_peer_process DOMAIN REGION NEIGHBOUR run|watched|hang|computes|long_frames [MILLISECONDS]
// run: a batch every 10 ms. watched: likewise, as a process whose silence nobody believes. hang: for the given time
// like run, then its owner never calls again, with a hang limit of 0.5 s. computes: like hang, but its owner gets on
// with a computation. long_frames: a batch every 2.5 s. In all modes it publishes a status now and then.
#include <iostream>
#include <string>

#include <unistd.h>

#include "core/progress.h"
#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::dds::testing {
namespace {

struct Arguments {
  std::uint32_t domain;
  std::uint32_t region;
  std::uint32_t neighbour;
  std::string mode;
  std::chrono::milliseconds time;
};

void take_part(const Arguments& arguments) {
  Settings settings = settings_for(arguments.domain);
  const bool calls_no_more = arguments.mode == "hang" || arguments.mode == "computes";
  if (calls_no_more) {
    settings.hang_limit = 500ms;
  }
  settings.believes_silence = arguments.mode != "watched";
  Peer peer(settings, arguments.region, {arguments.neighbour});
  ControlSettings control_settings;
  control_settings.region = peer.region();
  ControlBus control(peer.participant, control_settings);
  peer.transport.wait_until_matched(kDeadline);
  std::cout << "ready" << std::endl;

  const auto frame = arguments.mode == "long_frames" ? 2500ms : 10ms;
  const auto start = std::chrono::steady_clock::now();
  for (core::Step step = 0;; ++step) {
    peer.send_batch(step);
    peer.transport.take(peer.inbox);
    messages::Status status = messages::testing::status_of(arguments.region);
    status.step = step;
    status.pid = static_cast<std::uint32_t>(::getpid());
    control.publish_status(status);
    if (calls_no_more && std::chrono::steady_clock::now() - start > arguments.time) {
      while (arguments.mode == "computes") {
        core::Progress::mark();
        std::this_thread::sleep_for(50ms);
      }
      std::this_thread::sleep_for(1h);
    }
    std::this_thread::sleep_for(frame);
  }
}

}  // namespace
}  // namespace aurasim::dds::testing

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "usage: dds_peer_process DOMAIN REGION NEIGHBOUR MODE [MILLISECONDS]\n";
    return 2;
  }
  const auto number = [&](int i) { return static_cast<std::uint32_t>(std::stoul(argv[i])); };
  try {
    aurasim::dds::testing::take_part(
        {number(1), number(2), number(3), argv[4], std::chrono::milliseconds(argc > 5 ? number(5) : 0)});
  } catch (const std::exception& error) {
    std::cerr << "dds_peer_process: " << error.what() << '\n';
    return 1;
  }
}
