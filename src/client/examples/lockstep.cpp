// A ball falls onto the demo's stacks, on four nodes, state by state; and is thrown up again.
//   lockstep [DDS_DOMAIN]
#include <algorithm>
#include <cstdio>
#include <string>

#include <aurasim/client.h>

using aurasim::client::Bodies;
using aurasim::client::Shape;
using aurasim::client::World;

namespace {

std::size_t row_of(const Bodies& bodies, std::uint64_t id) {
  return std::lower_bound(bodies.ids.begin(), bodies.ids.end(), id) - bodies.ids.begin();
}

void run(const std::string& domain) {
  World world = World::launch("demo", {.overrides = {"dds.domain=" + domain}, .paused = true});
  const auto info = world.info();
  std::printf("%s: %zu regions, %zu bodies\n", info.scene.c_str(), info.regions.size(), world.bodies().size());

  const auto ball = world.spawn({.shape = Shape::sphere(0.5), .mass_kg = 20, .position = {0.5, 0.5, 6}});
  Bodies bodies = world.step(ball.step - world.bodies().step);  // to the first state that contains the ball
  while (bodies.step < ball.step + 60) {
    bodies = world.step();
    const std::size_t row = row_of(bodies, *ball.body);
    if (bodies.step % 10 != 0) continue;
    const double* const p = &bodies.positions[3 * row];
    std::printf("state %ld: region %u, x %.2f y %.2f z %.2f\n", static_cast<long>(bodies.step), bodies.regions[row],
                p[0], p[1], p[2]);
  }

  const auto thrown = world.set_velocity(*ball.body, {0, 0, 8});
  bodies = world.step(thrown.step - bodies.step);
  std::printf("state %ld: thrown up at %.1f m/s\n", static_cast<long>(bodies.step),
              bodies.linear_velocities[3 * row_of(bodies, *ball.body) + 2]);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc > 1 ? argv[1] : "0");
    return 0;
  } catch (const aurasim::client::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
