// A saved world as a file, or as one file of each region's part. Eight bytes that say what it is and in which format,
// then one zstd frame with a checksum: a header in JSON, and the world as the messages that would carry it between
// nodes, so that whatever checks those checks this.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/world_cut.h"

namespace aurasim::cut {

/// What a world was computed with. Where something differs, going on has other bits, or makes no sense.
struct Identity {
  std::string program;      ///< version and commit
  std::string launch;       ///< name of the launch file, for people
  std::string scene;        ///< its name, for people
  std::string physics;      ///< solver, substeps and steps a second, for people
  std::uint64_t world = 0;  ///< hash of scene and physics (config::Launch::world_identity)
};

struct SavedWorld {
  Identity identity;
  std::uint32_t part = 0, parts = 1;  ///< 1: the whole
  std::uint64_t save = 0;             ///< the same for all parts that were saved together, and for no others
  core::WorldCut cut;
  std::uint64_t run = 0;      ///< number of the run that has saved it; 0: not known
  std::int64_t saved_ms = 0;  ///< wall clock when it was saved, since 1970; 0: not known
};

/// A file that cannot be used, and why; begins with its name.
class BadCut : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes the file under another name first: whoever reads finds a whole file or none, also after a loss of power.
/// Throws std::runtime_error, and leaves nothing then.
void write_cut(const std::filesystem::path& file, const SavedWorld& world);

/// Throws BadCut.
SavedWorld read_cut(const std::filesystem::path& file);

/// What it says of itself, without its bodies and all else: neither whole nor sound for sure. Throws BadCut.
SavedWorld read_header(const std::filesystem::path& file);

/// One world of the parts in these files. Throws BadCut if some are missing, or are not of one world.
SavedWorld merge_cuts(const std::vector<std::filesystem::path>& files);

/// Throws BadCut if the world was computed with anything else than `wanted`. Another program alone is let pass with
/// `other_program`: then it is what is returned, and bits may differ.
std::string check_identity(const std::filesystem::path& file, const Identity& found, const Identity& wanted,
                           bool other_program);

/// The bytes of a file, and a world from them: for files, and for tests of what is no file.
std::string encode(const SavedWorld& world);
SavedWorld decode(const std::string& bytes);
SavedWorld decode_header(const std::string& bytes);

}  // namespace aurasim::cut
