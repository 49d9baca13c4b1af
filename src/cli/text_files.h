// Texts that commands leave in files.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace aurasim::cli {

/// Writes `text` to `out` and each of `beside` where its path leads from there; folders are made. Without an `out` it
/// prints the text. Throws std::runtime_error if a file cannot be written, config::BadConfig if there is none for what
/// has to be beside it.
void write_texts(const std::string& out, const std::string& text,
                 const std::vector<std::pair<std::filesystem::path, std::string>>& beside);

}  // namespace aurasim::cli
