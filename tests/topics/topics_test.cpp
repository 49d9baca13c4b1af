// The table of topics: partitions of routes, and a table that has everything once.
#include "topics/topics.h"

#include <set>

#include <fnmatch.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::topics {
namespace {

using core::RegionId;
using ::testing::ElementsAre;

bool matches(const std::string& pattern, const std::string& partition) {
  return ::fnmatch(pattern.c_str(), partition.c_str(), FNM_NOESCAPE) == 0;
}

TEST(Topics, HaveNamesOfTheirOwnAndSomebodyOnBothSides) {
  std::set<std::string> names;
  for (const Topic& topic : all()) {
    EXPECT_TRUE(names.insert(topic.name).second) << topic.name;
    EXPECT_EQ(topic_named(topic.name), topic.id);
    EXPECT_NE(topic.published_by, 0) << topic.name;
    EXPECT_NE(topic.read_by, 0) << topic.name;
  }
  EXPECT_EQ(topic_named("auras"), std::nullopt);
}

TEST(Partitions, NameTheRegionsOfTheRoute) {
  EXPECT_EQ(partition_of(TopicId::kCommand, {.source = RegionId{1}}), "world");
  EXPECT_EQ(partition_of(TopicId::kNodeStatus, {.source = RegionId{3}}), "region/3");
  EXPECT_EQ(partition_of(TopicId::kMigration, {.source = RegionId{3}, .destination = RegionId{1}}), "region/3/to/1");
  EXPECT_EQ(partition_of(TopicId::kObservation, {.source = RegionId{3}, .observer = 0xff}),
            "region/3/observer/00000000000000ff");
}

TEST(Partitions, AreOthersAfterADeathWhereNodesTalkToNodes) {
  EXPECT_EQ(partition_of(TopicId::kAura, {.source = RegionId{3}, .life = 5}), "region/3/since/5");
  EXPECT_EQ(partition_of(TopicId::kCheckpoint, {.source = RegionId{3}, .destination = RegionId{1}, .life = 5}),
            "region/3/to/1/since/5");
  EXPECT_EQ(partition_of(TopicId::kNodeStatus, {.source = RegionId{3}, .life = 5}), "region/3");
  EXPECT_EQ(partition_of(TopicId::kRunControl, {.life = 5}), "world");
}

TEST(Partitions, OfMessagesToAllAreTheHubsWhereThereIsOne) {
  EXPECT_TRUE(goes_by_hub(TopicId::kNodeStatus, "region/3"));
  EXPECT_TRUE(goes_by_hub(TopicId::kRunControl, "world"));
  EXPECT_TRUE(goes_by_hub(TopicId::kCheckpoint, "world"));
  EXPECT_FALSE(goes_by_hub(TopicId::kCheckpoint, "region/3/to/4"));
  EXPECT_FALSE(goes_by_hub(TopicId::kAura, "region/3"));
  EXPECT_FALSE(goes_by_hub(TopicId::kCommand, "world")) << "those who ask meet all nodes";
  EXPECT_TRUE(matches(kEveryPartitionToHub, to_hub("region/3")));
  EXPECT_FALSE(matches("region/*", to_hub("region/3"))) << "or a hub would not be needed";
  EXPECT_FALSE(matches(kEveryPartitionToHub, "region/3")) << "or a hub would pass on what a hub has passed on";
}

TEST(Partitions, OfAnOpenRouteAreAPatternOfAllThatItLeavesOpen) {
  const std::string to_1 = partition_of(TopicId::kMigration, {.destination = RegionId{1}});
  EXPECT_TRUE(matches(to_1, "region/3/to/1"));
  EXPECT_FALSE(matches(to_1, "region/3/to/2"));
  EXPECT_FALSE(matches(to_1, "region/3/to/1/since/5"));
  EXPECT_TRUE(matches(in_later_lives(to_1), "region/3/to/1/since/5"));
  for (const Topic& topic : all()) {
    for (const std::string& partition : partitions_in_run(topic.id, 4)) {
      EXPECT_TRUE(matches(partition_of(topic.id), partition)) << topic.name << " " << partition;
      EXPECT_TRUE(matches(every_partition_of(topic.id), partition)) << topic.name << " " << partition;
    }
  }
}

TEST(Partitions, OfARunAreOneForEachSourceOrPair) {
  EXPECT_THAT(partitions_in_run(TopicId::kAura, 2), ElementsAre("region/0", "region/1"));
  EXPECT_THAT(partitions_in_run(TopicId::kMigration, 2),
              ElementsAre("region/0/to/0", "region/0/to/1", "region/1/to/0", "region/1/to/1"));
  EXPECT_THAT(partitions_in_run(TopicId::kObservation, 1), ElementsAre("region/0/observer/*"));
  EXPECT_THAT(partitions_in_run(TopicId::kShape, 9), ElementsAre("world"));
}

}  // namespace
}  // namespace aurasim::topics
