// Saved worlds in a folder, each as one file or as one file for each region's part. The names of parts hold the number
// of the save, so no save overwrites an earlier one. Knows nothing of runs, nodes and clocks.
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
  std::uint64_t save = 0;  ///< SavedWorld::save; 0: not in the name
  std::uint32_t part = 0, parts = 1;
};

/// The name of a part's file, such as "world.cut.00000000000000af.part-2-of-4".
std::string file_name(const PartName& name);
/// The parts of a file name; nothing if it is not the name of a part.
std::optional<PartName> part_name(const std::string& file_name);

/// A world of which all files exist. Only its header has been read.
struct StoredWorld {
  std::filesystem::path file;                ///< name of the whole world for read_world(), even if only its parts exist
  std::vector<std::filesystem::path> files;  ///< files that hold it: the whole, or all parts
  SavedWorld header;
};

/// Was `a` saved later than `b`? Compares the wall-clock times of the saves, then the states.
bool is_newer(const StoredWorld& a, const StoredWorld& b);

class PartStore {
 public:
  explicit PartStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Writes a part of the world named `world`, or all of it if there is only one part. Returns the file. Throws
  /// std::runtime_error on failure, and leaves no file then.
  std::filesystem::path write(const std::string& world, const SavedWorld& part) const;

  struct Listing {
    std::vector<StoredWorld> whole;    ///< newest first
    std::vector<std::string> ignored;  ///< for people: unusable files, each with the reason
  };
  Listing list() const;
  /// Reads and merges the files of a world. Throws BadCut.
  static SavedWorld read(const StoredWorld& world) { return merge_cuts(world.files); }

  /// Removes the files of part `part` of `world`, except those of the saves in `kept`. Half-written files are removed,
  /// too. An empty `world` means all worlds.
  void remove_others(const std::string& world, std::uint32_t part, std::span<const std::uint64_t> kept) const;
  /// Removes all parts of a region, and then the folder if it is empty.
  void remove_all_of(std::uint32_t part) const;

 private:
  std::filesystem::path folder_;
};

/// Reads the world in `file`, or else the newest readable world of the parts beside it. Throws BadCut.
SavedWorld read_world(const std::filesystem::path& file);

}  // namespace aurasim::cut
