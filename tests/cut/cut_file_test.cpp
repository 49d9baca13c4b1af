// Saved worlds as files: whole, in parts, damaged, cut short, and of other worlds.
#include "cut/cut_file.h"

#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>
#include <zstd.h>

#include "messages/samples.h"
#include "scratch_folder.h"

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;
using messages::testing::hand_off_of;
using messages::testing::same_bits;
using testing::HasSubstr;

class CutFile : public testing::Test {
 protected:
  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

SavedWorld world_of(std::size_t bodies) {
  SavedWorld world;
  world.identity = {"aurasim 0.1.0 (abc)", "demo.yaml", "demo", "soft_step, 8 substeps, 60 steps/s", 0xfeed};
  world.cut.step = 120;
  world.cut.births_known = 128;
  world.cut.bodies = hand_off_of(bodies).cluster;
  core::ClusterState other = hand_off_of(2).cluster;
  for (std::size_t i = 0; i < 2; ++i) other.bodies[i].id = core::BodyId{1'000'000 + i};
  other.manifolds.clear(), other.points.clear();
  world.cut.under_way = {{118, other}};
  world.cut.orders = messages::testing::one_order_of_each_kind();
  world.cut.last_order = 99;
  const core::ConvexHull hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.0 / 3}}};
  const core::TriangleMesh mesh{hull.points, {{0, 1, 2}, {1, 2, 3}}};
  const core::Compound compound{{{hull, {{1, 2, 3}, core::Quat(0.6, 0.8, 0, 0)}}, {hull, {}}}};
  world.cut.shapes = {{{1, core::MeshUse::kHull}, hull},
                      {{~0ULL, core::MeshUse::kTriangles}, mesh},
                      {{3, core::MeshUse::kDecomposition}, compound}};
  world.cut.meshes = {{1, mesh}, {3, mesh}};
  world.cut.setpoints = {
      {7, 1, 0, 119, {{core::BodyId{2}, core::Quantity::kForce, core::Vec3(1.0 / 3, 0, -2)}}, {}},
      {core::kRecordedClient, 2, 0, 130, {{core::BodyId{2}, core::Quantity::kSpin, {}}}, {{core::JointId{0}, {}}}}};
  return world;
}

bool same(const core::ClusterState& a, const core::ClusterState& b) {
  core::HandOff x, y;
  x.cluster = a, y.cluster = b;
  return messages::testing::same(x, y);
}

void expect_same(const SavedWorld& a, const SavedWorld& b) {
  EXPECT_EQ(a.identity.program, b.identity.program);
  EXPECT_EQ(a.identity.world, b.identity.world);
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.parts, b.parts);
  EXPECT_EQ(a.cut.step, b.cut.step);
  ASSERT_EQ(a.cut.setpoints.size(), b.cut.setpoints.size());
  for (std::size_t i = 0; i < a.cut.setpoints.size(); ++i) {
    const core::Setpoints &x = a.cut.setpoints[i], &y = b.cut.setpoints[i];
    EXPECT_EQ(std::tuple(x.client, x.sequence, x.at_step), std::tuple(y.client, y.sequence, y.at_step));
    ASSERT_EQ(x.bodies.size(), y.bodies.size());
    EXPECT_EQ(x.bodies[0].value, y.bodies[0].value);
    EXPECT_EQ(x.joints.size(), y.joints.size());
  }
  EXPECT_EQ(a.cut.births_known, b.cut.births_known);
  EXPECT_EQ(a.cut.last_order, b.cut.last_order);
  EXPECT_TRUE(same(a.cut.bodies, b.cut.bodies));
  ASSERT_EQ(a.cut.under_way.size(), b.cut.under_way.size());
  for (std::size_t i = 0; i < a.cut.under_way.size(); ++i) {
    EXPECT_EQ(a.cut.under_way[i].stamp, b.cut.under_way[i].stamp);
    EXPECT_TRUE(same(a.cut.under_way[i].cluster, b.cut.under_way[i].cluster));
  }
  ASSERT_EQ(a.cut.orders.size(), b.cut.orders.size());
  for (std::size_t i = 0; i < a.cut.orders.size(); ++i) {
    EXPECT_EQ(a.cut.orders[i].sequence, b.cut.orders[i].sequence);
    EXPECT_EQ(a.cut.orders[i].action.index(), b.cut.orders[i].action.index());
  }
  ASSERT_EQ(a.cut.shapes.size(), b.cut.shapes.size());
  for (std::size_t i = 0; i < a.cut.shapes.size(); ++i) {
    EXPECT_EQ(a.cut.shapes[i].mesh.hash, b.cut.shapes[i].mesh.hash);
    EXPECT_EQ(a.cut.shapes[i].shape.index(), b.cut.shapes[i].shape.index());
  }
  ASSERT_EQ(a.cut.meshes.size(), b.cut.meshes.size());
  for (std::size_t i = 0; i < a.cut.meshes.size(); ++i) {
    EXPECT_EQ(a.cut.meshes[i].hash, b.cut.meshes[i].hash);
    EXPECT_EQ(a.cut.meshes[i].mesh.points, b.cut.meshes[i].mesh.points);
    EXPECT_EQ(a.cut.meshes[i].mesh.triangles, b.cut.meshes[i].mesh.triangles);
  }
}

/// What is said of bytes that are no world; empty: they are.
std::string refusal_of(const std::string& bytes) {
  try {
    decode(bytes);
    return {};
  } catch (const BadCut& bad) {
    return bad.what();
  }
}

std::string refusal_of(const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const BadCut& bad) {
    return bad.what();
  }
}

TEST_F(CutFile, KeepsEveryBit) {
  const SavedWorld world = world_of(30);
  write_cut(folder_ / "a", world);
  const SavedWorld again = read_cut(folder_ / "a");
  expect_same(again, world);
  const auto& compound = std::get<core::Compound>(again.cut.shapes[2].shape);
  EXPECT_TRUE(same_bits(compound.parts[0].pose.q_WB.coeffs(), core::Quat(0.6, 0.8, 0, 0).coeffs()));
  EXPECT_TRUE(same_bits(std::get<core::ConvexHull>(compound.parts[0].shape).points[3], core::Vec3(0, 0, 1.0 / 3)));
  EXPECT_FALSE(fs::exists(folder_ / "a.new"));
}

TEST_F(CutFile, AnEmptyWorldIsOne) {
  SavedWorld world;
  world.cut.step = 3;
  expect_same(decode(encode(world)), world);
}

TEST_F(CutFile, PartsThatWereNotSavedTogetherAreRefused) {
  SavedWorld one = world_of(3), two = world_of(3);
  one.parts = two.parts = 2;
  two.part = 1;
  two.cut.under_way.clear();
  for (std::size_t i = 0; i < 3; ++i) two.cut.bodies.bodies[i].id = core::BodyId{500 + i};
  two.cut.bodies.manifolds.clear(), two.cut.bodies.points.clear();
  two.cut.orders.resize(2);
  const std::vector<fs::path> files = {folder_ / "one", folder_ / "two"};
  write_cut(files[0], one);
  write_cut(files[1], two);
  const SavedWorld whole = merge_cuts(files);
  EXPECT_EQ(whole.parts, 1U);
  EXPECT_EQ(whole.cut.bodies.bodies.size(), 6U);
  EXPECT_EQ(whole.cut.orders.size(), one.cut.orders.size());
  const auto refusal = [&] {
    write_cut(files[1], two);
    return refusal_of([&] { merge_cuts(files); });
  };
  two.cut.step = 121;
  EXPECT_THAT(refusal(), HasSubstr("not saved together"));
  two.cut.step = 120;
  two.save = 7;  // the same state, but of another run
  EXPECT_THAT(refusal(), HasSubstr("not saved together"));
  two.identity.world = 1;
  EXPECT_THAT(refusal(), HasSubstr("not of one world"));
}

/// A cluster is computed from the state in which it left to that of the world before the run begins.
TEST_F(CutFile, StatesWithoutEndAreRefused) {
  SavedWorld world = world_of(2);
  world.cut.step = std::int64_t{1} << 39;
  world.cut.births_known = world.cut.step + 8;
  EXPECT_THAT(refusal_of(encode(world)),
              HasSubstr("a cluster that left in state 118 is under way in state 549755813888"));
  world = world_of(2);
  world.cut.births_known = std::int64_t{1} << 39;
  EXPECT_THAT(refusal_of(encode(world)), HasSubstr("births are known up to state 549755813888"));
}

TEST_F(CutFile, OfAnotherWorldIsRefusedWithWhatWouldFit) {
  const Identity found = world_of(1).identity;
  Identity wanted = found;
  EXPECT_EQ(check_identity("f", found, wanted, false), "");
  wanted.world = 7;
  wanted.scene = "rain";
  EXPECT_THAT(refusal_of([&] { check_identity("f", found, wanted, true); }),
              testing::AllOf(HasSubstr("scene demo"), HasSubstr("scene rain"), HasSubstr("demo.yaml")));
  wanted = found;
  wanted.program = "aurasim 0.2.0 (def)";
  EXPECT_THAT(refusal_of([&] { check_identity("f", found, wanted, false); }), HasSubstr("--other-build"));
  EXPECT_THAT(check_identity("f", found, wanted, true), HasSubstr("0.2.0"));
}

TEST_F(CutFile, CutShortIsRefused) {
  const std::string bytes = encode(world_of(4));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_NE(refusal_of(bytes.substr(0, size)), "") << size;
  EXPECT_NE(refusal_of(std::string(bytes).append(1, 'x')), "");
}

/// Or means the same: there are bits in a frame that nobody reads.
TEST_F(CutFile, OneWrongByteIsRefused) {
  const std::string bytes = encode(world_of(4));
  std::mt19937_64 random(1);
  int unnoticed = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ static_cast<char>(1 + random() % 255));
    if (!refusal_of(damaged).empty()) continue;
    ++unnoticed;
    EXPECT_EQ(encode(decode(damaged)), bytes) << i;
  }
  EXPECT_LT(unnoticed, 5);
  EXPECT_THAT(refusal_of(std::string("AURACUT2").append(bytes.substr(8))),
              HasSubstr("format 2, and this program reads format 3"));
  EXPECT_THAT(refusal_of(std::string("PNG ....")), HasSubstr("no saved world"));
}

std::string unpacked(const std::string& bytes) {
  std::string inside(1 << 20, '\0');
  inside.resize(ZSTD_decompress(inside.data(), inside.size(), bytes.data() + 8, bytes.size() - 8));
  return inside;
}

std::string packed(const std::string& inside) {
  std::string out(ZSTD_compressBound(inside.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), inside.data(), inside.size(), 1));
  return std::string("AURACUT3").append(out);
}

/// Four bytes of its length, and a text.
std::string counted(const std::string& text) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(text.size() >> (8 * i) & 0xff));
  return bytes + text;
}

/// What has a sound checksum and makes no sense all the same.
TEST_F(CutFile, AnyBytesInsideAreRefusedOrSound) {
  const std::string bytes = encode(world_of(4));
  const std::string inside = unpacked(bytes);
  ASSERT_EQ(refusal_of(packed(inside)), "");
  std::mt19937_64 random(2);
  int refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string damaged = inside;
    for (std::uint64_t n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = random() % damaged.size();
      switch (random() % 4) {
        case 0:
          damaged[at] = static_cast<char>(random());
          break;
        case 1:
          damaged.erase(at, 1 + random() % 16);
          break;
        case 2:
          damaged.insert(at, 1 + random() % 16, static_cast<char>(random()));
          break;
        default:  // a length, maybe
          for (std::size_t k = at; k < std::min(at + 4, damaged.size()); ++k) damaged[k] = static_cast<char>(0xff);
      }
      if (damaged.empty()) damaged.push_back('x');
    }
    refused += !refusal_of(packed(damaged)).empty();
  }
  EXPECT_GT(refused, 2000);
  EXPECT_LT(refused, 20'000);
}

/// Of any kind where another is expected, in a frame whose checksum is right.
TEST_F(CutFile, AnyHeaderIsRefusedOrSound) {
  const std::string inside = unpacked(encode(world_of(2)));
  std::uint32_t length = 0;
  std::memcpy(&length, inside.data(), 4);
  const nlohmann::json header = nlohmann::json::parse(inside.substr(4, length));
  const std::string rest = inside.substr(4 + length);
  const auto refusal = [&](const std::string& text) { return refusal_of(packed(counted(text) + rest)); };
  const auto is_whole = [](const nlohmann::json& value) { return value.is_number_unsigned(); };
  ASSERT_EQ(refusal(header.dump()), "");
  const std::vector<nlohmann::json> others = {
      nullptr, true, -1, 1e300, "x", nlohmann::json::array(), {{"a", 1}}, std::uint64_t{0xffff'ffff'ffff'ffff}};
  for (const auto& [key, value] : header.items()) {
    nlohmann::json without = header;
    without.erase(key);
    const bool may_be_missing = key == "bodies" || key == "run" || key == "saved_ms";  // in older files
    EXPECT_EQ(refusal(without.dump()).empty(), may_be_missing) << key;
    for (const nlohmann::json& other : others) {
      nlohmann::json changed = header;
      changed[key] = other;
      const std::string why = refusal(changed.dump());
      if (why.empty()) {
        EXPECT_TRUE(key == "bodies" || !header[key].is_number() || is_whole(other)) << key << ": " << other;
      } else {
        EXPECT_THAT(why, HasSubstr("header"));
      }
    }
  }
  std::mt19937_64 random(3);
  int refused = 0;
  for (int round = 0; round < 5'000; ++round) {
    std::string text = header.dump();
    for (std::uint64_t n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = random() % text.size();
      text.replace(at, random() % 6, std::string(random() % 3, "0123456789\"{}[]:,-.eE\0xf"[random() % 24]));
      if (text.empty()) text.push_back('1');
    }
    refused += !refusal(text).empty();
  }
  EXPECT_GT(refused, 2'500);
}

/// No stack is deep enough for what is read by functions that call themselves.
TEST_F(CutFile, WhatIsNestedWithoutEndIsRefused) {
  std::mt19937_64 random(4);
  std::string deep;  // that does not compress, or it would be refused for that
  for (int i = 0; i < 200'000; ++i) deep += random() % 2 == 0 ? "[" : "{\"a\":";
  EXPECT_THAT(refusal_of(packed(counted(deep))), HasSubstr("header"));
  std::string inside = unpacked(encode(SavedWorld{}));
  inside.back() = 4;  // a shape instead of the end
  EXPECT_THAT(refusal_of(packed(inside + counted(deep))), HasSubstr("a shape"));
}

/// Frames by hand: blocks of 128 KiB of one byte each, which take four.
TEST_F(CutFile, WhatBecomesTooLargeIsRefusedBeforeItDoes) {
  const std::string magic = "AURACUT3\x28\xb5\x2f\xfd";
  const std::string block("\x02\x00\x10\x00", 4);
  std::string bomb = magic + std::string("\x00\x50", 2);
  for (int i = 0; i < 80'000; ++i) bomb += block;
  EXPECT_THAT(refusal_of(bomb), HasSubstr("larger than any world")) << "10 GB of 320 kB";
  std::string claim = magic + std::string("\xc0\x50", 2);  // with the size of its content, in eight bytes
  for (int i = 0; i < 8; ++i) claim.push_back(static_cast<char>((std::uint64_t{100} << 30) >> (8 * i) & 0xff));
  claim += block;
  EXPECT_THAT(refusal_of(claim), HasSubstr("cut short")) << "says 100 GB, and is a few bytes";
}

TEST_F(CutFile, AHeaderIsReadAlone) {
  const SavedWorld world = world_of(300);
  std::string bytes = encode(world);
  EXPECT_EQ(decode_header(bytes).cut.step, 120);
  EXPECT_EQ(decode_header(bytes).identity.world, 0xfeedU);
  EXPECT_TRUE(decode_header(bytes).cut.bodies.bodies.empty());
  EXPECT_THROW(decode_header("AURACUT3"), BadCut);
}

TEST_F(CutFile, AFullDiskLeavesNoFile) {
  EXPECT_THROW(write_cut("/dev/full/a", world_of(1)), std::runtime_error);
  EXPECT_THROW(write_cut(folder_ / "nowhere" / "a", world_of(1)), std::runtime_error);
}

}  // namespace
}  // namespace aurasim::cut
