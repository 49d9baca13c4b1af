// Whom a node of a launch listens to: everybody of whom it may have to know.
#include <gtest/gtest.h>

#include "setup/launch_setup.h"

namespace aurasim::setup {
namespace {

class ListeningDistance : public ::testing::TestWithParam<int> {
 protected:
  ListeningDistance() {
    launch_.time.lookahead = GetParam();
    launch_.scene.shapes = {{"ball", core::Sphere{kRadius_m}}};
    launch_.scene.prototypes.resize(1);
  }

  static constexpr double kRadius_m = 0.5;
  config::Launch launch_;
};

/// A region counts as one hop, and the way home as another one: a body projects 3 K states ahead, to where others may
/// come in 2 K.
TEST_P(ListeningDistance, ReachesAsFarAsBodiesProject) {
  const double k = GetParam();
  const double way = (1 + launch_.uncertainty()) * 5 * k * launch_.step_s() * launch_.tolerances.speed_m_s;
  const double fall_s = 3 * k * launch_.step_s();
  const double fall = 0.5 * launch_.scene.gravity.norm() * fall_s * fall_s;
  EXPECT_GE(listening_distance_m(launch_), way + fall + 2 * kRadius_m);
}

TEST_P(ListeningDistance, IsNeverLessThanConfigured) {
  launch_.neighbour_distance_m = 1234;
  EXPECT_EQ(listening_distance_m(launch_), 1234);
}

INSTANTIATE_TEST_SUITE_P(Lookahead, ListeningDistance, ::testing::Values(1, 2, 5));

}  // namespace
}  // namespace aurasim::setup
