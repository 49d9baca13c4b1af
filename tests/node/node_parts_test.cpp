// The small parts of a node: which bodies have touched, which appear when, which moves of statics become orders, and
// what a saved world has of the orders.
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/horizon.h"
#include "node/births.h"
#include "node/node.h"
#include "node/ordered_scene.h"
#include "node/saved_world_check.h"
#include "node/static_orders.h"
#include "node/touches.h"
#include "transport/memory_transport.h"

namespace aurasim::node {
namespace {

using core::BodyId;
using core::Step;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kBirthStep_s = 1.0 / 60;

core::Snapshot state_with(std::vector<std::uint64_t> ids,
                          std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts) {
  core::Snapshot snapshot;
  for (const std::uint64_t id : ids) {
    core::BodyState body;
    body.id = BodyId{id};
    snapshot.bodies.push_back(body);
  }
  for (const auto& [a, b] : contacts) {
    core::Contact contact;
    contact.a = a;
    contact.b = b;
    snapshot.contacts.push_back(contact);
  }
  return snapshot;
}

TEST(TouchesOfBodies, AreRememberedAsLongAsTheBodyStays) {
  Touches touches;
  touches.note(state_with({1, 2, 3}, {{0, 1}}));
  touches.note(state_with({1, 2, 3}, {}));
  EXPECT_TRUE(touches.take(BodyId{1}));
  EXPECT_FALSE(touches.take(BodyId{1})) << "since the last call";
  EXPECT_FALSE(touches.take(BodyId{3}));
  touches.note(state_with({1, 3}, {}));
  touches.note(state_with({1, 2, 3}, {}));
  EXPECT_FALSE(touches.take(BodyId{2})) << "it has left and come back";
  EXPECT_FALSE(touches.take(BodyId{9})) << "not here";
}

core::Order spawn(std::uint64_t sequence, std::uint64_t id, Step at_step) {
  core::Order order;
  order.sequence = sequence;
  order.request = 100 + sequence;
  order.at_step = at_step;
  core::Spawn body;
  body.id = BodyId{id};
  order.action = body;
  return order;
}

std::vector<std::uint64_t> ids_of(const std::vector<NewBody>& bodies) {
  std::vector<std::uint64_t> ids;
  for (const NewBody& body : bodies) ids.push_back(core::value_of(body.record.id));
  return ids;
}

TEST(Births, BodiesOfOrdersComeWhenTheirStateIsNear) {
  ToBeBorn births;
  Injections injections;
  births.spawns = {spawn(1, 11, 50), spawn(2, 12, 40)};
  EXPECT_THAT(births.take_due({}, injections, 39, kBirthStep_s), IsEmpty());
  const std::vector<NewBody> due = births.take_due({}, injections, 40, kBirthStep_s);
  ASSERT_THAT(ids_of(due), ElementsAre(12));
  EXPECT_EQ(due[0].record.birth, 40);
  ASSERT_TRUE(due[0].order);
  EXPECT_EQ(due[0].order->request, 102U);
  EXPECT_THAT(ids_of(births.take_due({}, injections, 60, kBirthStep_s)), ElementsAre(11));
  EXPECT_THAT(births.take_due({}, injections, 60, kBirthStep_s), IsEmpty());
}

TEST(Births, InjectedBodiesAreTheSameFromWhateverStateOneGoesOn) {
  core::Scene scene;
  for (const double rate : {7.0, 0.4, 100.0, 0.0}) {
    core::Injector injector;
    injector.first_id = BodyId{1000 * (scene.injectors.size() + 1)};
    injector.rate_per_s = rate;
    injector.max_bodies = 40;
    injector.prototypes = {core::PrototypeId{0}};
    scene.injectors.push_back(injector);
  }
  const auto count = [&](Step state) {
    std::uint64_t born = 0;
    for (const core::Injector& injector : scene.injectors) born += core::injected_count(injector, state, kBirthStep_s);
    return born;
  };
  Injections injections;
  std::uint64_t born = 0;
  for (Step state = 1; state <= 200; ++state) {
    born += injections.between(scene, state - 1, state, kBirthStep_s).size();
    ASSERT_EQ(born, count(state)) << state;
  }
  EXPECT_EQ(injections.between(scene, 50, 60, kBirthStep_s).size(), count(60) - count(50));  // after a redo
}

core::Order shape_order(std::uint64_t sequence, Step at_step, const core::MeshRef& mesh) {
  core::Order order;
  order.sequence = sequence;
  order.request = 7;
  order.at_step = at_step;
  order.action = core::DefineShape{mesh};
  return order;
}

TEST(SceneWithOrders, ASavedWorldHasWhatChangedTheSceneAndWhatIsStillToCome) {
  OrderedScene scene{core::Scene{}};
  const core::MeshRef mesh{5};
  scene.use_meshes([](const core::MeshRef&) { return core::Shape(core::Sphere{3}); });
  scene.execute(shape_order(1, 10, mesh), 5);
  core::Order kick;
  kick.sequence = 2;
  kick.at_step = 20;
  kick.action = core::Impulse{};
  scene.execute(kick, 5);
  core::Order save = kick;
  save.sequence = 3;
  save.action = core::Save{};
  scene.execute(save, 5);
  EXPECT_EQ(scene.newest_change(), 1U);
  EXPECT_EQ(scene.scene().shapes.size(), 1U);
  EXPECT_EQ(scene.of_request(7)->sequence, 1U);
  EXPECT_EQ(scene.of_request(0), nullptr);

  core::WorldCut before;
  scene.add_to(before, 15, {&save, 1});
  ASSERT_EQ(before.orders.size(), 2U) << "a save is no part of a world";
  ASSERT_EQ(before.shapes.size(), 1U);
  EXPECT_EQ(before.shapes[0].mesh, mesh);
  core::WorldCut after;
  scene.add_to(after, 20, {});
  ASSERT_EQ(after.orders.size(), 1U) << "the kick is over, and the shape stays";
  EXPECT_EQ(after.orders[0].sequence, 1U);
}

TEST(SceneWithOrders, TheNewestSpawnStaysBecauseTheNextIdFollowsFromIt) {
  OrderedScene scene{core::Scene{}};
  scene.execute(spawn(1, 11, 1), 0);
  scene.execute(spawn(2, 12, 1), 0);
  core::WorldCut part;
  scene.add_to(part, 1000, {});
  ASSERT_EQ(part.orders.size(), 1U);
  EXPECT_EQ(part.orders[0].sequence, 2U);
}

core::Setpoints move_in(Step step) {
  core::Setpoints said;
  said.at_step = step;
  said.statics = {{core::StaticId{0}, {}, 1}};
  return said;
}

TEST(OrdersOfStatics, RecordedMovesComeInTheOrderOfTheirStates) {
  StaticOrders orders({move_in(30), move_in(10)});
  EXPECT_EQ(orders.next_recorded(9), nullptr);
  ASSERT_NE(orders.next_recorded(10), nullptr);
  EXPECT_EQ(orders.next_recorded(40)->step, 10);
  orders.pass();
  EXPECT_EQ(orders.next_recorded(40)->step, 30);
  orders.pass();
  EXPECT_EQ(orders.next_recorded(40), nullptr);
}

TEST(OrdersOfStatics, AreLimitedInEachState) {
  StaticOrders orders({});
  int given = 0;
  while (given < 1000 && orders.may_order(5)) ++given;
  EXPECT_EQ(given, 256);
  EXPECT_TRUE(orders.may_order(6));
}

TEST(OrdersOfStatics, ARunThatWentBackTooOftenWaitsForOrdersForAWhile) {
  StaticOrders orders({});
  orders.note_doubt(100);
  orders.note_doubt(200);
  EXPECT_TRUE(orders.are_believed(250));
  orders.note_doubt(300);
  EXPECT_FALSE(orders.are_believed(300));
  EXPECT_FALSE(orders.are_believed(1899));
  EXPECT_TRUE(orders.are_believed(1900)) << "the first is over";
}

TEST(OrdersOfStatics, TheirRequestIsTheSameOnEveryNode) {
  EXPECT_EQ(request_of(move_in(3), core::StaticId{1}), request_of(move_in(3), core::StaticId{1}));
  EXPECT_NE(request_of(move_in(3), core::StaticId{1}), request_of(move_in(3), core::StaticId{2}));
  EXPECT_NE(request_of(move_in(3), core::StaticId{1}), request_of(move_in(4), core::StaticId{1}));
  EXPECT_EQ(request_of(core::StaticEffect{3, {core::StaticId{1}, {}, 1}}), request_of(move_in(3), core::StaticId{1}));
}

TEST(WordsThatCameLate, MatterIfTheirStateIsComputedAgain) {
  LateWords words;
  words.note(10, 15);
  words.note(40, 41);
  EXPECT_EQ(words.that_matter(12, 20).size(), 1U);
  EXPECT_THAT(words.that_matter(16, 39), IsEmpty()) << "received before, and named later";
  EXPECT_EQ(words.that_matter(1, 100).size(), 2U);
  for (int i = 0; i < 1000; ++i) words.note(50, 51);
  EXPECT_EQ(words.that_matter(1, 100).size(), 256U) << "the last ones";
}

TEST(ASavedWorld, ThatNamesWhatTheSceneHasNotIsRefused) {
  core::Scene scene;
  core::WorldCut world;
  EXPECT_NO_THROW(check_orders(world, scene));
  EXPECT_NO_THROW(check_bodies(world, scene));
  world.bodies.bodies.resize(1);
  EXPECT_THROW(check_bodies(world, scene), std::invalid_argument) << "a kind that is not there";
  world.bodies.bodies.clear();
  world.orders = {spawn(1, 11, 5)};
  EXPECT_THROW(check_orders(world, scene), std::invalid_argument);
  world.orders.clear();
  world.step = 10;
  world.under_way = {{11, {}}};
  EXPECT_THROW(check_bodies(world, scene), std::invalid_argument) << "left after the saved state";
}

/// Runs one of so many nodes for 61 states, with redo, and returns the states in which it kept a cut.
std::vector<Step> states_kept(std::size_t regions) {
  const core::RegionMap map = core::RegionMap::columns(static_cast<int>(regions), 10);
  transport::MemoryNetwork network(std::vector<std::vector<core::RegionId>>(regions), {}, 1);
  NodeSetup setup;
  setup.protocol.sync = core::SyncMode::kFreeRunning;  // it waits for nobody
  setup.protocol.aura.redo = true;
  Node node(setup, core::Scene{}, map, network.endpoint(core::RegionId{0}));
  std::vector<Step> kept;
  const auto note = [&](const StepReport& report) {
    if (report.durations.cut_s > 0) kept.push_back(report.step);
    EXPECT_GT(report.durations.hash_s, 0);
  };
  note(node.start());
  node.save(43);
  while (node.current_step() < 61) {
    EXPECT_TRUE(node.ready());
    note(node.step());
  }
  return kept;
}

TEST(ANode, KeepsCutsForARedoAndWhatItIsAskedFor) {
  std::vector<Step> expected = {43};
  for (Step step = 0; step < 61; step += core::horizon::kBetweenCuts) expected.push_back(step);
  std::ranges::sort(expected);
  EXPECT_EQ(states_kept(2), expected);
}

TEST(ANode, ThatIsAloneKeepsOnlyWhatItIsAskedFor) { EXPECT_THAT(states_kept(1), ElementsAre(43)); }

}  // namespace
}  // namespace aurasim::node
