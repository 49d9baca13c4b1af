#include "cli/text_files.h"

#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "config/launch.h"

namespace aurasim::cli {
namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: it cannot be written", file.string()));
}

}  // namespace

void write_texts(const std::string& out, const std::string& text,
                 const std::vector<std::pair<std::filesystem::path, std::string>>& beside) {
  if (out.empty()) {
    if (!beside.empty()) throw config::BadConfig({"meshes have to be written beside it: give --out FILE"});
    fmt::print("{}", text);
    return;
  }
  write_text(out, text);
  for (const auto& [file, obj] : beside) write_text(std::filesystem::path(out).parent_path() / file, obj);
}

}  // namespace aurasim::cli
