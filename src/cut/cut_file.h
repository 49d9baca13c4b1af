// A saved world as one file, or as one file for each region's part. A file begins with eight bytes that name the type
// and the format. One zstd frame with a checksum follows: a header in JSON, then the world, encoded as the messages
// that carry it between nodes. So the checks of those messages check files, too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/world_cut.h"

namespace aurasim::cut {

/// Identity of the scene, physics and program that computed a world. A run that differs in any of it goes on with other
/// bits, or cannot use the world.
struct Identity {
  std::string program;      ///< version and commit
  std::string launch;       ///< name of the launch file, for people
  std::string scene;        ///< name of the scene, for people
  std::string physics;      ///< solver, substeps and steps a second, for people
  std::uint64_t world = 0;  ///< hash of scene and physics (config::Launch::world_identity)
};

struct SavedWorld {
  Identity identity;
  std::uint32_t part = 0, parts = 1;  ///< number of this part, and of all parts; parts = 1: the whole world
  std::uint64_t save = 0;             ///< number of the save: the same for all parts saved together, and for no others
  core::WorldCut cut;
  std::uint64_t run = 0;      ///< number of the run that saved it; 0: not known
  std::int64_t saved_ms = 0;  ///< wall-clock time of the save, ms since 1970; 0: not known
};

/// Thrown for a file that cannot be used. The text begins with the file's name and gives the reason.
class BadCut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes a world into `file`. Writes under another name first, so readers find a whole file or none, also after a loss
/// of power. Throws std::runtime_error on failure, and leaves no file then.
void write_cut(const std::filesystem::path& file, const SavedWorld& world);

/// Reads a whole file. Throws BadCut.
SavedWorld read_cut(const std::filesystem::path& file);

/// Reads only the header; `cut` has no bodies. The rest of the file may be incomplete or damaged. Throws BadCut.
SavedWorld read_header(const std::filesystem::path& file);

/// Merges the parts in these files to one world. Throws BadCut if parts are missing, or are not of one world.
SavedWorld merge_cuts(const std::vector<std::filesystem::path>& files);

/// Throws BadCut if `found`, the identity of the world in `file`, differs from `wanted`. With `other_program`, another
/// program alone is accepted: its version is returned, and bits may differ.
std::string check_identity(const std::filesystem::path& file, const Identity& found, const Identity& wanted,
                           bool other_program);

/// Conversion between a world and the bytes of a file. Also for tests with damaged bytes.
std::string encode(const SavedWorld& world);
SavedWorld decode(const std::string& bytes);
SavedWorld decode_header(const std::string& bytes);

}  // namespace aurasim::cut
