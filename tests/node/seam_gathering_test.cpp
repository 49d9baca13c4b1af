#include "node/seam_gathering.h"

#include <algorithm>
#include <functional>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/seam_tree.h"
#include "transport/memory_seams.h"

namespace aurasim::node::testing {
namespace {

using core::Introduction;
using core::RegionId;

using Pairs = std::vector<Introduction>;

/// Each region says nothing, or some pairs.
std::vector<Pairs> random_pairs(std::uint32_t regions, std::mt19937& random) {
  std::vector<Pairs> all(regions);
  for (Pairs& pairs : all) {
    for (std::uint32_t i = random() % 3; i > 0; --i) {
      const auto any = [&](std::uint32_t from) { return std::uniform_int_distribution(from, regions - 1)(random); };
      const std::uint32_t a = std::min(any(0), regions - 2);
      pairs.push_back({RegionId{a}, RegionId{any(a + 1)}});
    }
  }
  return all;
}

/// A region knows the pairs of its own batch, and of the batches of those that the tree connects it with.
Pairs known_to(std::uint32_t region, const std::vector<Pairs>& said) {
  const core::SeamTree tree(said.size());
  Pairs known;
  for (std::uint32_t i = 0; i < said.size(); ++i) {
    if (i != region && !tree.has_edge(RegionId{i}, RegionId{region})) continue;
    known.insert(known.end(), said[i].begin(), said[i].end());
  }
  return known;
}

TEST(SeamGathering, TellsAllWhatAllHaveSaid) {
  std::mt19937 random(1);
  for (const std::uint32_t regions : {10U, 16U, 17U, 18U, 30U, 74U, 90U}) {
    transport::MemorySeams seams(regions);
    const std::vector<Pairs> said = random_pairs(regions, random);
    std::set<Introduction> all;
    for (const Pairs& pairs : said) all.insert(pairs.begin(), pairs.end());
    std::vector<Pairs> heard(regions);
    std::vector<std::function<void()>> works;
    for (std::uint32_t i = 0; i < regions; ++i) {
      works.push_back(
          [&, i] { heard[i] = gather_pairs(seams.of(RegionId{i}), RegionId{i}, regions, known_to(i, said)); });
    }
    seams.run(works);
    EXPECT_TRUE(seams.is_empty());
    EXPECT_LT(seams.count(), 2 * regions) << "parcels";
    for (const Pairs& pairs : heard) EXPECT_EQ(std::set<Introduction>(pairs.begin(), pairs.end()), all) << regions;
  }
}

/// So a region that has heard all knows that all have ended the step before.
TEST(SeamGathering, WaitsForAll) {
  constexpr std::uint32_t kRegions = 30;
  for (std::uint32_t missing = 0; missing < kRegions; ++missing) {
    // A leaf that is late has published no batch, and then its parent does not begin to gather.
    const core::SeamTree tree(kRegions);
    if (tree.is_leaf(RegionId{missing})) continue;
    transport::MemorySeams seams(kRegions);
    int told = 0;
    std::vector<std::function<void()>> works;
    for (std::uint32_t i = 0; i < kRegions; ++i) {
      works.push_back([&, i] {
        if (i == missing) throw core::SeamsBroken("it is late");
        gather_pairs(seams.of(RegionId{i}), RegionId{i}, kRegions, {});
        ++told;
      });
    }
    EXPECT_THROW(seams.run(works), core::SeamsBroken);
    EXPECT_EQ(told, 0) << missing;
  }
}

/// Gives the same parcel to everybody.
class OneParcel final : public core::SeamMail {
 public:
  explicit OneParcel(std::vector<std::uint32_t> numbers) : numbers_(std::move(numbers)) {}
  void post(RegionId, std::span<const std::byte>) override {}
  std::span<const std::byte> fetch(RegionId) override { return std::as_bytes(std::span(numbers_)); }

 private:
  std::vector<std::uint32_t> numbers_;
};

TEST(SeamGathering, RefusesWhatNoRegionPosts) {
  constexpr std::uint32_t kCount = 2;  // of the numbers that follow
  const auto gather_from = [](std::vector<std::uint32_t> parcel) {
    OneParcel mail(std::move(parcel));
    return gather_pairs(mail, RegionId{9}, 10, {});
  };
  EXPECT_EQ(gather_from({kCount, 3, 9}), (Pairs{{RegionId{3}, RegionId{9}}}));
  EXPECT_THROW(gather_from({kCount, 3, 10}), core::SeamsBroken) << "there are ten";
  EXPECT_THROW(gather_from({kCount, 3}), core::SeamsBroken);
  EXPECT_THROW(gather_from({1, 3}), core::SeamsBroken);
  EXPECT_THROW(gather_from({kCount, 3, 4, 5}), core::SeamsBroken);
  EXPECT_THROW(gather_from({}), core::SeamsBroken);
}

}  // namespace
}  // namespace aurasim::node::testing
