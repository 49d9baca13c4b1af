// A warm step of the soft step allocates nothing. A world that has fallen asleep frees what its steps have used.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <new>

#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include "core/used_room.h"
#include "physics/scenes.h"

namespace {

std::atomic<long> allocations = 0;
std::atomic<long> held_bytes = 0;

void* note(void* memory) {
  ++allocations;
  held_bytes += static_cast<long>(malloc_usable_size(memory));
  return memory;
}
void* counted(std::size_t size) { return note(std::malloc(size)); }
void release(void* memory) {
  held_bytes -= static_cast<long>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  if (void* const memory = counted(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto to = static_cast<std::size_t>(alignment);
  if (void* const memory = note(std::aligned_alloc(to, (size + to - 1) / to * to))) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }

namespace aurasim::physics::testing {
namespace {

/// Bullet's, and those of the C++ library: the fewest of three times `steps` steps. With several threads, who computes
/// what differs from time to time, so memory may still have to grow once more.
long allocations_of(RegionWorld& world, int steps) {
  btAlignedAllocSetCustom(counted, release);
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

/// Pairs of boxes on a floor.
TEST(Allocation, AWorldThatHasFallenAsleepFreesTheMemoryOfItsSteps) {
  constexpr int kBoxes = 4000;
  btAlignedAllocSetCustom(counted, release);
  core::Scene scene = scene_of(core::Box{});
  scene.prototypes[0].can_sleep = true;
  for (const int threads : {1, 2}) {
    const long before = held_bytes;
    RegionWorld world(scene, warm_settings(threads));
    std::vector<core::BodyRecord> boxes;
    for (int i = 0; i < kBoxes; ++i) {
      boxes.push_back(body(boxes.size(), 0, {2.0 * (i / 2 % 50), 2.0 * (i / 100), 0.5 + i % 2}));
    }
    world.add(boxes);
    run(world, 60);
    const long awake = (held_bytes - before) / kBoxes;
    run(world, 2 * core::UsedRoom::kSteps + 120);
    ASSERT_EQ(world.snapshot().awake, 0);
    const long asleep = (held_bytes - before) / kBoxes;
    EXPECT_LT(asleep, awake - 800) << threads << " threads";
    EXPECT_LT(asleep, 4300) << "bytes for each body";
  }
}

double resident_bytes() {
  malloc_trim(0);
  double pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Memory of the process for each body, in piles of two boxes: 4 KB while contacts of sleepers were not packed.
TEST(Allocation, ASleeperTakesLittleMemory) {
  constexpr int kBoxes = 20'000;
  btAlignedAllocSetCustom(counted, release);
  core::Scene scene = scene_of(core::Box{});
  scene.prototypes[0].can_sleep = true;
  const double before = resident_bytes();
  RegionWorld world(scene, warm_settings(1));
  std::vector<core::BodyRecord> boxes;
  for (int i = 0; i < kBoxes; ++i) {
    boxes.push_back(body(boxes.size(), 0, {2.0 * (i / 2 % 100), 2.0 * (i / 200), 0.5 + i % 2}));
  }
  world.add(boxes);
  boxes = {};
  run(world, 3 * core::UsedRoom::kSteps + 120);
  ASSERT_EQ(world.snapshot().awake, 0);
  EXPECT_LT((resident_bytes() - before) / kBoxes, 3000);
}

}  // namespace
}  // namespace aurasim::physics::testing
