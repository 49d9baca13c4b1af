// Where a run keeps its newest states on disk, and from which of them it goes on.
#include "cut/kept_on_disk.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scratch_folder.h"

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class KeptOnDisk : public testing::Test {
 protected:
  KeptOnDisk() {
    launch_.file = folder_ / "demo.yaml";
    launch_.regions = core::RegionMap::columns(2, 10);
    save_.folder = (folder_ / "saves").string();
    save_.folder_is_given = true;
  }

  fs::path keep(std::uint64_t run, std::uint32_t part, core::Step step, std::int64_t at_ms,
                std::uint64_t in_folder_of = 0) {
    SavedWorld world;
    world.identity = identity_of(launch_);
    world.part = part;
    world.parts = 2;
    world.save = static_cast<std::uint64_t>(step) * 31 + run;
    world.run = run;
    world.saved_ms = at_ms;
    world.cut.step = step;
    const fs::path folder = kept_folder_of(save_.folder, in_folder_of == 0 ? run : in_folder_of);
    return PartStore(folder).write("state-" + std::to_string(step) + ".cut", world);
  }
  void keep_whole(std::uint64_t run, core::Step step, std::int64_t at_ms, std::uint64_t in_folder_of = 0) {
    for (std::uint32_t part : {0U, 1U}) keep(run, part, step, at_ms, in_folder_of);
  }
  std::string resumed() { return fs::relative(world_to_resume(launch_, save_), save_.folder).string(); }
  std::string refusal() {
    try {
      world_to_resume(launch_, save_);
      return {};
    } catch (const config::BadConfig& bad) {
      return bad.what();
    }
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
  config::Launch launch_;
  SaveArguments save_;
};

TEST_F(KeptOnDisk, IsInTheFolderOfSavesIfThatIsGiven) {
  EXPECT_EQ(kept_folder(launch_, save_), fs::path(save_.folder));
  save_.folder_is_given = false;
  EXPECT_FALSE(kept_folder(launch_, save_));
  launch_.survival.disk = "kept";
  EXPECT_EQ(kept_folder(launch_, save_), folder_ / "kept") << "relative to the launch file";
  save_.folder_is_given = true;
  EXPECT_EQ(kept_folder(launch_, save_), folder_ / "kept");
  launch_.survival.disk = "off";
  EXPECT_FALSE(kept_folder(launch_, save_));
  launch_.survival.disk = "";
  launch_.survival.on_death = config::OnDeath::kStop;
  EXPECT_FALSE(kept_folder(launch_, save_)) << "nobody keeps states to go back to";
}

TEST_F(KeptOnDisk, ARunGoesOnFromTheNewestStateThatIsWhole) {
  EXPECT_THAT(refusal(), HasSubstr("--resume: found no whole world of demo.yaml"));
  keep_whole(0xa, 600, 1'000);
  keep_whole(0xb, 60, 2'000);
  keep_whole(0xb, 120, 3'000);
  keep(0xb, 1, 180, 4'000);
  EXPECT_EQ(resumed(), "run-000000000000000b/state-120.cut");
}

TEST_F(KeptOnDisk, DamagedPartsAndThoseOfOtherRunsAndWorldsAreLeftOut) {
  keep_whole(0xb, 60, 2'000);
  keep_whole(0xc, 900, 9'000, 0xb);  // in the folder of another run
  const fs::path damaged = keep(0xb, 0, 120, 3'000);
  keep(0xb, 1, 120, 3'000);
  fs::resize_file(damaged, fs::file_size(damaged) / 2);
  std::ofstream(fs::path(save_.folder) / "run-000000000000000b" / "state-999.cut") << "junk";
  const config::Launch ours = launch_;
  launch_.time.substeps += 1;
  keep_whole(0xd, 700, 9'000);
  launch_ = ours;
  EXPECT_EQ(resumed(), "run-000000000000000b/state-60.cut");
}

TEST_F(KeptOnDisk, AWorldThatWasSavedLaterIsGoneOnFrom) {
  keep_whole(0xb, 60, 2'000);
  SavedWorld saved;
  saved.identity = identity_of(launch_);
  saved.run = 0xb;
  saved.saved_ms = 2'500;
  saved.cut.step = 100;
  PartStore(save_.folder).write("mine.cut", saved);
  EXPECT_EQ(resumed(), "mine.cut");
}

TEST_F(KeptOnDisk, AFolderThatCannotBeWrittenIsRefusedByName) {
  EXPECT_NO_THROW(check_room_for_saves(launch_, save_));
  EXPECT_TRUE(fs::is_empty(save_.folder));
  std::ofstream(folder_ / "file") << "no folder";
  save_.folder = (folder_ / "file" / "saves").string();
  try {
    check_room_for_saves(launch_, save_);
    FAIL();
  } catch (const config::BadConfig& bad) {
    EXPECT_THAT(bad.what(), HasSubstr("--saves: found " + save_.folder + ": Not a directory"));
  }
  save_.folder_is_given = false;
  EXPECT_NO_THROW(check_room_for_saves(launch_, save_)) << "nothing is to be saved";
  save_.every_s = 1;
  EXPECT_THROW(check_room_for_saves(launch_, save_), config::BadConfig);
}

}  // namespace
}  // namespace aurasim::cut
