// Worlds that lie in a folder: whole, or as one file of each region's part. The number of a save is in the names of its
// parts, so no save writes over an earlier one. Knows nothing of runs, nodes and clocks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cut/cut_file.h"

namespace aurasim::cut {

struct PartName {
  std::string world;       ///< name of the whole world's file
  std::uint64_t save = 0;  ///< SavedWorld::save; 0: it is not in the name
  std::uint32_t part = 0, parts = 1;
};

/// "world.cut.00000000000000af.part-2-of-4".
std::string file_name(const PartName& name);
/// Nothing: no part is called so.
std::optional<PartName> part_name(const std::string& file_name);

/// A world of which every file is there. Its header is read, its bodies are not.
struct StoredWorld {
  std::filesystem::path file;                ///< the whole, as read_world takes it, even where only its parts are there
  std::vector<std::filesystem::path> files;  ///< that it is in: itself, or all parts
  SavedWorld header;
};

/// By the wall clock of who has saved it, then by state.
bool is_newer(const StoredWorld& a, const StoredWorld& b);

class PartStore {
 public:
  explicit PartStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Writes a part of the world of this name, or the whole of it where it has one part only. Returns the file. Throws
  /// std::runtime_error, and leaves nothing of it then.
  std::filesystem::path write(const std::string& world, const SavedWorld& part) const;

  struct Listing {
    std::vector<StoredWorld> whole;    ///< newest first
    std::vector<std::string> ignored;  ///< for people: a file that is of no use, and why
  };
  Listing list() const;
  /// Throws BadCut.
  static SavedWorld read(const StoredWorld& world) { return merge_cuts(world.files); }

  /// Removes what other saves than these have left here of this region and world, half-written files as well. No world:
  /// of all.
  void remove_others(const std::string& world, std::uint32_t part, std::span<const std::uint64_t> kept) const;
  /// Removes all parts of a region, and then the folder if it is empty.
  void remove_all_of(std::uint32_t part) const;

 private:
  std::filesystem::path folder_;
};

/// FILE, or the newest world of its parts beside it that can be read. Throws BadCut.
SavedWorld read_world(const std::filesystem::path& file);

}  // namespace aurasim::cut
