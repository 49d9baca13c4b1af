// How a node writes its parts of saved worlds: beside the run, each into a file of its own, which replaces an earlier
// one only when all regions have theirs.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/save_ledger.h"
#include "config/launch.h"
#include "core/order.h"
#include "core/world_cut.h"
#include "cut/part_store.h"

namespace aurasim::cli {

/// For people, at the end of such a run (PartWriter::regular_ones_failed).
inline constexpr const char* kNothingSaved = "no world was saved: none of those that --save-every was to save is whole";

enum class SaveKind {
  kAsked,    ///< somebody has asked for it, by name
  kRegular,  ///< --save-every
  kKept,     ///< to go on from when all processes have died at once (survival.disk)
};

struct PartFolders {
  std::filesystem::path saves;
  std::optional<std::filesystem::path> kept;  ///< of kKept, of this run; nothing: it keeps none on disk
};

/// Of which run a save is.
struct SaveOf {
  std::uint64_t run = 0;   ///< all nodes of the run have this number, and no other run has it
  std::uint64_t life = 0;  ///< the same on all nodes; another one after a recovery or a change of the run
};

class PartWriter {
 public:
  using Clock = SaveLedger::Clock;

  /// `keep`: so many regular worlds stay.
  PartWriter(PartFolders folders, core::RegionId region, std::size_t regions, std::size_t keep)
      : folders_(std::move(folders)), region_(region), keep_(keep), ledger_(region, regions) {}

  void use_kept_folder(std::filesystem::path folder) { folders_.kept = std::move(folder); }
  /// An order to save, in the state that it names.
  void expect(const core::Order& order) { expected_.push_back(order); }
  bool expects(core::Step step) const;
  /// A part that is complete, and that was expected.
  void write(core::WorldCut part, const config::Launch& launch, const SaveOf& of);
  /// A part that an order did not ask for. `request`: the client's; 0: nobody's.
  void write(core::WorldCut part, const config::Launch& launch, const SaveOf& of, SaveKind kind, std::uint64_t request,
             const std::string& world);
  /// The last part of this kind is still being written.
  bool is_writing(SaveKind kind) const;
  /// What another region says in its status.
  void hear(core::RegionId region, const std::vector<std::uint64_t>& saved,
            const std::vector<std::uint64_t>& not_saved) {
    ledger_.hear(region, saved, not_saved);
  }
  const SaveLedger& ledger() const { return ledger_; }

  struct Written {
    SaveKind kind{};
    std::uint64_t request = 0;
    core::Step step = 0;
    std::string file;
    std::string error;  ///< why there is none; empty: there is
  };
  /// What has been written since the last call. Removes files that are replaced, or of no use.
  std::vector<Written> progress(Clock::time_point now);
  /// Messages for people since the last call.
  std::vector<std::string> take_words() { return std::exchange(words_, {}); }
  /// Returns when everything is written.
  void finish();
  /// Regular worlds were to be saved, and none of them has become whole.
  bool regular_ones_failed() const { return regular_failed_ > 0 && regular_whole_ == 0; }

 private:
  struct Save {
    std::uint64_t number = 0;
    SaveKind kind{};
    std::uint64_t request = 0;
    core::Step step = 0;
    std::string world = {};
    std::filesystem::path folder = {}, file = {};
    std::string error = {};
  };
  struct Writing {
    std::uint64_t number = 0;
    std::future<Save> save;
  };
  void settle(const SaveLedger::Outcome& outcome);
  void note_whole(const Save& whole);
  void note_failed(const Save& failed, const std::vector<core::RegionId>& without);
  void limit_open(SaveKind kind);
  void drop(const Save& save);

  PartFolders folders_;
  core::RegionId region_;
  std::size_t keep_;
  std::vector<core::Order> expected_;
  std::vector<Writing> writing_;
  SaveLedger ledger_;
  std::deque<Save> open_;                       ///< begun, and neither whole nor failed; oldest first
  std::map<SaveKind, std::deque<Save>> whole_;  ///< that nobody has asked for; oldest first
  enum class Failing { kNo, kYes, kSaid };
  std::map<SaveKind, Failing> failing_;  ///< since the last save that became whole
  std::size_t regular_whole_ = 0, regular_failed_ = 0;
  std::vector<std::string> words_;
};

}  // namespace aurasim::cli
