// Writes a node's parts of saved worlds, on threads beside the run. Each part gets a file of its own, which replaces an
// earlier one only when all regions have written theirs.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/order.h"
#include "core/world_cut.h"
#include "cut/part_store.h"
#include "cut/save_ledger.h"

namespace aurasim::cut {

/// Message for users at the end of a run, if PartWriter::regular_ones_failed().
inline constexpr const char* kNothingSaved = "no world was saved: none of those that --save-every was to save is whole";

enum class SaveKind {
  kAsked,    ///< a client has asked for it, by name
  kRegular,  ///< saved regularly (--save-every)
  kKept,     ///< kept to go on from when all processes have died at once (survival.disk)
};

struct PartFolders {
  std::filesystem::path saves;
  std::optional<std::filesystem::path> kept;  ///< this run's folder for kKept; nothing: it keeps none on disk
};

/// The run that a save belongs to.
struct SaveOf {
  std::uint64_t run = 0;   ///< all nodes of the run have this number, and no other run has it
  std::uint64_t life = 0;  ///< the same on all nodes; another one after a recovery or a change of the run
};

class PartWriter {
 public:
  using Clock = SaveLedger::Clock;

  /// `keep`: how many regular worlds stay.
  PartWriter(PartFolders folders, core::RegionId region, std::size_t regions, std::size_t keep)
      : folders_(std::move(folders)), region_(region), keep_(keep), ledger_(region, regions) {}

  void use_kept_folder(std::filesystem::path folder) { folders_.kept = std::move(folder); }
  /// Notes an order to save; its part comes with the state that it names.
  void expect(const core::Order& order) { expected_.push_back(order); }
  bool expects(core::Step step) const;
  /// Writes a complete part that was expected.
  void write(core::WorldCut part, const config::Launch& launch, const SaveOf& of);
  /// Writes a part without an order. `request`: the client's request; 0: no client asked for it. `world`: name of the
  /// saved world.
  void write(core::WorldCut part, const config::Launch& launch, const SaveOf& of, SaveKind kind, std::uint64_t request,
             const std::string& world);
  /// True if the last part of this kind is still being written.
  bool is_writing(SaveKind kind) const;
  /// Notes the saves that another region has or has not written, from its status.
  void receive(core::RegionId region, const std::vector<std::uint64_t>& saved,
               const std::vector<std::uint64_t>& not_saved) {
    ledger_.receive(region, saved, not_saved);
  }
  const SaveLedger& ledger() const { return ledger_; }

  struct Written {
    SaveKind kind{};
    std::uint64_t request = 0;
    core::Step step = 0;
    std::string file;
    std::string error;  ///< why the file was not written; empty: it was
  };
  /// The parts written since the last call. Removes files that are replaced or of no use.
  std::vector<Written> progress(Clock::time_point now);
  /// Messages for users since the last call.
  std::vector<std::string> take_words() { return std::exchange(words_, {}); }
  /// Returns when everything is written.
  void finish();
  /// True if regular worlds were to be saved and none of them has become whole.
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
  std::deque<Save> open_;                       ///< saves begun that are neither whole nor failed; oldest first
  std::map<SaveKind, std::deque<Save>> whole_;  ///< whole worlds without a client's request; oldest first
  enum class Failing { kNo, kYes, kSaid };
  std::map<SaveKind, Failing> failing_;  ///< whether saves have failed since the last one that became whole
  std::size_t regular_whole_ = 0, regular_failed_ = 0;
  std::vector<std::string> words_;
};

}  // namespace aurasim::cut
