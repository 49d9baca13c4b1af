#include "lab/scenes/world_files.h"

#include <fstream>
#include <stdexcept>

namespace aurasim::lab {
namespace {

/// One line for each entry of the first and of the second level: short to read, and to compare.
std::string in_lines(const Json& world) {
  std::string text = "{\n";
  for (auto section = world.begin(); section != world.end(); ++section) {
    if (section != world.begin()) text += ",\n";
    text += Json(section.key()).dump() + ": ";
    const Json& entries = section.value();
    if (!entries.is_structured() || entries.empty() || !entries.begin()->is_structured()) {
      text += entries.dump();
      continue;
    }
    text += entries.is_array() ? "[" : "{";
    for (auto entry = entries.begin(); entry != entries.end(); ++entry) {
      text += entry == entries.begin() ? "\n  " : ",\n  ";
      if (entries.is_object()) text += Json(entry.key()).dump() + ": ";
      text += entry.value().dump();
    }
    text += entries.is_array() ? "\n]" : "\n}";
  }
  return text + "\n}\n";
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

void write_world(const World& world, const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  write_text(directory / "scene.yaml", in_lines(world.scene));
  write_text(directory / kLaunchFile, in_lines(world.launch));
  write_text(directory / kInterferenceFile, in_lines(world.interference));
  for (const auto& [name, text] : world.meshes) write_text(directory / name, text);
}

}  // namespace aurasim::lab
