// A warm step of the soft step allocates nothing.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>

#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace {

std::atomic<long> allocations = 0;

void* counted(std::size_t size) {
  ++allocations;
  return std::malloc(size);
}

}  // namespace

void* operator new(std::size_t size) {
  if (void* const memory = counted(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto to = static_cast<std::size_t>(alignment);
  if (void* const memory = std::aligned_alloc(to, (size + to - 1) / to * to)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace aurasim::physics::testing {
namespace {

/// Bullet's, and those of the C++ library: the fewest of three times `steps` steps. With several threads, who computes
/// what differs from time to time, so memory may still have to grow once more.
long allocations_of(RegionWorld& world, int steps) {
  btAlignedAllocSetCustom(counted, std::free);
  long fewest = std::numeric_limits<long>::max();
  for (int i = 0; i < 3 && fewest > 0; ++i) {
    const long before = allocations;
    run(world, steps);
    fewest = std::min<long>(fewest, allocations - before);
  }
  return fewest;
}

Settings warm_settings(int threads) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  settings.threads = threads;
  return settings;
}

TEST(Allocation, AWarmStepAllocatesNothing) {
  core::Scene scene = scene_of(core::Box{});
  scene.prototypes[0].can_sleep = false;
  for (const int threads : {1, 2}) {
    const long before = allocations;
    RegionWorld world(scene, warm_settings(threads));
    EXPECT_GT(allocations, before) << "they are not counted";
    std::vector<core::BodyRecord> boxes;
    for (int i = 0; i < 200; ++i)
      boxes.push_back(body(boxes.size(), 0, {1.5 * (i % 10), 1.5 * (i / 50), 0.5 + i / 10 % 5}));
    world.add(boxes);
    run(world, 200);
    EXPECT_EQ(allocations_of(world, 20), 0) << threads << " threads";
  }
}

/// Towers of hulls.
TEST(Allocation, AWarmStepOfHullsAllocatesNothing) {
  core::ConvexHull prism;
  for (int i = 0; i < 14; ++i) {
    prism.points.emplace_back(0.4 * std::cos(i / 2 * 0.9), 0.4 * std::sin(i / 2 * 0.9), i % 2 == 0 ? -0.2 : 0.2);
  }
  core::Scene scene = scene_of(prism);
  scene.prototypes[0].can_sleep = false;
  for (const int threads : {1, 2}) {
    RegionWorld world(scene, warm_settings(threads));
    std::vector<core::BodyRecord> prisms;
    for (int i = 0; i < 200; ++i) {
      prisms.push_back(body(prisms.size(), 0, {1.5 * (i % 10), 1.5 * (i / 50), 0.2 + 0.4 * (i / 10 % 5)}));
    }
    world.add(prisms);
    run(world, 200);
    EXPECT_EQ(allocations_of(world, 20), 0) << threads << " threads";
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
