// Saved worlds in a folder: which are whole, which is the newest, what is in nobody's way.
#include "cut/part_store.h"

#include <csignal>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "messages/samples.h"
#include "scratch_folder.h"

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Store : public testing::Test {
 protected:
  static SavedWorld part(std::uint32_t number, core::Step step, std::uint64_t save) {
    SavedWorld world;
    world.part = number;
    world.parts = 2;
    world.save = save;
    world.saved_ms = 1000 * step;
    world.run = 5;
    world.cut.step = step;
    return world;
  }
  fs::path write(const std::string& name, std::uint32_t number, core::Step step, std::uint64_t save) const {
    return store().write(name, part(number, step, save));
  }
  void write_both(const std::string& name, core::Step step, std::uint64_t save) const {
    write(name, 0, step, save);
    write(name, 1, step, save);
  }
  PartStore store() const { return PartStore(folder_); }
  std::vector<core::Step> whole() const {
    std::vector<core::Step> steps;
    for (const StoredWorld& world : store().list().whole) steps.push_back(world.header.cut.step);
    return steps;
  }
  std::string refusal_of(const std::string& name) const {
    try {
      read_world(folder_ / name);
      return {};
    } catch (const BadCut& bad) {
      return bad.what();
    }
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

TEST(PartName, IsReadAsItIsWritten) {
  const std::string name = file_name({"world.cut", 0xaf, 2, 4});
  EXPECT_EQ(name, "world.cut.00000000000000af.part-2-of-4");
  const std::optional<PartName> found = part_name(name);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->world, "world.cut");
  EXPECT_EQ(found->save, 0xafU);
  EXPECT_EQ(found->part, 2U);
  EXPECT_EQ(found->parts, 4U);
  EXPECT_EQ(part_name("world.cut.part-2-of-4")->world, "world.cut") << "as older programs wrote it";
  for (const char* other : {"world.cut", "world.cut.part-4-of-4", "world.cut.part--of-4", "world.cut.part-1-of-x",
                            "world.cut.part-1of4", "", "world.cut.part-1-of-4.new"}) {
    EXPECT_FALSE(part_name(other)) << other;
  }
}

TEST_F(Store, AWorldIsWholeOnceAllItsPartsAreThere) {
  write("w.cut", 0, 120, 1);
  EXPECT_THAT(whole(), ElementsAre());
  EXPECT_THAT(store().list().ignored, ElementsAre(HasSubstr("1 of 2 parts are there")));
  EXPECT_THAT(refusal_of("w.cut"), HasSubstr("1 of 2 parts are there; part 1 is missing"));
  write("w.cut", 1, 120, 1);
  EXPECT_THAT(whole(), ElementsAre(120));
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 120);
  EXPECT_THAT(refusal_of("nothing.cut"), HasSubstr("no such file"));
}

TEST_F(Store, PartsOfTwoSavesAreNoWorld) {
  write("w.cut", 0, 120, 1);
  write("w.cut", 1, 120, 2);
  EXPECT_THAT(whole(), ElementsAre());
  EXPECT_NE(refusal_of("w.cut"), "");
}

/// The one disk was full, or its node died: what was saved before under the same name is loaded.
TEST_F(Store, ASaveThatIsNotWholeLeavesTheEarlierOne) {
  write_both("w.cut", 120, 1);
  write("w.cut", 0, 180, 2);
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 120);
  write("w.cut", 1, 180, 2);
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 180);
  EXPECT_THAT(whole(), ElementsAre(180, 120));
}

TEST_F(Store, ADamagedPartLeavesTheEarlierWorld) {
  write_both("w.cut", 120, 1);
  write("w.cut", 0, 180, 2);
  SavedWorld large = part(1, 180, 2);
  large.cut.bodies = messages::testing::hand_off_of(2000).cluster;
  const fs::path damaged = store().write("w.cut", large);
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 180);
  fs::resize_file(damaged, fs::file_size(damaged) - 5);
  EXPECT_THAT(whole(), ElementsAre(180, 120)) << "of a large file the header can be read still";
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 120);
  std::ofstream(damaged) << "junk";
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 120);
  EXPECT_THAT(whole(), ElementsAre(120));
}

TEST_F(Store, JunkIsNamedAndInNobodysWay) {
  write_both("state-60.cut", 60, 1);
  std::ofstream(folder_ / "state-900.cut") << "AURACUT3 and no more";
  std::ofstream(folder_ / "state-800.cut.00000000000000aa.part-0-of-2.new") << "half";
  std::ofstream(folder_ / "notes.txt") << "hello";
  fs::create_directory(folder_ / "state-700.cut");
  fs::copy_file(write("state-600.cut", 1, 600, 3), folder_ / "moved.cut");
  const PartStore::Listing listing = store().list();
  ASSERT_EQ(listing.whole.size(), 1U);
  EXPECT_EQ(listing.whole.front().header.cut.step, 60);
  EXPECT_EQ(listing.whole.front().header.run, 5U);
  EXPECT_THAT(listing.ignored, testing::UnorderedElementsAre(HasSubstr("state-900.cut"), HasSubstr("half-written"),
                                                             HasSubstr("no saved world"), HasSubstr("moved.cut"),
                                                             HasSubstr("1 of 2 parts")));
}

TEST_F(Store, TheNewestIsTheOneThatWasSavedLast) {
  write_both("state-600.cut", 600, 1);
  for (std::uint32_t number : {0U, 1U}) {  // the run has gone back
    SavedWorld later = part(number, 300, 2);
    later.saved_ms = 700'000;
    store().write("state-300.cut", later);
  }
  EXPECT_THAT(whole(), ElementsAre(300, 600));
}

TEST_F(Store, RemovesWhatIsReplacedAndNothingElse) {
  write_both("w.cut", 120, 1);
  write_both("w.cut", 180, 2);
  write_both("w.cut", 240, 3);
  write_both("other.cut", 60, 4);
  std::ofstream(folder_ / "w.cut.00000000000000aa.part-0-of-2.new") << "half";
  const std::vector<std::uint64_t> kept = {2, 3};
  store().remove_others("w.cut", 0, kept);
  EXPECT_EQ(files(), 7U) << "of region 1 all stay";
  store().remove_others("w.cut", 1, kept);
  EXPECT_THAT(whole(), ElementsAre(240, 180, 60));
  store().remove_all_of(0);
  EXPECT_TRUE(fs::exists(folder_));
  store().remove_all_of(1);
  EXPECT_FALSE(fs::exists(folder_));
}

/// No file may grow beyond some octets, as on a full disk.
TEST_F(Store, AFailedWriteLeavesNothing) {
  write_both("w.cut", 120, 1);
  ::rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, SIG_IGN);
  const ::rlimit full{20, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &full);
  EXPECT_THROW(write("w.cut", 0, 180, 2), std::runtime_error);
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(files(), 2U);
  EXPECT_EQ(read_world(folder_ / "w.cut").cut.step, 120);
}

}  // namespace
}  // namespace aurasim::cut
