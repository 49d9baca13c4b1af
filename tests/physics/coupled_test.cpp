// Coupled regions (physics/coupling.h): however the world is divided, the bits are those of one world.
#include <gtest/gtest.h>

#include "physics/coupled_worlds.h"
#include "physics/joint_scenes.h"
#include "physics/parcel.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::RegionMap;
using core::Vec3;

constexpr double kSmallBlock_m = 4;

Settings soft(double side_m = kSmallBlock_m) {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  settings.block_m = side_m;
  settings.top_speed_m_s = 8;  // some bodies are faster
  return settings;
}

core::Scene restless(core::Scene scene) {
  for (core::Prototype& kind : scene.prototypes) kind.can_sleep = false;
  return scene;
}

/// The coupled worlds have the bits of one world in each of `steps` states.
void expect_one_world(const core::Scene& scene, const Settings& settings, const RegionMap& map,
                      std::span<const BodyRecord> bodies, int steps) {
  RegionWorld one(scene, settings);
  one.add(bodies);
  CoupledWorlds many(scene, settings, map, bodies);
  for (int i = 0; i < steps; ++i) {
    one.step();
    many.step();
    const std::vector<BodyRecord> all = many.records();
    ASSERT_EQ(all.size(), one.records().size()) << "state " << i + 1;
    ASSERT_EQ(different(all, one.records()), std::vector<std::uint64_t>{}) << "state " << i + 1;
  }
}

std::vector<RegionMap> maps() {
  return {RegionMap::columns(2, 8), RegionMap::grid(2, 2, 8, 8), RegionMap::grid(3, 3, 4, 4)};
}

/// Piles of all shapes around the origin, which is a corner of blocks and of regions.
std::vector<BodyRecord> piles(int seed, int high) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::vector<BodyRecord> bodies;
  for (int i = 0; i < 9; ++i) {
    for (const BodyRecord& body : pile(random, bodies.size() + 1, high, 1.5 * (i % 3 - 1), 1.5 * (i / 3 - 1))) {
      bodies.push_back(body);
    }
  }
  return bodies;
}

TEST(Coupled, PilesOverACorner) {
  const core::Scene scene = restless(scene_of_all_shapes());
  for (int seed = 0; seed < 2; ++seed) {
    for (const RegionMap& map : maps()) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", regions " + std::to_string(map.size()));
      expect_one_world(scene, soft(), map, piles(seed, 8), 150);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Coupled, BodiesThatBounce) {
  core::Scene scene = restless(scene_of_all_shapes());
  for (core::Material& material : scene.materials) material.restitution = 0.8;
  expect_one_world(scene, soft(), RegionMap::grid(2, 2, 8, 8), piles(3, 6), 150);
}

/// Regions narrower than most bodies are long: nearly every contact is one of giants.
TEST(Coupled, BlocksSmallerThanBodies) {
  expect_one_world(restless(scene_of_all_shapes()), soft(1), RegionMap::grid(3, 3, 1, 1), piles(4, 6), 150);
}

TEST(Coupled, MechanismsWalkOverBorders) {
  core::Scene scene = scene_of_all_shapes();
  for (const double x : {-2.0, 0.0, 2.0}) place_creature(scene, x, {3, 1, 0});
  scene = restless(std::move(scene));
  for (const RegionMap& map : maps()) {
    expect_one_world(scene, soft(), map, initial_records(scene), 200);
    if (HasFatalFailure()) return;
  }
}

/// A plate over all regions lies on boxes of each of them, and balls fall onto it.
TEST(Coupled, AGiantOnTheBodiesOfAllRegions) {
  core::Scene scene = restless(scene_of(core::Box{{7, 7, 0.2}}));
  const auto small = [&scene](const core::Shape& shape) {
    core::Prototype kind;
    kind.shape = static_cast<std::uint32_t>(scene.shapes.size());
    kind.can_sleep = false;
    scene.shapes.push_back({"small", shape});
    scene.prototypes.push_back(kind);
  };
  small(core::Box{{0.4, 0.4, 0.4}}), small(core::Sphere{0.3});
  scene.prototypes[0].mass_kg = 30;
  std::vector<BodyRecord> bodies = {body(0, 0, {0, 0, 1.05})};
  for (int i = 0; i < 16; ++i) {
    const Vec3 p(3.7 * (i % 4 - 1.5), 3.7 * (i / 4 - 1.5), 0.4);
    bodies.push_back(body(static_cast<std::uint64_t>(2 * i + 1), 1, p));
    bodies.push_back(body(static_cast<std::uint64_t>(2 * i + 2), 2, p + Vec3(0.5, 0.3, 1.6)));
  }
  for (const RegionMap& map : maps()) {
    expect_one_world(scene, soft(), map, bodies, 150);
    if (HasFatalFailure()) return;
  }
}

TEST(Coupled, FastBodiesMeetFarFromHome) {
  const core::Scene scene = restless(scene_of_all_shapes());
  std::vector<BodyRecord> bodies = piles(5, 4);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double angle = static_cast<double>(i);
    bodies[i].v_WB = 120 * Vec3(std::cos(angle), std::sin(angle), 0.05);
  }
  expect_one_world(scene, soft(), RegionMap::grid(3, 3, 4, 4), bodies, 60);
}

/// A mail that changes one bit of one number of one parcel with movers.
class OneBitOff final : public core::SeamMail {
 public:
  explicit OneBitOff(core::SeamMail& mail) : mail_(mail) {}
  void post(core::RegionId to, std::span<const std::byte> parcel) override { mail_.post(to, parcel); }
  std::span<const std::byte> fetch(core::RegionId from) override {
    constexpr std::size_t kRow = 52;  // bytes of a mover
    const std::span<const std::byte> parcel = mail_.fetch(from);
    if (parcel.empty() || parcel.size() % kRow != 0 || ++rows_ != kChanged) return parcel;
    changed_.assign(parcel.begin(), parcel.end());
    changed_[6] ^= std::byte{1};  // speed along y
    return changed_;
  }
  bool has_changed() const { return rows_ >= kChanged; }

 private:
  static constexpr int kChanged = 150;

  core::SeamMail& mail_;
  int rows_ = 0;
  std::vector<std::byte> changed_;
};

TEST(Coupled, OneWrongBitOfAMoverShows) {
  const core::Scene scene = restless(scene_of_all_shapes());
  const std::vector<BodyRecord> bodies = piles(6, 6);
  RegionWorld one(scene, soft());
  one.add(bodies);
  CoupledWorlds many(scene, soft(), RegionMap::columns(2, 8), bodies);
  OneBitOff wrong(many.mail(0));
  many.use(0, wrong);
  for (int i = 0; i < 150; ++i) one.step(), many.step();
  EXPECT_TRUE(wrong.has_changed());
  EXPECT_NE(different(many.records(), one.records()), std::vector<std::uint64_t>{});
}

TEST(Coupled, BodiesComeToTheOwnersOfTheirBlocks) {
  const core::Scene scene = restless(scene_of_all_shapes());
  const std::vector<BodyRecord> rolling = {body(1, kSphere, {-3, 0.1, 0.4}, {4, 0, 0}), body(2, kBox, {5, 0.1, 0.45})};
  CoupledWorlds many(scene, soft(), RegionMap::columns(2, 8), rolling);
  EXPECT_TRUE(many[0].contains(core::BodyId{1}));
  int left = 0;
  for (int i = 0; i < 90; ++i) {
    many.step();
    left += static_cast<int>(many[0].left().size());
    ASSERT_NE(many[0].contains(core::BodyId{1}), many[1].contains(core::BodyId{1}));
  }
  EXPECT_EQ(left, 1);
  EXPECT_TRUE(many[1].contains(core::BodyId{1}));
  EXPECT_EQ(many[1].records().front().epoch, 1u);
  EXPECT_EQ(many[0].body_count(), 0u);
}

TEST(Coupled, AParcelThatIsTooShortIsRefused) {
  class Cut final : public core::SeamMail {
   public:
    void post(core::RegionId, std::span<const std::byte>) override {}
    std::span<const std::byte> fetch(core::RegionId) override { return {few_, 3}; }

   private:
    std::byte few_[3] = {};
  } cut;
  const core::Scene scene = scene_of_all_shapes();
  const core::BlockOwners owners(RegionMap::columns(2, 8), kSmallBlock_m, 1);
  RegionWorld world(scene, soft());
  world.couple({core::RegionId{0}, &owners, &cut});
  EXPECT_THROW(world.step(), BadParcel);
}

}  // namespace
}  // namespace aurasim::physics::testing
