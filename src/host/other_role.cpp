#include "host/other_role.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "host/spawn.h"

namespace aurasim::host {
namespace {

/// Options that only a node has. Those of the second list have a value, as the next word or after '='.
constexpr std::string_view kOrSpare = "--or-spare";
constexpr std::array<std::string_view, 2> kFlagsOfNodes = {"--take-over", kOrSpare};
constexpr std::array<std::string_view, 2> kOptionsOfNodes = {"--region", "--start-time-out"};

bool has_value_inside(const std::string& word, std::string_view option) {
  return word.size() > option.size() && word.starts_with(option) && word[option.size()] == '=';
}

/// The command line without the options of a node. Nodes and spares both have the rest.
std::vector<std::string> without_region(const std::vector<std::string>& words) {
  std::vector<std::string> rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (std::ranges::find(kFlagsOfNodes, word) != kFlagsOfNodes.end()) continue;
    if (std::ranges::find(kOptionsOfNodes, word) != kOptionsOfNodes.end()) {
      ++i;
      continue;
    }
    const auto is_inside = [&](std::string_view option) { return has_value_inside(word, option); };
    if (std::ranges::any_of(kOptionsOfNodes, is_inside)) continue;
    rest.push_back(word);
  }
  return rest;
}

void name_command(std::vector<std::string>& words, const char* name) {
  const auto is_role = [](const std::string& word) { return word == "node" || word == "spare"; };
  *std::ranges::find_if(words, is_role) = name;
}

}  // namespace

std::vector<std::string> words_of_successor(const std::vector<std::string>& words, core::RegionId region,
                                            std::uint64_t run) {
  std::vector<std::string> successor = without_region(words);
  name_command(successor, "node");
  const auto names_run = [](const std::string& word) { return word == "--run" || has_value_inside(word, "--run"); };
  if (std::ranges::none_of(successor, names_run)) {
    successor.insert(successor.end(), {"--run", std::to_string(run)});
  }
  successor.insert(successor.end(), {"--take-over", "--region", std::to_string(core::value_of(region))});
  return successor;
}

std::vector<std::string> words_of_spare(const std::vector<std::string>& words) {
  std::vector<std::string> spare = without_region(words);
  name_command(spare, "spare");
  return spare;
}

std::vector<std::string> words_of_plain_node(std::vector<std::string> words) {
  std::erase(words, kOrSpare);
  return words;
}

/// After an upgrade the kernel names the file of this process "/usr/bin/aurasim (deleted)". The new file is in its
/// place.
std::filesystem::path program_at(const std::filesystem::path& link) {
  constexpr std::string_view kDeleted = " (deleted)";
  const std::filesystem::path program = std::filesystem::read_symlink(link);
  const std::string text = program.string();
  if (!text.ends_with(kDeleted) || std::filesystem::exists(program)) return program;
  return text.substr(0, text.size() - kDeleted.size());
}

std::string own_program() { return program_at("/proc/self/exe").string(); }

std::vector<std::string> own_words() {
  std::vector<std::string> words = own_command_line();
  words.at(0) = own_program();
  return words;
}

}  // namespace aurasim::host
