// A process that goes on in another role: a spare becomes the node of a region, a node that the others do without
// becomes a spare, and a node's host does the work of another one. Each is the same program with nearly the same words.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/ids.h"

namespace aurasim::cli {

/// `words`: of a node's or a spare's command line, the program first. Those of a node that takes `region` of run `run`
/// over.
std::vector<std::string> words_of_successor(const std::vector<std::string>& words, core::RegionId region,
                                            std::uint64_t run);

/// Likewise; those of a spare.
std::vector<std::string> words_of_spare(const std::vector<std::string>& words);

/// Likewise; those of a node that has looked whether the run goes on without it.
std::vector<std::string> words_of_plain_node(std::vector<std::string> words);

/// The program that a link of /proc names, or what has been put in its place since.
std::filesystem::path program_at(const std::filesystem::path& link);

/// How this process was started, with the program's own path.
std::vector<std::string> own_words();

}  // namespace aurasim::cli
