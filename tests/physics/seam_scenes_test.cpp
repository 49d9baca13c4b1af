// Piles on edges and corners of blocks, beside the same in one block.
#include <algorithm>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::Vec3;

constexpr double kSide = 8, kOneBlock = 1e5;
constexpr int kStates = 300;  // 5 s

/// Where the middle of a scene is.
struct Spot {
  const char* name;
  Vec3 p;
};

struct Errors {
  double sunk_m = 0, moved_m = 0;
};

class SeamScenes : public ::testing::TestWithParam<Spot> {
 protected:
  /// A box with its place in a scene around the spot.
  void place_box(const Vec3& half, const Vec3& p, const core::Quat& q = core::Quat::Identity()) {
    const auto known = std::ranges::find(halves_, half) - halves_.begin();
    if (known == std::ssize(halves_)) {
      halves_.push_back(half);
      scene.shapes.push_back({"box " + std::to_string(halves_.size()), core::Box{half}});
      core::Prototype& kind = scene.prototypes.emplace_back();
      kind.shape = static_cast<std::uint32_t>(halves_.size() - 1);
      kind.mass_kg = 8000 * half.prod();
      kind.can_sleep = false;
    }
    core::InitialBody& body = scene.bodies.emplace_back();
    body.id = core::BodyId{scene.bodies.size() - 1};
    body.prototype = core::PrototypeId{static_cast<std::uint32_t>(known)};
    body.pose = {GetParam().p + p, q};
  }

  Errors run_with(double side_m) {
    core::Scene whole = scene;
    core::StaticBody floor;
    floor.shape = static_cast<std::uint32_t>(whole.shapes.size());
    whole.shapes.push_back({"ground", core::Plane{}});
    whole.materials.resize(1);
    whole.statics.push_back(floor);
    Settings settings;
    settings.solver = Solver::kSoftStep;
    settings.substeps = 8;
    settings.block_m = side_m;
    RegionWorld world(whole, settings);
    std::vector<BodyRecord> bodies = initial_records(whole);
    if (side_m == kOneBlock) {
      for (BodyRecord& body : bodies) body.block = {0, 0};
    }
    world.add(bodies);
    run(world, kStates);
    Errors errors;
    blocks_.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Vec3 way = world.records()[i].p_WB - bodies[i].p_WB;
      errors.sunk_m = std::max(errors.sunk_m, -way.z());
      errors.moved_m = std::max(errors.moved_m, way.norm());
      blocks_.push_back(world.records()[i].block);
    }
    std::ranges::sort(blocks_);
    blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
    return errors;
  }

  /// The scene stands, and is at most so much worse than in one block.
  void expect_stands(std::size_t least_blocks) {
    const Errors one = run_with(kOneBlock);
    EXPECT_EQ(blocks_.size(), 1u);
    const Errors many = run_with(kSide);
    EXPECT_GE(blocks_.size(), least_blocks);
    std::cout << GetParam().name << ": sunk " << 1000 * one.sunk_m << " mm in one block, " << 1000 * many.sunk_m
              << " in " << blocks_.size() << "; moved " << 1000 * one.moved_m << ", " << 1000 * many.moved_m << '\n';
    EXPECT_LT(many.moved_m, 0.05);
    EXPECT_LT(many.sunk_m, 1.3 * one.sunk_m + 0.001);
    EXPECT_LT(many.moved_m, 1.5 * one.moved_m + 0.01);
  }

  core::Scene scene;

 private:
  std::vector<Vec3> halves_;
  std::vector<core::Block> blocks_;
};

TEST_P(SeamScenes, AWallStands) {
  const Vec3 brick(0.5, 0.25, 0.25);
  for (int row = 0; row < 8; ++row) {
    for (int i = 0; i < 12 - row; ++i) place_box(brick, {i - 6 + 0.5 * (row + 1), 0, 0.25 + 0.5 * row});
  }
  expect_stands(2);
}

TEST_P(SeamScenes, APyramidStands) {
  const Vec3 cube(0.4, 0.4, 0.4);
  for (int layer = 0; layer < 5; ++layer) {
    for (int i = 0; i < 6 - layer; ++i) {
      for (int k = 0; k < 6 - layer; ++k) {
        place_box(cube, {0.8 * (i - 3) + 0.4 * (layer + 1), 0.8 * (k - 3) + 0.4 * (layer + 1), 0.4 + 0.8 * layer});
      }
    }
  }
  expect_stands(2);
}

/// Three storeys of cards, as in the laboratory (lab/stability/piles.cpp).
TEST_P(SeamScenes, ACardHouseStands) {
  constexpr double kThick = 0.03, kSpan = 0.681, kHalfFoot = 0.161, kOverhang = 0.15, kGap = 0.0005;
  const double lean = 17 * std::numbers::pi / 180;
  const double up = std::cos(lean) + kThick * std::sin(lean), storey = up + kThick + 2 * kGap;
  scene.materials.resize(1);
  scene.materials[0].friction = 0.9;
  for (int level = 0; level < 3; ++level) {
    const int pairs = 3 - level;
    const auto ridge_x = [&](int i) { return kSpan * (i - (pairs - 1) / 2.0); };
    for (int i = 0; i < pairs; ++i) {
      for (const double side : {-1.0, 1.0}) {
        place_box({kThick / 2, 0.35, 0.5}, {ridge_x(i) + side * kHalfFoot, 0, level * storey + up / 2},
                  core::Quat(Eigen::AngleAxisd(-side * lean, Vec3::UnitY())));
      }
      if (i == 0) continue;
      const double left = ridge_x(i - 1) + (i == 1 ? -kOverhang : 2 * kGap);
      const double right = ridge_x(i) + (i == pairs - 1 ? kOverhang : -2 * kGap);
      place_box({(right - left) / 2, 0.35, kThick / 2},
                {(left + right) / 2, 0, level * storey + kGap + up + kThick / 2});
    }
  }
  expect_stands(2);
}

/// A plate over 16 blocks, on pillars in all of them and on their edges.
TEST_P(SeamScenes, AGiantPlateStandsOnPillars) {
  for (int i = -2; i <= 2; ++i) {
    for (int k = -2; k <= 2; ++k) place_box({0.4, 0.4, 0.5}, {7.0 * i, 7.0 * k, 0.5});
  }
  place_box({15, 15, 0.02}, {0, 0, 1.02});
  for (int i = -1; i <= 1; ++i) place_box({0.4, 0.4, 0.4}, {7.0 * i, 0, 1.44});
  expect_stands(12);
}

constexpr double kIn = 3 * kSide / 2;  // the middle of a block
INSTANTIATE_TEST_SUITE_P(Spots, SeamScenes,
                         ::testing::Values(Spot{"Edge", {2 * kSide, kIn, 0}},
                                           Spot{"Corner", {2 * kSide, 2 * kSide, 0}}),
                         [](const auto& spot) { return std::string(spot.param.name); });

}  // namespace
}  // namespace aurasim::physics::testing
