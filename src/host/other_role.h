// A process that goes on in another role: a spare becomes the node of a region, a node that was replaced becomes a
// spare, and a host starts a second node for another region. Each is the same program with nearly the same command
// line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/ids.h"

namespace aurasim::host {

/// Command line of a node that takes over `region` of run `run`. `words`: command line of a node or a spare, the
/// program first.
std::vector<std::string> words_of_successor(const std::vector<std::string>& words, core::RegionId region,
                                            std::uint64_t run);

/// Command line of a spare. `words`: as in words_of_successor().
std::vector<std::string> words_of_spare(const std::vector<std::string>& words);

/// Command line of a node that has already checked whether the run goes on without it. `words`: as in
/// words_of_successor().
std::vector<std::string> words_of_plain_node(std::vector<std::string> words);

/// Path of the program that a link of /proc names, or of the file that has replaced it since.
std::filesystem::path program_at(const std::filesystem::path& link);

/// Full path of the program of this process.
std::string own_program();

/// Command line of this process, with the program's full path.
std::vector<std::string> own_words();

}  // namespace aurasim::host
