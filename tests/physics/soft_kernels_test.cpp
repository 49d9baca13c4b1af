// The arithmetic of the soft step, which is compiled for several sets of instructions: none changes a bit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/free_rotation.h"
#include "physics/scenes.h"
#include "physics/soft/lanes.h"

namespace aurasim::physics::testing {
namespace {

constexpr auto kSubstep_s = static_cast<soft::Real>(1.0 / 480);

/// Random numbers for all lanes from `first` to the end of the block.
template <class AnyBlock>
void fill_lanes(AnyBlock& block, soft::Lanes* first, std::mt19937_64& random) {
  const auto lanes = static_cast<std::size_t>(reinterpret_cast<soft::Lanes*>(&block + 1) - first);
  for (std::size_t i = 0; i < lanes; ++i) {
    for (int lane = 0; lane < soft::kLanes; ++lane) {
      first[i][lane] = random() % 8 == 0 ? 0 : static_cast<soft::Real>(uniform(random, -1, 2));
    }
  }
}

/// Blocks of random numbers, among them lanes without a pair.
template <class AnyBlock>
std::vector<AnyBlock> random_blocks(std::mt19937_64& random, std::size_t count, std::uint32_t movers) {
  std::vector<AnyBlock> blocks(count);
  for (AnyBlock& block : blocks) {
    std::memset(static_cast<void*>(&block), 0, sizeof block);
    for (int lane = 0; lane < soft::kLanes; ++lane) {
      block.a[lane] = static_cast<std::int32_t>(random() % movers);
      block.b[lane] = static_cast<std::int32_t>(random() % movers);
    }
    fill_lanes(block, &block.inv_mass_a, random);
  }
  return blocks;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()), a.size() * sizeof(T)) == 0;
}

std::vector<soft::Kernel> kernels_of_this_machine() {
  std::vector<soft::Kernel> kernels = {soft::kernel_sse2()};
  if (__builtin_cpu_supports("avx2")) kernels.push_back(soft::kernel_avx2());
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(soft::kernel_avx512());
  }
  return kernels;
}

std::vector<soft::Mover> random_movers(std::mt19937_64& random, std::size_t count) {
  std::vector<soft::Mover> movers(count);
  for (std::size_t i = 1; i < movers.size(); ++i) {
    for (auto* triple : {&movers[i].v, &movers[i].w, &movers[i].dp}) {
      for (soft::Real& x : *triple) x = static_cast<soft::Real>(uniform(random, -1, 1));
    }
  }
  return movers;
}

/// work(kernel, blocks, movers) leaves the same blocks and movers with every kernel.
template <class AnyBlock, class Work>
void expect_same_bits(Work&& work) {
  constexpr std::uint32_t kMovers = 60;
  std::mt19937_64 random(1);  // numbers that do not grow without bound
  const std::vector<AnyBlock> blocks = random_blocks<AnyBlock>(random, 50, kMovers);
  const std::vector<soft::Mover> movers = random_movers(random, kMovers);
  std::vector<std::vector<AnyBlock>> blocks_of;
  std::vector<std::vector<soft::Mover>> movers_of;
  for (const soft::Kernel& kernel : kernels_of_this_machine()) {
    work(kernel, blocks_of.emplace_back(blocks), movers_of.emplace_back(movers));
  }
  EXPECT_FALSE(same_bytes(movers_of[0], movers));
  for (const soft::Mover& mover : movers_of[0]) ASSERT_TRUE(std::isfinite(mover.v[0] + mover.w[0]));
  for (std::size_t i = 1; i < movers_of.size(); ++i) {
    EXPECT_TRUE(same_bytes(blocks_of[i], blocks_of[0])) << i;
    EXPECT_TRUE(same_bytes(movers_of[i], movers_of[0])) << i;
  }
}

TEST(SoftKernels, PatchesHaveTheSameBitsWithEverySetOfInstructions) {
  expect_same_bits<soft::Block>([](const soft::Kernel& kernel, auto& blocks, auto& movers) {
    kernel.warm_start(blocks.data(), blocks.size(), 4, movers.data());
    for (const bool pushes : {true, false}) {
      kernel.solve(blocks.data(), blocks.size(), 3, movers.data(), {240, 3, pushes});
    }
    kernel.bounce(blocks.data(), blocks.size(), 2, movers.data(), soft::Real(-0.5));
  });
}

TEST(SoftKernels, JointsHaveTheSameBitsWithEverySetOfInstructions) {
  expect_same_bits<soft::JointBlock>([](const soft::Kernel& kernel, auto& blocks, auto& movers) {
    const unsigned all = (soft::kJointMotor << 1) - 1;
    const unsigned own = soft::kJointDrive | soft::kJointSpring | soft::kJointFriction;
    for (const unsigned what :
         {all, soft::kHeldAxis * 0b111, soft::kHeldAxis * 0b011111, soft::kHeldAxis * 0b111 | soft::kDampedBall,
          soft::kHeldAxis * 0b011111 | own | soft::kWholeTurns, soft::kHeldAxis * 0b111011 | own | soft::kSlides}) {
      kernel.look_at_joints(blocks.data(), blocks.size(), what, movers.data(), kSubstep_s);
      kernel.begin_joints(blocks.data(), blocks.size(), what, movers.data(), kSubstep_s);
      kernel.solve_joints(blocks.data(), blocks.size(), what, movers.data());
    }
  });
}

/// Movers that turn fast, in whole rows, and what makes some of them tumble.
struct Turning {
  std::vector<soft::Mover> movers;
  std::vector<soft::Tumblers> tumblers;
  std::vector<Rotation> rotations;  ///< of the bodies, as movers
  std::vector<core::Vec3> inertias;

  /// Lane `to` of the first row gets what mover `from` is.
  void copy(std::size_t from, int to) {
    movers[static_cast<std::size_t>(to)] = movers[from];
    const soft::Tumblers& source = tumblers[from / soft::kLanes];
    const auto lane = static_cast<int>(from % soft::kLanes);
    for (int k = 0; k < 4; ++k) tumblers[0].start[k][to] = source.start[k][lane];
    for (int k = 0; k < 3; ++k) tumblers[0].inertia[k][to] = source.inertia[k][lane];
    for (int k = 0; k < 3; ++k) tumblers[0].inv_inertia[k][to] = source.inv_inertia[k][lane];
  }
};

Turning random_turning(std::size_t rows) {
  std::mt19937_64 random(11);
  Turning t;
  t.movers = random_movers(random, rows * soft::kLanes);
  t.tumblers.resize(rows);
  t.rotations.resize(t.movers.size());
  t.inertias.resize(t.movers.size(), core::Vec3::Zero());
  for (std::size_t i = 1; i < t.movers.size(); ++i) {
    const core::Quat q =
        core::Quat(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), 2).normalized();
    const core::Vec3 w(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    const double fast = i % 3 == 0 ? 100 : 5;
    soft::Mover& mover = t.movers[i];
    for (int k = 0; k < 3; ++k) mover.w[k] = static_cast<soft::Real>(fast * w[k]);
    t.rotations[i] = {q.toRotationMatrix(), fast * w};
    if (i % 2 == 0) continue;
    soft::Tumblers& row = t.tumblers[i / soft::kLanes];
    const auto lane = static_cast<int>(i % soft::kLanes);
    row.any = true;
    t.inertias[i] = {uniform(random, 0.1, 1), uniform(random, 0.1, 1), uniform(random, 0.1, 1)};
    for (int k = 0; k < 4; ++k) row.start[k][lane] = static_cast<soft::Real>(q.coeffs()[k]);
    for (int k = 0; k < 3; ++k) {
      row.inertia[k][lane] = static_cast<soft::Real>(t.inertias[i][k]);
      row.inv_inertia[k][lane] = 1 / row.inertia[k][lane];
    }
  }
  return t;
}

void move(const soft::Kernel& kernel, Turning& t) {
  kernel.move(t.movers.data(), t.tumblers.data(), 0, t.tumblers.size(), kSubstep_s,
              {static_cast<soft::Real>(kTurn), soft::Real{kMostTurns}});
}

TEST(SoftKernels, MovesHaveTheSameBitsWithEverySetOfInstructions) {
  Turning first = random_turning(20);
  move(soft::kernel_sse2(), first);
  for (const soft::Kernel& kernel : kernels_of_this_machine()) {
    Turning other = random_turning(20);
    move(kernel, other);
    EXPECT_TRUE(same_bytes(other.movers, first.movers));
  }
}

TEST(SoftKernels, BodiesTumbleInLanesAsAlone) {
  Turning t = random_turning(20);
  move(soft::kernel(), t);
  for (std::size_t i = 1; i < t.movers.size(); i += 2) {
    const Rotation wanted = rotate_freely(t.rotations[i], t.inertias[i], static_cast<double>(kSubstep_s));
    const soft::Mover& mover = t.movers[i];
    const core::Quat dq(mover.dq[3], mover.dq[0], mover.dq[1], mover.dq[2]);
    const core::Vec3 w(mover.w[0], mover.w[1], mover.w[2]);
    EXPECT_LT((dq.cast<double>().toRotationMatrix() * t.rotations[i].R_WB - wanted.R_WB).norm(), 2e-6) << i;
    EXPECT_LT((w - wanted.w_WB).norm(), 3e-6 * wanted.w_WB.norm()) << i;
  }
}

TEST(SoftKernels, NoLaneSeesAnother) {
  Turning together = random_turning(20);
  move(soft::kernel(), together);
  for (std::size_t i = 1; i < together.movers.size(); ++i) {
    Turning elsewhere = random_turning(20);
    const int lane = 1 + static_cast<int>(i % (soft::kLanes - 1));
    elsewhere.copy(i, lane);
    move(soft::kernel(), elsewhere);
    const auto to = static_cast<std::size_t>(lane);
    EXPECT_EQ(std::memcmp(&elsewhere.movers[to], &together.movers[i], sizeof(soft::Mover)), 0) << i;
  }
}

/// The first of those that are equally far, as Bullet's loop over the points finds.
template <class Number>
std::size_t farthest_in_a_loop(const std::vector<Number> (&points)[3], const Number (&along)[3]) {
  std::size_t best = 0;
  const auto far = [&](std::size_t i) {
    return points[0][i] * along[0] + points[1][i] * along[1] + points[2][i] * along[2];
  };
  for (std::size_t i = 1; i < points[0].size(); ++i) best = far(i) > far(best) ? i : best;
  return best;
}

template <class Number, class Farthest>
void expect_farthest(Farthest&& farthest) {
  std::mt19937_64 random(3);
  for (const std::size_t blocks : {1u, 2u, 7u}) {
    for (int trial = 0; trial < 200; ++trial) {
      std::vector<Number> points[3];
      for (auto& coordinate : points) {
        // Few values: many are equally far.
        while (coordinate.size() < blocks * soft::kPointsAtOnce) {
          coordinate.push_back(static_cast<Number>(static_cast<int>(random() % 3) - 1));
        }
      }
      const Number along[3] = {static_cast<Number>(uniform(random, -1, 1)), static_cast<Number>(trial % 2), 0};
      const std::size_t expected = farthest_in_a_loop(points, along);
      for (const soft::Kernel& kernel : kernels_of_this_machine()) {
        ASSERT_EQ(farthest(kernel, points, along), expected);
      }
    }
  }
}

TEST(SoftKernels, TheFarthestPointIsTheFirstOfThoseWithEverySetOfInstructions) {
  expect_farthest<double>([](const soft::Kernel& kernel, const auto& p, const auto& along) {
    return kernel.farthest_double(p[0].data(), p[1].data(), p[2].data(), p[0].size(), along);
  });
  expect_farthest<float>([](const soft::Kernel& kernel, const auto& p, const auto& along) {
    return kernel.farthest_single(p[0].data(), p[1].data(), p[2].data(), p[0].size(), along);
  });
}

TEST(SoftKernels, BoundsAndReachAreThoseOfALoopWithEverySetOfInstructions) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = soft::kPointsAtOnce * (1 + random() % 4);
    std::vector<double> points[3], before(count);
    for (auto& coordinate : points) {
      while (coordinate.size() < count) coordinate.push_back(static_cast<double>(static_cast<int>(random() % 3) - 1));
    }
    for (double& bound : before) bound = random() % 4 == 0 ? -HUGE_VAL : random() % 3 == 0 ? HUGE_VAL : 0.5;
    const double along[3] = {uniform(random, -1, 1), static_cast<double>(trial % 2), 0};
    std::vector<double> products(count), wanted = before;
    for (std::size_t i = 0; i < count; ++i) {
      products[i] = points[0][i] * along[0] + points[1][i] * along[1] + points[2][i] * along[2];
      wanted[i] = std::min(before[i], products[i]);
    }
    const auto highest = static_cast<std::size_t>(std::max_element(wanted.begin(), wanted.end()) - wanted.begin());
    const auto [least, most] = std::minmax_element(products.begin(), products.end());
    for (const soft::Kernel& kernel : kernels_of_this_machine()) {
      double ends[2];
      kernel.reach(points[0].data(), points[1].data(), points[2].data(), count, along, ends);
      ASSERT_EQ(ends[0], *least);
      ASSERT_EQ(ends[1], *most);
      std::vector<double> found(count), bounds = before;
      ASSERT_EQ(kernel.tighten(points[0].data(), points[1].data(), points[2].data(), count, along, found.data(),
                               bounds.data()),
                highest);
      ASSERT_EQ(found, products);
      ASSERT_EQ(bounds, wanted);
    }
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
