// Observers ask, nodes tell each of them what it has asked for, and nobody else.
#include "dds/observation_bus.h"

#include <memory>

#include <gtest/gtest.h>

#include "dds/typed_endpoints.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using core::RegionId;
using testing::holds_in_time;
using testing::settings_for;

constexpr ObserverSettings kRun{testing::kMapVersion, 4, 7};

core::Observation observation_of(core::Step stamp, RegionId source = RegionId{1}) {
  core::Observation observation;
  observation.source = source;
  observation.stamp = stamp;
  observation.map_version = testing::kMapVersion;
  return observation;
}

core::Interest all_bodies() {
  core::Interest interest;
  interest.all = true;
  return interest;
}

class ObservationBus : public ::testing::Test {
 protected:
  std::size_t asked() {
    node_.look();
    return node_.asked().size();
  }

  Participant at_node_{settings_for(own_domain())}, at_client_{settings_for(own_domain())};
  ObservationServer node_{at_node_, RegionId{1}};
};

/// What comes before the observer has heard of the new scene is refused here, and a node tells each state once.
TEST_F(ObservationBus, AnObserverAsksAnewWhenTheRunHasChanged) {
  ObserverEndpoint observer(at_client_, kRun);
  observer.want(all_bodies());
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1; }));
  const std::uint64_t before = node_.asked().front().arrivals;
  observer.use(kRun);
  ObserverSettings changed = kRun;
  changed.prototype_count += 3;
  observer.use(changed);
  EXPECT_TRUE(holds_in_time([&] { return asked() == 1 && node_.asked().front().arrivals > before; }));
  EXPECT_EQ(node_.asked().front().interest->all, true);
  EXPECT_EQ(node_.asked().front().interest->sequence, 1U) << "it wants nothing else";
}

TEST_F(ObservationBus, EachObserverIsToldWhatIsForIt) {
  ObserverEndpoint one(at_client_, kRun), other(at_client_, kRun);
  core::Interest interest = all_bodies();
  interest.every = 5;
  one.want(interest);
  other.want(all_bodies());
  ASSERT_TRUE(holds_in_time([&] { return asked() == 2; }));
  for (const ObservationServer::Asked& asked : node_.asked()) {
    const bool is_one = asked.interest->every == 5;
    EXPECT_EQ(asked.key, is_one ? one.client() : other.client());
    EXPECT_TRUE(node_.send(asked.key, observation_of(is_one ? 10 : 20)));
  }
  for (ObserverEndpoint* endpoint : {&one, &other}) {
    std::vector<core::Observation> told;
    ASSERT_TRUE(holds_in_time([&] {
      for (core::Observation& observation : endpoint->take()) told.push_back(std::move(observation));
      return !told.empty();
    }));
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].stamp, endpoint == &one ? 10 : 20);
  }
}

TEST_F(ObservationBus, ALaterInterestTakesThePlaceOfTheFirst) {
  ObserverEndpoint observer(at_client_, kRun);
  EXPECT_EQ(observer.want(all_bodies()), 1U);
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1; }));
  const std::uint64_t arrivals = node_.asked().front().arrivals;
  core::Interest narrow;
  narrow.boxes = {{{0, 0, 0}, {1, 1, 1}}};
  EXPECT_EQ(observer.want(narrow), 2U);
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1 && node_.asked().front().interest->sequence == 2; }));
  EXPECT_FALSE(node_.asked().front().interest->all);
  EXPECT_GT(node_.asked().front().arrivals, arrivals);
}

TEST_F(ObservationBus, AnObserverThatHasEndedIsForgotten) {
  auto observer = std::make_unique<ObserverEndpoint>(at_client_, kRun);
  observer->want(all_bodies());
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1; }));
  observer.reset();
  EXPECT_TRUE(holds_in_time([&] { return asked() == 0 && !node_.anybody_asks(); }));
}

TEST_F(ObservationBus, AnObserverThatDoesNotTakeHoldsNobodyUp) {
  ObserverEndpoint observer(at_client_, kRun);
  observer.want(all_bodies());
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1; }));
  const auto begin = std::chrono::steady_clock::now();
  for (core::Step step = 0; step < 1000; ++step) EXPECT_TRUE(node_.send(observer.client(), observation_of(step)));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

/// Whatever a client sends: it is refused and counted, and others are served.
TEST_F(ObservationBus, WhatIsUnsoundOrTooMuchIsRefusedAndHarmsNobody) {
  ObserverEndpoint observer(at_client_, kRun);
  observer.want(all_bodies());
  ASSERT_TRUE(holds_in_time([&] { return asked() == 1; }));
  Participant at_flood(settings_for(own_domain()));
  Wakeup wakeup;
  TypedWriter<wire::Interest> flood(at_flood.domain(), on(TopicId::kInterest), wakeup);
  ASSERT_TRUE(holds_in_time([&] { return flood.foreign_reader_count() == 1; }));
  core::Interest insane;
  insane.client = 77;
  insane.boxes = {{{1, 1, 1}, {0, 0, 0}}};
  flood.send(insane, std::uint64_t{0});
  ASSERT_TRUE(holds_in_time([&] {
    asked();
    return node_.refused() > 0;
  }));
  core::Interest stolen = all_bodies();
  stolen.client = observer.client();
  stolen.sequence = 1000;
  const std::uint64_t before = node_.refused();
  flood.send(stolen, std::uint64_t{0});
  ASSERT_TRUE(holds_in_time([&] {
    asked();
    return node_.refused() > before;
  }));
  EXPECT_EQ(node_.asked().front().interest->sequence, 1U) << "another client's";
  EXPECT_TRUE(holds_in_time([&, sequence = std::uint64_t{0}]() mutable {
    ++sequence;
    for (std::uint64_t client = 100; client < 110; ++client) {
      core::Interest one = all_bodies();
      one.client = client;
      one.sequence = sequence;
      flood.send(one, std::uint64_t{0});
    }
    asked();
    return node_.refused() > before + 50;
  }));
  EXPECT_EQ(node_.asked().back().key == observer.client() || node_.asked().front().key == observer.client() ||
                node_.send(observer.client(), observation_of(3)),
            true);
}

}  // namespace
}  // namespace aurasim::dds
