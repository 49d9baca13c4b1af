// Writes the texts that commands produce into files.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace aurasim::cli {

/// Writes `text` to `out`, and each text of `beside` to its path relative to `out`; folders are made. With empty `out`
/// it prints the text. Throws std::runtime_error if a file cannot be written, config::BadConfig if `out` is empty but
/// `beside` is not.
void write_texts(const std::string& out, const std::string& text,
                 const std::vector<std::pair<std::filesystem::path, std::string>>& beside);

}  // namespace aurasim::cli
