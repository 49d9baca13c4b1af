// Who may say what, and listen to what: as rules, and as they stand in the document that Fast DDS reads.
#include "security/permissions.h"

#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scratch_store.h"
#include "topics/topics.h"

namespace aurasim::security {
namespace {

using ::testing::HasSubstr;

bool may_say(Role role, std::uint32_t region, const char* topic, const char* partition) {
  return is_granted(grants_of(role, region).publishes, topic, partition);
}
bool may_read(Role role, std::uint32_t region, const char* topic, const char* partition) {
  return is_granted(grants_of(role, region).subscribes, topic, partition);
}

TEST(ANode, SpeaksForItsRegionOnly) {
  for (const char* partition : {"region/2", "region/2/since/5"}) {
    EXPECT_TRUE(may_say(Role::kRegion, 2, "aura", partition)) << partition;
  }
  for (const char* partition :
       {"region/1", "region/20", "region/*", "*", "region/?", "region/1/since/5", "region/[2]", "world", ""}) {
    EXPECT_FALSE(may_say(Role::kRegion, 2, "aura", partition)) << partition;
  }
  for (const char* topic : {"node_status", "replica", "replica_key", "cluster_graph"}) {
    EXPECT_TRUE(may_say(Role::kRegion, 2, topic, "region/2")) << topic;
    EXPECT_FALSE(may_say(Role::kRegion, 2, topic, "region/1")) << topic;
    EXPECT_FALSE(may_say(Role::kRegion, 2, topic, "region/*")) << topic;
  }
}

TEST(ANode, HandsOverInItsOwnNameAndReadsWhatIsForIt) {
  EXPECT_TRUE(may_say(Role::kRegion, 2, "migration", "region/2/to/1"));
  EXPECT_TRUE(may_say(Role::kRegion, 2, "migration", "region/2/to/1/since/5"));
  EXPECT_FALSE(may_say(Role::kRegion, 2, "migration", "region/1/to/2"));
  EXPECT_FALSE(may_say(Role::kRegion, 2, "migration", "region/*/to/1"));
  EXPECT_TRUE(may_read(Role::kRegion, 2, "migration", "region/1/to/2"));
  EXPECT_TRUE(may_read(Role::kRegion, 2, "migration", "region/1/to/2/since/5"));
  EXPECT_FALSE(may_read(Role::kRegion, 2, "migration", "region/1/to/3"));
  EXPECT_FALSE(may_read(Role::kRegion, 2, "migration", "region/1/to/3/since/2"));
  EXPECT_FALSE(may_read(Role::kRegion, 2, "migration", "region/*"));
  EXPECT_FALSE(may_read(Role::kRegion, 2, "migration", "*"));
}

TEST(ANode, MayListenToWhomeverItsBodiesCallFor) {
  for (const char* partition : {"region/0", "region/77", "region/77/since/3"}) {
    EXPECT_TRUE(may_read(Role::kRegion, 2, "aura", partition)) << partition;
  }
}

TEST(ANode, AsksForNothing) { EXPECT_FALSE(may_say(Role::kRegion, 2, "command", "world")); }

TEST(ASpare, SpeaksForTheRegionThatItTakesOver) {
  for (const char* region : {"0", "7", "1048575"}) {
    EXPECT_TRUE(may_say(Role::kSpare, 0, "node_status", (std::string("region/") + region).c_str()));
    EXPECT_TRUE(may_say(Role::kSpare, 0, "aura", (std::string("region/") + region + "/since/4").c_str()));
    EXPECT_TRUE(may_say(Role::kSpare, 0, "migration", (std::string("region/") + region + "/to/1/since/4").c_str()));
  }
  EXPECT_TRUE(may_read(Role::kSpare, 0, "checkpoint", "world"));
  EXPECT_FALSE(may_say(Role::kSpare, 0, "command", "world"));
}

TEST(ANode, SpeaksToTheHubInItsOwnName) {
  EXPECT_TRUE(may_say(Role::kRegion, 2, "node_status", "hub/region/2"));
  for (const char* partition : {"hub/region/1", "hub/region/*", "hub/*", "hub/world"}) {
    EXPECT_FALSE(may_say(Role::kRegion, 2, "node_status", partition)) << partition;
  }
  for (const char* topic : {"region_map", "run_control", "checkpoint"}) {
    EXPECT_TRUE(may_say(Role::kRegion, 2, topic, "hub/world")) << topic;
    EXPECT_FALSE(may_say(Role::kRegion, 2, topic, "hub/*")) << topic;
  }
  EXPECT_FALSE(may_say(Role::kRegion, 2, "checkpoint", "hub/region/2/to/1"));
  EXPECT_TRUE(may_say(Role::kSpare, 0, "node_status", "hub/region/7"));
}

TEST(AHub, PassesOnWhatNodesSayToAllAndNothingElse) {
  for (const topics::Topic& topic : topics::all()) {
    const bool goes_by_hub = topics::has_way_by_hub(topic.id);
    EXPECT_EQ(may_say(Role::kHub, 0, topic.name, "from_hub"), goes_by_hub) << topic.name;
    EXPECT_EQ(may_read(Role::kHub, 0, topic.name, "hub/*"), goes_by_hub) << topic.name;
    for (const char* partition : {"world", "region/0", "region/*", "region/0/to/1", "hub/world", "*"}) {
      EXPECT_FALSE(may_say(Role::kHub, 0, topic.name, partition)) << topic.name << " " << partition;
    }
    for (const char* partition : {"world", "region/0", "region/*", "region/0/to/1", "*"}) {
      EXPECT_FALSE(may_read(Role::kHub, 0, topic.name, partition)) << topic.name << " " << partition;
    }
  }
  for (const char* topic : {"node_status", "region_map", "run_control", "checkpoint"}) {
    EXPECT_TRUE(may_say(Role::kHub, 0, topic, "from_hub")) << topic;
  }
}

/// What comes in that partition counts as the word of whom the hub names.
TEST(NobodyButAHub, PublishesWhereTheHubPublishes) {
  for (int i = 0; i < kRoleCount; ++i) {
    const Role role = static_cast<Role>(i);
    if (role == Role::kHub) continue;
    for (const topics::Topic& topic : topics::all()) {
      for (const char* partition : {"from_hub", "from_*", "?rom_hub", "[f]rom_hub", "*", "*hub", "f*", ""}) {
        EXPECT_FALSE(may_say(role, 2, topic.name, partition)) << name_of(role) << " " << topic.name << " " << partition;
      }
    }
  }
}

TEST(WhatTheHubPassesOn, IsReadByThoseWhoReadTheTopic) {
  for (const Role role : {Role::kRegion, Role::kSpare, Role::kViewer, Role::kOperator, Role::kRecorder}) {
    for (const char* topic : {"node_status", "region_map"}) EXPECT_TRUE(may_read(role, 2, topic, "from_hub")) << topic;
  }
  EXPECT_TRUE(may_read(Role::kOperator, 0, "run_control", "from_hub"));
  EXPECT_TRUE(may_say(Role::kOperator, 0, "run_control", "hub/world"));
  EXPECT_FALSE(may_read(Role::kViewer, 0, "run_control", "from_hub"));
  EXPECT_FALSE(may_read(Role::kOperator, 0, "checkpoint", "from_hub"));
  EXPECT_FALSE(may_read(Role::kViewer, 0, "node_status", "hub/region/2"));
}

TEST(PermissionsDocument, OfAnEarlierVersionLacksRights) {
  const Validity valid{};
  Grants grants = grants_of(Role::kRegion, 2);
  EXPECT_TRUE(has_rules(permissions_document({}, valid, grants), grants));
  Grants before = grants;
  for (Grant& grant : before.subscribes) std::erase(grant.partitions, topics::kFromHub);
  EXPECT_FALSE(has_rules(permissions_document({}, valid, before), grants));
}

TEST(AViewer, SaysOnlyWhatItWantsToSee) {
  const std::vector<Grant> says = grants_of(Role::kViewer).publishes;
  ASSERT_EQ(says.size(), 1U);
  EXPECT_EQ(says[0].topic, "interest");
  EXPECT_TRUE(grants_of(Role::kRecorder).publishes.empty());
}

TEST(AViewer, SeesTheWorldAndNotHowItIsHandedOver) {
  for (const char* topic : {"replica", "replica_key", "cluster_graph", "node_status", "aura"}) {
    EXPECT_TRUE(may_read(Role::kViewer, 0, topic, "region/*")) << topic;
  }
  for (const char* topic : {"region_map", "orders", "shape"}) {
    EXPECT_TRUE(may_read(Role::kViewer, 0, topic, "world")) << topic;
  }
  for (const char* topic : {"migration", "checkpoint", "command", "control", "command_reply", "run_control"}) {
    for (const char* partition : {"world", "region/*", "region/1/to/2", "*"}) {
      EXPECT_FALSE(may_read(Role::kViewer, 0, topic, partition)) << topic << " " << partition;
    }
  }
}

TEST(Observers, AreToldByEachRegionInItsOwnNameAndByNobodyElse) {
  EXPECT_TRUE(may_say(Role::kRegion, 2, "observation", "region/2/observer/00000000000000ff"));
  EXPECT_FALSE(may_say(Role::kRegion, 2, "observation", "region/1/observer/00000000000000ff"));
  EXPECT_FALSE(may_say(Role::kRegion, 2, "observation", "region/*/observer/00000000000000ff"));
  EXPECT_TRUE(may_read(Role::kRegion, 2, "interest", "world"));
  for (const Role role : {Role::kViewer, Role::kOperator}) {
    EXPECT_TRUE(may_say(role, 0, "interest", "world"));
    EXPECT_TRUE(may_read(role, 0, "observation", "region/*/observer/00000000000000ff"));
    EXPECT_FALSE(may_say(role, 0, "observation", "region/1/observer/00000000000000ff"));
  }
  EXPECT_FALSE(may_say(Role::kRecorder, 0, "interest", "world"));
}

TEST(OnlyOperators, AskSomethingOfTheWorld) {
  for (int i = 0; i < kRoleCount; ++i) {
    const Role role = static_cast<Role>(i);
    EXPECT_EQ(may_say(role, 0, "command", "world"), role == Role::kOperator) << name_of(role);
    EXPECT_EQ(may_say(role, 0, "control", "world"), role == Role::kOperator) << name_of(role);
    // Nodes tell meshes again that a saved world has brought.
    const bool is_node = role == Role::kRegion || role == Role::kSpare;
    EXPECT_EQ(may_say(role, 0, "shape", "world"), is_node || role == Role::kOperator) << name_of(role);
  }
  EXPECT_TRUE(may_say(Role::kOperator, 0, "run_control", "world"));
  for (const char* topic : {"aura", "migration", "node_status", "region_map", "replica", "checkpoint"}) {
    EXPECT_FALSE(may_say(Role::kOperator, 0, topic, "world")) << topic;
    EXPECT_FALSE(may_say(Role::kOperator, 0, topic, "region/0")) << topic;
  }
}

/// Read back rule by rule, as Fast DDS does: the first rule with a topic counts, with all partitions in it.
Grants grants_in(const std::string& document) {
  static const std::regex kRule(
      "<allow_rule>.*<(publish|subscribe)><topics>((?:<topic>[a-z_]+</topic>)+)</topics><partitions>(.*)</partitions>");
  static const std::regex kPartition("<partition>([^<]*)</partition>");
  Grants grants;
  for (std::sregex_iterator rule(document.begin(), document.end(), kRule), end; rule != end; ++rule) {
    const std::string topics = (*rule)[2];
    Grant grant{topics.substr(7, topics.size() - 15), {}};  // one, or its name is no topic's
    const std::string partitions = (*rule)[3];
    for (std::sregex_iterator p(partitions.begin(), partitions.end(), kPartition), none; p != none; ++p) {
      grant.partitions.push_back((*p)[1]);
    }
    ((*rule)[1] == "publish" ? grants.publishes : grants.subscribes).push_back(grant);
  }
  return grants;
}

void expect_same(const std::vector<Grant>& found, const std::vector<Grant>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].topic, expected[i].topic);
    EXPECT_EQ(found[i].partitions, expected[i].partitions) << found[i].topic;
  }
}

TEST(PermissionsDocument, HasOneRuleForEachTopicAndDirection) {
  ScratchStore scratch;
  const std::chrono::days valid{10};
  scratch.store.add(member_of_region(2), valid);
  for (const Role role : {Role::kSpare, Role::kViewer, Role::kOperator, Role::kRecorder, Role::kHub}) {
    scratch.store.add({name_of(role), role}, valid);
  }
  const std::string authority = text_of(scratch.store.folder() / "permissions_ca.pem");
  for (const Member& member : scratch.store.members()) {
    SCOPED_TRACE(member.name);
    const std::string document = verified(text_of(scratch.store.files_of(member.name).permissions), authority);
    const Grants found = grants_in(document);
    const Grants expected = grants_of(member.role, member.region);
    expect_same(found.publishes, expected.publishes);
    expect_same(found.subscribes, expected.subscribes);
    EXPECT_THAT(document, HasSubstr("<subject_name>" + member.subject() + "</subject_name>"));
    EXPECT_THAT(document, HasSubstr("<default>DENY</default>"));
  }
}

}  // namespace
}  // namespace aurasim::security
