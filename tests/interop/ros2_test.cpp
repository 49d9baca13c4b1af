// A run speaks ROS 2: heard and driven by a program made with Cyclone DDS that knows ROS's messages only.
#include <cstdlib>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

constexpr const char* kScene = R"(name: ros2
shapes:
  base: {box: {size: [0.6, 0.4, 0.2]}}
  arm: {box: {size: [0.1, 0.1, 1]}}
materials:
  smooth: {friction: 0.1}
prototypes:
  base: {shape: base, mass: 5, material: smooth}
  arm: {shape: arm, mass: 1}
statics:
  - {name: ground, shape: {plane: {}}}
bodies:
  - {prototype: base, name: robot, position: [2, 0, 0.1], orientation: {rpy_deg: [0, 0, 180]}}
  - {prototype: arm, name: arm, position: [8.8, 4, 3.4], orientation: {rpy_deg: [0, 60, 0]}}
  - {prototype: base, position: [-8, -4, 0.1]}
joints:
  - {name: swing, bodies: [arm], position: [8, 4, 4], hinge: {axis: [0, 1, 0]}}
)";

constexpr const char* kLaunch = R"(scene: scene.yaml
regions: {layout: columns, count: 2, width: 12}
ros2: {cmd_vel: [robot]}
)";

class Ros2 : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("CYCLONEDDS_URI",
             "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/>"
             "</Interfaces><AllowMulticast>true</AllowMulticast></General></Domain></CycloneDDS>",
             1);
    write("scene.yaml", kScene);
    launch_ = write("launch.yaml", kLaunch).string();
  }

  /// Runs and is driven; `where`: ROS's domain.
  void expect_driven(const Words& more, std::uint32_t where) {
    Process& run = launch("run", launch_, more);
    ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 2, 1));
    Process& peer = start_program({AURASIM_BINARY_DIR "/cyclone_ros2", std::to_string(where), "2"});
    expect_exit(peer, 0);
    EXPECT_THAT(peer.out(), ::testing::HasSubstr("the robot was driven, and stopped in silence")) << peer.err();
    expect_exit(start(Words{"send", "stop", launch_} + in_own_domain()), 0);
    expect_exit(run, 0);
    expect_all_bodies_accounted_for(report_of("run"));
    EXPECT_THAT(run.err(), ::testing::Not(::testing::HasSubstr("refused")));
  }

  std::string launch_;
};

TEST_F(Ros2, IsHeardAndDrivesARobotFromRegionToRegion) { expect_driven({}, test::own_domain()); }

TEST_F(Ros2, MayHaveADomainOfItsOwn) {
  const std::uint32_t other = test::own_domain(1);
  expect_driven(set({"ros2.domain=" + std::to_string(other)}), other);
}

TEST_F(Ros2, IsNotSpokenWithKeys) {
  std::filesystem::create_directory(folder() / "keys");
  Process& run = launch("run", launch_, set({"dds.security=" + (folder() / "keys").string()}));
  expect_exit(run, 2);
  EXPECT_THAT(run.err(), ::testing::HasSubstr("ROS 2 gets everything unencrypted"));
}

}  // namespace
}  // namespace aurasim::system_test
