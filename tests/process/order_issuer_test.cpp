// From commands to orders: ids, shapes and kinds that are told apart, and when nothing is taken.
#include "process/order_issuer.h"

#include <gtest/gtest.h>

#include "config/workspace.h"
#include "core/limits.h"
#include "transport/memory_transport.h"

namespace aurasim::process {
namespace {

class OrderIssuerTest : public ::testing::Test {
 protected:
  OrderIssuerTest() {
    node::NodeSetup setup;
    node_ = std::make_unique<node::Node>(setup, launch_.scene, launch_.regions, network_.endpoint(core::RegionId{0}));
    node_->use_meshes(meshes_);
    node_->start();
  }
  Issued issue(const core::Ask& ask, core::Step at_step = 0) {
    return issuer_.issue({++requests_, at_step, ask}, facts_, meshes_, *node_);
  }
  Issued spawn(const core::ClientShape& shape, double mass_kg = 1) {
    core::NewBody body;
    body.shape = shape;
    body.mass_kg = mass_kg;
    return issue(body);
  }
  void step(int steps = 30) {
    for (int i = 0; i < steps; ++i) node_->step();
  }

  config::Workspace workspace_;
  const config::Launch launch_ =
      workspace_.launch("scene: scene.yaml\nregions: {layout: columns, count: 1, width: 40}\n");
  transport::MemoryNetwork network_{{{}}, {}, 1};
  node::MeshSource meshes_ = [this](const core::MeshRef& mesh) -> std::optional<core::Shape> {
    ++mesh_lookups_;
    if (mesh.hash != 7) return {};
    return core::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  };
  std::unique_ptr<node::Node> node_;
  OrderIssuer issuer_{launch_};
  RunFacts facts_;
  std::uint64_t requests_ = 0;
  int mesh_lookups_ = 0;
};

TEST_F(OrderIssuerTest, ASpawnNamesTheBodyThatItMakes) {
  const Issued issued = spawn(core::Sphere{0.3});
  ASSERT_TRUE(issued.order) << issued.refused;
  const auto& order = std::get<core::Spawn>(issued.order->action);
  EXPECT_EQ(issued.object, core::ref_of(order.id));
  step();
  EXPECT_TRUE(node_->world().contains(order.id));
}

TEST_F(OrderIssuerTest, EachBodyGetsAnIdOfItsOwn) {
  EXPECT_NE(spawn(core::Sphere{0.3}).object, spawn(core::Sphere{0.3}).object);
}

TEST_F(OrderIssuerTest, TheHostSaysWhichBodyItHasMade) {
  const Issued issued = spawn(core::Sphere{0.3});
  std::vector<node::Applied> applied;
  for (int i = 0; i < 30; ++i) {
    const node::StepReport& report = node_->step();
    applied.insert(applied.end(), report.applied.begin(), report.applied.end());
  }
  ASSERT_EQ(applied.size(), 1u);
  EXPECT_EQ(applied[0].request, 1u);
  EXPECT_EQ(applied[0].object, issued.object);
}

TEST_F(OrderIssuerTest, AShapeAndAKindAreDefinedOnce) {
  spawn(core::Sphere{0.3});
  spawn(core::Sphere{0.3});
  spawn(core::Sphere{0.3}, 2);
  step();
  EXPECT_EQ(node_->scene().shapes.size(), 2u);
  EXPECT_EQ(node_->scene().prototypes.size(), 3u);
}

TEST_F(OrderIssuerTest, StaticsAreNumberedAheadOfTheScene) {
  const Issued first = issue(core::NewStatic{core::Sphere{1}, {}});
  const Issued second = issue(core::NewStatic{core::Sphere{1}, {}});
  EXPECT_EQ(first.object, core::ref_of(core::StaticId{0}));
  EXPECT_EQ(second.object, core::ref_of(core::StaticId{1}));
}

TEST_F(OrderIssuerTest, AMeshThatNobodyHasIsRefused) {
  EXPECT_EQ(spawn(core::MeshRef{8, core::MeshUse::kHull}).refused, "no node knows its shape");
}

TEST_F(OrderIssuerTest, AMeshIsNotAskedForAgainOnceItsShapeIsMade) {
  ASSERT_TRUE(spawn(core::MeshRef{7, core::MeshUse::kHull}).order);
  step();
  const int lookups = mesh_lookups_;
  EXPECT_TRUE(spawn(core::MeshRef{7, core::MeshUse::kHull}).order);
  step();
  EXPECT_EQ(mesh_lookups_, lookups);
}

TEST_F(OrderIssuerTest, NothingIsTakenWhileTheRunIsBeingChanged) {
  const core::Repartition same{{{-20, -20, 20, 20}}};
  ASSERT_TRUE(issue(same).order) << issue(same).refused;
  EXPECT_NE(spawn(core::Sphere{0.3}).refused.find("being changed"), std::string::npos);
  issuer_.reopen();
  EXPECT_TRUE(spawn(core::Sphere{0.3}).order);
}

TEST_F(OrderIssuerTest, ARunThatHasLostANodeIsNotChanged) {
  facts_.complete = false;
  EXPECT_NE(issue(core::ChangeScene{"tower"}).refused.find("a node has died"), std::string::npos);
  EXPECT_TRUE(spawn(core::Sphere{0.3}).order);
}

TEST_F(OrderIssuerTest, AnOrderIsForTheStateAskedForOrTheEarliest) {
  const Issued soon = issue(core::RemoveBody{core::BodyId{1}});
  const Issued later = issue(core::RemoveBody{core::BodyId{1}}, 500);
  EXPECT_GT(soon.order->at_step, 0);
  EXPECT_LT(soon.order->at_step, 30);
  EXPECT_EQ(later.order->at_step, 500);
}

}  // namespace
}  // namespace aurasim::process
