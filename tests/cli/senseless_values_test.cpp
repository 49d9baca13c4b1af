// Every number of a scene and a launch file in turn, with values that are valid in form and senseless: the file is
// refused with the place of the number, or the world is sound after its first states.
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "config/workspace.h"
#include "node/node.h"
#include "setup/launch_setup.h"
#include "setup/scene_warnings.h"
#include "transport/memory_transport.h"

namespace aurasim::cli {
namespace {

/// A bit of everything that has numbers.
constexpr const char* kScene = R"(gravity: [0, 0, -9.81]
layout: launch
materials:
  rough: {friction: 0.8, rolling_friction: 0.01, spinning_friction: 0.01, restitution: 0.2, linear_damping: 0.1, angular_damping: 0.1}
shapes:
  ball: {sphere: {radius: 0.5}}
  brick: {box: {size: [1, 0.5, 0.4]}}
  pill: {capsule: {radius: 0.2, height: 0.5}}
  tall: {capsule: {radius: 0.2, total_height: 0.9}}
  can: {cylinder: {radius: 0.3, height: 0.6}}
  wedge: {convex_hull: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}}
  dumbbell: {compound: {parts: [{sphere: {radius: 0.3}, position: [0.5, 0, 0]}, {box: {size: [0.4, 0.4, 0.4]}, position: [-0.5, 0, 0], orientation: {rpy_deg: [0, 45, 0]}}]}}
prototypes:
  ball: {shape: ball, mass: 1, material: rough}
  brick: {shape: brick, mass: 2, inertia: [0.1, 0.2, 0.2]}
  pill: {shape: pill, mass: 1}
  tall: {shape: tall, mass: 1}
  can: {shape: can, mass: 1}
  wedge: {shape: wedge, mass: 1}
  dumbbell: {shape: dumbbell, mass: 3}
statics:
  - {name: ground, shape: {plane: {normal: [0, 0, 1], offset: 0}}, material: rough}
  - {name: hills, shape: {heightfield: {cell: [1, 1], heights: [[0, 0.1, 0], [0.1, 0.2, 0.1], [0, 0.1, 0]]}}, position: [60, 60, 0]}
  - {name: lift, shape: brick, position: [30, 0, 5], path: {stops: [{at: 2, position: [0, 0, 1]}, {at: 4}], repeats: true}}
  - {name: band, shape: brick, position: [34, 0, 1], belt: [0.5, 0, 0]}
bodies:
  - {prototype: ball, id: 7, position: [0, 0, 0.5], velocity: [1, 0, 0], spin: [0, 2, 0]}
  - {prototype: brick, name: a, position: [4, 0, 2], orientation: {quaternion: [1, 0, 0, 0.1]}}
  - {prototype: brick, name: b, position: [6, 0, 2]}
  - {prototype: brick, name: c, position: [8, 0, 2]}
  - {prototype: can, name: d, position: [10, 0, 2]}
  - {prototype: pill, name: e, position: [12, 0, 2]}
  - {prototype: tall, position: [14, 0, 0.45]}
  - {prototype: wedge, position: [16, 0, 0.1]}
  - {prototype: dumbbell, position: [18, 0, 1]}
joints:
  - {hinge: {axis: [0, 0, 1], limits_deg: [-90, 90], drive: {position_deg: 10, speed: 1, stiffness: 5, damping: 1, effort: 2, max_effort: 100}, stiffness: 1, rest_deg: 5, damping: 0.1, friction: 0.1}, bodies: [a], position: [4.5, 0, 2]}
  - {slider: {axis: [1, 0, 0], limits: [-1, 1], drive: {position: 0.1, speed: 1, stiffness: 5, damping: 1, effort: 2, max_effort: 100}, stiffness: 1, rest: 0.1, damping: 0.1, friction: 0.1}, bodies: [b]}
  - {ball: {damping: 0.1}, bodies: [c, b], position: [7, 0, 2], break_impulse: 100}
  - {spring: {x: {limits: [-1, 1], stiffness: 10, rest: 0.1, damping: 1}, rz: {limits_deg: [-10, 10], stiffness: 10, rest_deg: 1, damping: 1}}, bodies: [d]}
  - {hinge: {axis: [0, 1, 0], motor: {speed: 3, max_impulse: 1}}, bodies: [e]}
generators:
  - stack: {prototype: brick, count: 3, position: [0, 20, 0], yaw_deg: 30, velocity: [0, 0, 0.1], spin: [0, 0, 0.1]}
  - wall: {prototype: brick, rows: 2, columns: 3, gap: 0.1, position: [0, 24, 0]}
  - block: {prototype: ball, counts: [2, 2, 2], spacing: [1.1, 1.1, 1.1], position: [0, 28, 0]}
  - chain: {prototype: pill, count: 3, step: [0, 0, 1], position: [0, 32, 3], anchor: last}
injectors:
  - {name: rain, seed: 3, count: 20, rate: 1000, start: 0.01, prototypes: [ball], volume: {center: [-20, 0, 9], size: [10, 10, 4]}, velocity: {min: [-1, -1, 0], max: [1, 1, 2]}}
  - {name: shower, count: 8, rate: 1000, prototypes: [ball], per: {regions: {size: [10, 10, 4], height: 20}}}
)";

constexpr const char* kLaunchFile = R"(scene: scene.yaml
regions: {layout: columns, count: 1, width: 80}
time: {step_hz: 60, substeps: 4, lookahead: 2}
tolerances: {speed: 32, latency: 0.016, frame: 0.016}
aura: {uncertainty: 0.5}
physics: {iterations: 10, friction_directions: 2, erp: 0.2, threads: 1}
dds: {domain: 3, impair: {delay: 0.01, jitter: 0.001, loss: 0.1, bandwidth: 1000000, seed: 4}}
survival: {checkpoint: 1, patience: 10}
observe: {tick_hz: 20}
control: {silence: 0.5}
ros2: {domain: 4, tf_hz: 50}
overseer: {port: 8080}
)";

constexpr std::array kSenseless = {"1e-320", "1e-20", "-0", "0x10", "1e6", "1e7", "-1e7", "1e308"};

struct Number {
  std::size_t at = 0, size = 0;
  std::size_t line = 0, column = 0;  ///< from 1
};

/// Those that are values, not parts of words.
std::vector<Number> numbers_in(const std::string& text) {
  std::vector<Number> numbers;
  std::size_t line = 1, line_begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') ++line, line_begin = i + 1;
    const bool begins = std::isdigit(static_cast<unsigned char>(text[i])) != 0 ||
                        (text[i] == '-' && std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0);
    if (!begins || (text[i - 1] != ' ' && text[i - 1] != '[')) continue;
    const std::size_t size = text.find_first_of(",]}\n", i) - i;
    numbers.push_back({i, size, line, i - line_begin + 1});
    i += size - 1;
  }
  return numbers;
}

class SenselessValues : public testing::Test {
 protected:
  /// What is wrong after some states with a launch that was read; empty: nothing.
  static std::string fault_of(const config::Launch& launch) {
    constexpr core::Step kStates = 3;
    transport::MemoryNetwork network(std::vector<std::vector<core::RegionId>>(1), {}, 1);
    node::NodeSetup setup = setup::node_setup(launch, core::RegionId{0}, 0);
    node::Node node(setup, launch.scene, launch.regions, network.endpoint(core::RegionId{0}));
    std::string fault;
    const auto look = [&] {
      for (const physics::Removal& removal : node.report().removals) {
        if (!removal.fault.empty()) fault = fmt::format("body {}: {}", core::value_of(removal.body), removal.fault);
      }
      for (const core::BodyState& body : node.world().snapshot().bodies) {
        const bool is_sound = body.pose.p_WB.allFinite() && body.pose.q_WB.coeffs().allFinite() &&
                              body.v_WB.allFinite() && body.w_WB.allFinite();
        if (!is_sound) fault = fmt::format("body {} is not finite", core::value_of(body.id));
      }
    };
    node.start();
    look();
    while (node.current_step() < kStates && fault.empty()) {
      if (!node.ready()) return "it waits for nobody";
      node.step();
      look();
    }
    return fault;
  }

  /// `text` with each of its numbers replaced by each value; the other file as it is.
  void expect_refused_or_sound(const std::string& scene, const std::string& launch, bool of_scene) {
    const std::string& text = of_scene ? scene : launch;
    workspace_.write("scene.yaml", scene);
    const auto file = workspace_.write("launch.yaml", launch);
    ASSERT_EQ(fault_of(config::read_launch(file)), "") << "as it is";
    int refused = 0, sound = 0, elsewhere = 0;
    for (const Number& number : numbers_in(text)) {
      for (const char* value : kSenseless) {
        std::string changed = text;
        changed.replace(number.at, number.size, value);
        workspace_.write(of_scene ? "scene.yaml" : "launch.yaml", changed);
        const std::string what = fmt::format("{}:{}:{}: {} for {}", of_scene ? "scene.yaml" : "launch.yaml",
                                             number.line, number.column, value, text.substr(number.at, number.size));
        try {
          const config::Launch read = config::read_launch(file);
          const std::string fault = fault_of(read);
          EXPECT_TRUE(fault.empty() || !setup::scene_warnings(read).empty()) << what << ": " << fault;
          ++sound;
        } catch (const config::BadConfig& bad) {
          ++refused;
          const std::string file_name = of_scene ? "scene.yaml" : "launch.yaml";
          const std::string line = fmt::format("{}:{}:", file_name, number.line);
          EXPECT_THAT(bad.errors().front(), testing::ContainsRegex(file_name + ":[0-9]+:[0-9]+: ")) << what;
          elsewhere += bad.errors().front().find(line) == std::string::npos;
        }
      }
    }
    std::printf("%d refused, %d of them in another line; %d sound\n", refused, elsewhere, sound);
    EXPECT_LT(elsewhere, refused / 50) << "sizes that make a generator's rows too long";
    EXPECT_GT(refused, 0);
    EXPECT_GT(sound, 0);
  }

  config::Workspace workspace_;
};

TEST_F(SenselessValues, InASceneAreRefusedOrBorne) { expect_refused_or_sound(kScene, kLaunchFile, true); }

TEST_F(SenselessValues, InALaunchFileAreRefusedOrBorne) { expect_refused_or_sound(kScene, kLaunchFile, false); }

}  // namespace
}  // namespace aurasim::cli
