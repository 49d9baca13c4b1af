// What the store of clients' meshes keeps and what it lets go.
#include "overseer/shape_store.h"

#include <gtest/gtest.h>

namespace aurasim::overseer {
namespace {

/// Has as many points as the text says.
std::variant<core::TriangleMesh, std::string> read(const std::string&, std::string_view bytes) {
  core::TriangleMesh mesh;
  mesh.points.resize(std::stoul(std::string(bytes)));
  return mesh;
}

std::uint64_t add(ShapeStore& store, const std::string& bytes) {
  const auto stored = store.add("mesh.obj", bytes);
  const auto* kept = std::get_if<ShapeStore::Stored>(&stored);
  return kept == nullptr ? 0 : kept->hash;
}

TEST(ShapeStore, ThereIsAlwaysRoomForAnotherMesh) {
  ShapeStore store(read);
  const std::uint64_t first = add(store, "4");
  const std::uint64_t second = add(store, "5");
  for (int i = 0; i < 300; ++i) {
    EXPECT_NE(add(store, std::to_string(100 + i)), 0U) << i;
    EXPECT_NE(store.find(first), nullptr) << "it is asked for again and again";
  }
  EXPECT_EQ(store.count(), 256U);
  EXPECT_EQ(store.find(second), nullptr) << "nobody has asked for it";
}

TEST(ShapeStore, LargeMeshesDriveOutMany) {
  ShapeStore store(read);
  for (int i = 0; i < 100; ++i) add(store, std::to_string(1000 + i));
  const std::uint64_t large = add(store, "9950000");
  EXPECT_NE(store.find(large), nullptr);
  EXPECT_LT(store.count(), 60U);
  EXPECT_EQ(add(store, "10000001"), 0U) << "more than all may have together";
  EXPECT_NE(store.find(large), nullptr);
}

TEST(ShapeStore, WhoHoldsAMeshKeepsIt) {
  ShapeStore store(read);
  const auto held = store.find(add(store, "7"));
  for (int i = 0; i < 300; ++i) add(store, std::to_string(100 + i));
  EXPECT_EQ(held->points.size(), 7U);
}

}  // namespace
}  // namespace aurasim::overseer
