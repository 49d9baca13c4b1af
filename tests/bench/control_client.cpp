// Steers bodies of a run that goes on, 60 times a second, for scripts/control_cost.py:
//   control_client FILE DOMAIN BODIES TORQUE SECONDS
// A torque of about TORQUE N m on each of the first BODIES bodies. Prints what the nodes have counted, as JSON.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <aurasim/client.h>

using namespace aurasim::client;

namespace {

Control torques(const std::vector<std::uint64_t>& ids, double size, int tick) {
  Control control;
  control.torques.bodies = ids;
  for (const std::uint64_t id : ids) {
    const double phase = 0.7 * static_cast<double>(id) + 0.05 * tick;
    control.torques.values.insert(control.torques.values.end(),
                                  {size * std::sin(phase), size * std::cos(phase), 0.2 * size});
  }
  return control;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  const std::size_t wanted = std::strtoul(argv[3], nullptr, 10);
  const double torque = std::strtod(argv[4], nullptr), seconds = std::strtod(argv[5], nullptr);
  try {
    World world =
        World::connect(argv[1], {.overrides = {"dds.domain=" + std::string(argv[2])}, .time_out = Seconds(60)});
    std::vector<std::uint64_t> ids = world.bodies().ids;
    if (ids.size() > wanted) ids.resize(wanted);
    auto next = std::chrono::steady_clock::now();
    const auto end = next + std::chrono::duration_cast<std::chrono::nanoseconds>(Seconds(seconds));
    int ticks = 0;
    for (; next < end; next += std::chrono::nanoseconds(16'666'667), ++ticks) {
      std::this_thread::sleep_until(next);
      world.control(torques(ids, torque, ticks));
    }
    std::uint64_t heard = 0, late = 0, refused = 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    for (const NodeStatus& node : world.nodes()) {
      heard += node.setpoints_heard, late += node.setpoints_late, refused += node.setpoints_refused;
    }
    std::printf("{\"bodies\": %zu, \"ticks\": %d, \"heard\": %lu, \"late\": %lu, \"refused\": %lu}\n", ids.size(),
                ticks, static_cast<unsigned long>(heard), static_cast<unsigned long>(late),
                static_cast<unsigned long>(refused));
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
