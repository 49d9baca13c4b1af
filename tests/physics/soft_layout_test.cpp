// How contacts are shared out among threads: soft/layout.h.
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/soft/lanes.h"
#include "physics/soft/layout.h"

namespace aurasim::physics::testing {
namespace {

struct Contact {
  std::int32_t a, b;
  std::size_t points;
  SoftPhase phase;
  std::size_t group;
};

constexpr std::size_t kMovers = 1201;

/// Contacts of bodies in cells, each of which is a group; and some of all cells with each other in the last phase.
std::vector<Contact> contacts(std::size_t cells, std::size_t count) {
  std::mt19937_64 random(7);
  const std::size_t in_cell = (kMovers - 1) / cells;
  std::vector<Contact> all;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t cell = random() % cells;
    const auto body_of = [&](std::size_t of) {
      return static_cast<std::int32_t>(1 + of * in_cell + random() % in_cell);
    };
    const std::int32_t a = body_of(cell), b = i % 5 == 0 ? 0 : body_of(i % 50 == 1 ? random() % cells : cell);
    if (a == b) continue;
    const bool inside = i % 50 != 1;
    all.push_back({a, b, 1 + random() % 4, inside ? SoftPhase::kInside : SoftPhase::kGiants, inside ? cell : 0});
  }
  return all;
}

struct Swept {
  std::map<std::int32_t, std::vector<std::size_t>> of_body;  ///< contacts in the order in which they were solved
  SoftLoad load;
  std::uint32_t waits;
};

Swept sweep(const std::vector<Contact>& all, int threads) {
  soft::Team team(threads);
  SoftLayout layout(SoftLayout::Waits::kInEachPhase);
  layout.clear(kMovers, soft::kMostPoints + 1, all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    layout.put(i, all[i].a, all[i].b, all[i].points, all[i].phase, all[i].group);
  }
  std::vector<std::vector<std::size_t>> in_block(layout.place(team));
  for (std::size_t i = 0; i < all.size(); ++i) in_block[layout.block(i)].push_back(i);
  Swept swept;
  for (const Contact& contact : all) swept.of_body[contact.a], swept.of_body[contact.b];
  const std::uint32_t before = team.waits();
  team.side_by_side([&](const soft::Worker& worker) {
    layout.sweep(worker, 1, [&](int, std::size_t first, std::size_t count, std::size_t points) {
      for (std::size_t block = first; block < first + count; ++block) {
        for (const std::size_t i : in_block[block]) {
          EXPECT_EQ(all[i].points, points);
          if (all[i].a > 0) swept.of_body.at(all[i].a).push_back(i);
          if (all[i].b > 0) swept.of_body.at(all[i].b).push_back(i);
        }
      }
    });
  });
  swept.waits = team.waits() - before;
  swept.load = layout.load();
  return swept;
}

TEST(SoftLayout, TheContactsOfABodyHaveOneOrderForAnyNumberOfThreads) {
  for (const std::size_t cells : {1, 3, 40}) {
    const std::vector<Contact> all = contacts(cells, 6000);
    const Swept alone = sweep(all, 1);
    std::size_t solved = 0;
    for (const auto& [body, of] : alone.of_body) solved += of.size();
    EXPECT_GT(solved, all.size());
    for (const int threads : {2, 3, 8}) EXPECT_EQ(sweep(all, threads).of_body, alone.of_body) << cells << " cells";
  }
}

/// Phases inside, of giants and of statics, and the end of the parallel part.
TEST(SoftLayout, ThreadsWaitOnceAPhaseIfNoGroupIsTooHeavy) {
  std::vector<Contact> all = contacts(40, 6000);
  std::erase_if(all, [](const Contact& contact) { return contact.phase == SoftPhase::kGiants; });
  const Swept two = sweep(all, 2);
  EXPECT_EQ(two.load.split, 0U);
  EXPECT_EQ(two.waits, 3U);
}

TEST(SoftLayout, AGroupThatIsTooHeavyForOneThreadIsSplit) {
  const Swept two = sweep(contacts(1, 6000), 2);
  EXPECT_GT(two.load.split, two.load.all / 2);
  EXPECT_GT(two.waits, 10U);
  EXPECT_EQ(sweep(contacts(1, 6000), 1).load.split, 0U);
}

}  // namespace
}  // namespace aurasim::physics::testing
