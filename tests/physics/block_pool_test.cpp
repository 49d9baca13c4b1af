#include "physics/block_pool.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

namespace aurasim::physics {
namespace {

constexpr std::size_t kBytes = 1000;

double resident_bytes() {
  double pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void* taken(BlockPool& pool, int mark) {
  void* const block = pool.take();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % BlockPool::kAlignment, 0);
  std::memset(block, mark, kBytes);
  return block;
}

TEST(BlockPool, BlocksDoNotOverlap) {
  std::mt19937_64 random(1);
  BlockPool pool(kBytes);
  struct Taken {
    unsigned char* block;
    int mark;
  };
  std::vector<Taken> all;
  for (int n = 0; n < 20'000; ++n) {
    const bool takes = all.size() < 5 || random() % 100 < (n % 4000 < 2000 ? 70U : 30U);
    if (takes) {
      all.push_back({static_cast<unsigned char*>(taken(pool, n % 256)), n % 256});
      continue;
    }
    std::swap(all[random() % all.size()], all.back());
    for (const std::size_t at : {std::size_t{0}, kBytes - 1}) EXPECT_EQ(all.back().block[at], all.back().mark);
    pool.give_back(all.back().block);
    all.pop_back();
  }
  for (const Taken& taken : all) pool.give_back(taken.block);
}

TEST(BlockPool, ReturnsMemoryToTheSystem) {
  BlockPool pool(kBytes);
  const double before = resident_bytes();
  std::vector<void*> all;
  for (int n = 0; n < 50'000; ++n) all.push_back(taken(pool, n % 256));
  EXPECT_GT(resident_bytes() - before, 40e6);
  for (void* block : all) pool.give_back(block);
  EXPECT_LT(resident_bytes() - before, 5e6);
}

TEST(BlockPool, UsesABlockAgain) {
  BlockPool pool(kBytes);
  std::set<void*> all;
  for (int n = 0; n < 1000; ++n) {
    void* const block = taken(pool, 1);
    all.insert(block);
    pool.give_back(block);
  }
  EXPECT_EQ(all.size(), 1U);
}

}  // namespace
}  // namespace aurasim::physics
