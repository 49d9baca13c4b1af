// Long lists of a scene file are packed (config/packed_nodes.h). What is read, and what is refused where, stays the
// same.
#include "config/packed_nodes.h"

#include <fstream>

#include <fmt/format.h>
#include <malloc.h>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

constexpr std::string_view kLists[] = {"list"};

/// All that readers ask of a node.
void expect_same(const YamlNode& a, const YamlNode& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.quoted, b.quoted);
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.text, b.text);
  for (const auto& [one, other] : {std::pair(a.place, b.place), std::pair(a.key_place, b.key_place)}) {
    EXPECT_EQ(one.source, other.source);
    EXPECT_EQ(one.line, other.line);
    EXPECT_EQ(one.column, other.column);
  }
  ASSERT_EQ(a.children.size(), b.children.size());
  for (std::size_t i = 0; i < a.children.size(); ++i) expect_same(a.children[i], b.children[i]);
}

class PackedLists : public testing::Test {
 protected:
  std::filesystem::path file_of(const std::string& text) const { return workspace_.write("list.yaml", text); }
  YamlNode read(const std::string& text, std::span<const std::string_view> long_lists) const {
    Errors errors;
    errors.add_source("another");
    return read_yaml(file_of(text), errors, long_lists).value();
  }

  const Workspace workspace_;
};

std::string entries(int count) {
  std::string text = "before: &shared {deep: [1, 'two', [3]]}\nlist:\n";
  for (int i = 0; i < count; ++i) {
    switch (i % 5) {
      case 0:
        text += fmt::format("  - {{name: \"n {}\", position: [{}, -0.5,\n      1e3], '': x}}\n", i, i);
        break;
      case 1:
        text += fmt::format("  - &at{} plain\n\n", i);
        break;
      case 2:
        text += fmt::format("  - {{twice: *at{}, twice: ~, shared: *shared}}\n", i - 1);
        break;
      case 3:
        text += "  - deep: {er: {still: []}}\n    none:\n    long: |\n      a\n\n      b\n";
        break;
      default:
        text += fmt::format("  - [{}, [], {{}}, !!str 7, \"{}\"]\n", i, std::string(static_cast<std::size_t>(i), 'x'));
    }
  }
  return text + "after: *shared\n";
}

TEST_F(PackedLists, HaveTheEntriesOfTheFile) {
  const std::string text = entries(300);
  const YamlNode plain = read(text, {}), packed = read(text, kLists);
  ASSERT_TRUE(packed.find("list")->packed);
  const YamlNode& list = *plain.find("list");
  std::size_t i = 0;
  packed.find("list")->packed->for_each([&](const YamlNode& entry) {
    ASSERT_LT(i, list.children.size());
    expect_same(entry, list.children[i++]);
  });
  EXPECT_EQ(i, 300U);
  EXPECT_EQ(packed.find("list")->size(), 300U);
  expect_same(*packed.find("after"), *plain.find("after"));
}

TEST_F(PackedLists, AnEntryCanBeChanged) {
  YamlNode root = read(entries(200), kLists);
  const YamlNode copy = root;
  YamlNode& list = *root.find("list");
  list.entry(133).text = "changed";
  EXPECT_EQ(list.entry(133).text, "changed");
  EXPECT_EQ(list.entry(131).text, "plain");
  const auto texts = [](const YamlNode& node) {
    std::vector<std::string> texts;
    node.find("list")->packed->for_each([&](const YamlNode& entry) { texts.push_back(entry.text); });
    return texts;
  };
  std::vector<std::string> expected = texts(copy);
  EXPECT_EQ(expected[133], "");
  expected[133] = "changed";
  EXPECT_EQ(texts(root), expected);
}

/// As much for each entry as its text, not as much as its YamlNodes.
TEST_F(PackedLists, TakeLittleMemory) {
  constexpr int kEntries = 20'000;
  std::string text = "list:\n";
  for (int i = 0; i < kEntries; ++i)
    text += fmt::format("  - {{shape: tile, material: ground, position: [{}, 4, 0]}}\n", i);
  const auto in_use = [] { return mallinfo2().uordblks + mallinfo2().hblkhd; };
  const std::filesystem::path file = file_of(text);
  const std::size_t before = in_use();
  Errors errors;
  const std::optional<YamlNode> root = read_yaml(file, errors, kLists);
  EXPECT_LT(in_use() - before, std::size_t{80 * kEntries});
  EXPECT_EQ(root->find("list")->size(), std::size_t{kEntries});
}

TEST(SceneFile, ErrorsInLongListsHaveTheirPlaces) {
  const Workspace workspace;
  std::string text = "statics:\n";
  for (int i = 0; i < 200; ++i) text += "  - {shape: {box: {size: [1, 1, 1]}}, position: [0, 0, 0]}\n";
  text += "  - {shape: {box: {size: [1, 1, 1]}}, postion: [0, 0, 0]}\n";
  text += "  - {name: static 7, shape: {box: {size: [1, 1, 1]}}}\n  - {shape: none}\n";
  expect_errors(workspace.scene_errors(text),
                {"scene.yaml:202:39: statics[200].postion: unknown key, allowed: shape, name, material, path, belt",
                 "scene.yaml:203:5: statics[201]: found the name \"static 7\" a second time, allowed: each name once",
                 "scene.yaml:204:13: statics[202].shape: found \"none\""});
}

TEST(SceneFile, OverridesReachIntoLongLists) {
  const Workspace workspace;
  std::string text = "statics:\n";
  for (int i = 0; i < 200; ++i) text += "  - {shape: {box: {size: [1, 1, 1]}}, position: [0, 0, 0]}\n";
  const core::Scene scene =
      workspace.scene(text, {"scene.statics.150.position=[1, 2, 3]", "scene.statics[9].name=nine"});
  EXPECT_EQ(scene.statics.pose(150).p_WB, core::Vec3(1, 2, 3));
  EXPECT_EQ(scene.statics.pose(149).p_WB, core::Vec3(0, 0, 0));
  EXPECT_EQ(scene.statics.find("nine"), 9U);
  expect_errors(
      workspace.scene_errors(text, {"scene.statics.200.name=none"}),
      {"--set scene.statics.200.name=none: statics.200.name: found \"200\", allowed: an index from 0 to 199"});
}

}  // namespace
}  // namespace aurasim::config
