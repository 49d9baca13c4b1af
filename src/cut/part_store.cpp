#include "cut/part_store.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHalfWritten = ".new";  // extension of the name under which write_cut() writes
constexpr std::string_view kPart = ".part-", kOf = "-of-";
constexpr std::size_t kDigits = 16;  // digits of a save's number in a name

template <class Number>
std::optional<Number> number_in(std::string_view text, int base) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// A file with the name of a world or of a part, and its header.
struct Found {
  fs::path file;
  std::string world;
  SavedWorld header;
};

/// Files with the same key are parts of one world.
using Key = std::tuple<std::string, std::uint64_t, core::Step, std::uint32_t>;

Key key_of(const Found& found) { return {found.world, found.header.save, found.header.cut.step, found.header.parts}; }

struct Contents {
  std::map<Key, std::vector<Found>> worlds;
  std::vector<std::string> ignored;
};

void add(const fs::path& file, Contents& contents) {
  const std::string name = file.filename().string();
  if (name.ends_with(kHalfWritten)) {
    contents.ignored.push_back(fmt::format("{}: half-written", file.string()));
    return;
  }
  try {
    Found found{file, name, read_header(file)};
    const std::optional<PartName> part = part_name(name);
    if (part) found.world = part->world;
    if (!part && found.header.parts > 1) {
      throw BadCut(fmt::format("{}: this is part {} of {}, and is not called so", file.string(), found.header.part,
                               found.header.parts));
    }
    contents.worlds[key_of(found)].push_back(std::move(found));
  } catch (const BadCut& bad) {
    contents.ignored.emplace_back(bad.what());
  }
}

/// The files in a folder that belong to `world`, or to any world if it is empty.
Contents contents_of(const fs::path& folder, const std::string& world = {}) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!world.empty() && !name.starts_with(world + ".")) continue;
    std::error_code ignored;
    if (entry.is_regular_file(ignored)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  Contents contents;
  for (const fs::path& file : files) add(file, contents);
  return contents;
}

/// Is each part there exactly once?
bool is_whole(const std::vector<Found>& parts) {
  std::vector<std::uint32_t> there;
  for (const Found& one : parts) there.push_back(one.header.part);
  std::ranges::sort(there);
  const auto last = std::ranges::unique(there).begin();
  return last == there.end() && there.size() == parts.front().header.parts;
}

StoredWorld stored(const fs::path& folder, const std::vector<Found>& parts) {
  StoredWorld world{folder / parts.front().world, {}, parts.front().header};
  for (const Found& one : parts) {
    world.files.push_back(one.file);
    world.header.saved_ms = std::max(world.header.saved_ms, one.header.saved_ms);
  }
  return world;
}

std::string of_parts(std::size_t there, std::uint32_t all) {
  return fmt::format("{} of {} parts are there", there, all);
}

PartStore::Listing listing_of(const fs::path& folder, const Contents& contents) {
  PartStore::Listing listing;
  listing.ignored = contents.ignored;
  for (const auto& [key, parts] : contents.worlds) {
    if (is_whole(parts)) {
      listing.whole.push_back(stored(folder, parts));
    } else {
      listing.ignored.push_back(fmt::format("{}: state {}: {}", parts.front().file.string(), std::get<core::Step>(key),
                                            of_parts(parts.size(), parts.front().header.parts)));
    }
  }
  std::ranges::stable_sort(listing.whole, is_newer);
  return listing;
}

/// Throws BadCut for `file`, of which no world has all parts. The text names what is missing or unusable.
[[noreturn]] void refuse_parts(const fs::path& file, const Contents& contents) {
  const std::vector<Found>* most = nullptr;
  for (const auto& [key, parts] : contents.worlds) {
    if (std::get<std::string>(key) != file.filename().string()) continue;
    if (most == nullptr || parts.size() > most->size()) most = &parts;
  }
  if (most != nullptr && contents.ignored.empty()) {
    merge_cuts(stored(file.parent_path(), *most).files);
    throw BadCut(fmt::format("{}: {}", file.string(), of_parts(most->size(), most->front().header.parts)));
  }
  if (!contents.ignored.empty()) throw BadCut(contents.ignored.front());
  throw BadCut(fmt::format("{}: there is no such file, and no parts of it", file.string()));
}

/// Removes the files of part `part`, also half-written ones, whose name is_meant(name).
template <class Predicate>
void remove_parts(const fs::path& folder, std::uint32_t part, Predicate&& is_meant) {
  std::vector<fs::path> meant;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::string name = entry.path().filename().string();
    if (name.ends_with(kHalfWritten)) name.resize(name.size() - kHalfWritten.size());
    const std::optional<PartName> found = part_name(name);
    if (found && found->part == part && is_meant(*found)) meant.push_back(entry.path());
  }
  for (const fs::path& file : meant) fs::remove(file, ignored);
}

}  // namespace

bool is_newer(const StoredWorld& a, const StoredWorld& b) {
  return std::tuple(a.header.saved_ms, a.header.cut.step) > std::tuple(b.header.saved_ms, b.header.cut.step);
}

std::string file_name(const PartName& name) {
  return fmt::format("{}.{:016x}{}{}{}{}", name.world, name.save, kPart, name.part, kOf, name.parts);
}

std::optional<PartName> part_name(const std::string& file_name) {
  const std::string_view name = file_name;
  const std::size_t part = name.rfind(kPart);
  if (part == std::string_view::npos) return std::nullopt;
  const std::string_view numbers = name.substr(part + kPart.size());
  const std::size_t of = numbers.find(kOf);
  if (of == std::string_view::npos) return std::nullopt;
  const auto number = number_in<std::uint32_t>(numbers.substr(0, of), 10);
  const auto parts = number_in<std::uint32_t>(numbers.substr(of + kOf.size()), 10);
  if (!number || !parts || *number >= *parts) return std::nullopt;
  PartName found{std::string(name.substr(0, part)), 0, *number, *parts};
  const std::size_t dot = found.world.rfind('.');
  if (dot == std::string::npos || found.world.size() - dot - 1 != kDigits)
    return found;  // older programs wrote names without the number of the save
  if (const auto save = number_in<std::uint64_t>(std::string_view(found.world).substr(dot + 1), 16)) {
    found.save = *save;
    found.world.resize(dot);
  }
  return found;
}

fs::path PartStore::write(const std::string& world, const SavedWorld& part) const {
  fs::create_directories(folder_);
  const bool is_the_whole = part.parts == 1;
  const fs::path file = folder_ / (is_the_whole ? world : file_name({world, part.save, part.part, part.parts}));
  write_cut(file, part);
  return file;
}

PartStore::Listing PartStore::list() const { return listing_of(folder_, contents_of(folder_)); }

void PartStore::remove_others(const std::string& world, std::uint32_t part, std::span<const std::uint64_t> kept) const {
  remove_parts(folder_, part, [&](const PartName& name) {
    return (world.empty() || name.world == world) && std::ranges::find(kept, name.save) == kept.end();
  });
}

void PartStore::remove_all_of(std::uint32_t part) const {
  remove_parts(folder_, part, [](const PartName&) { return true; });
  std::error_code ignored;
  fs::remove(folder_, ignored);
}

SavedWorld read_world(const fs::path& file) {
  if (fs::exists(file)) {
    SavedWorld world = read_cut(file);
    if (world.parts == 1) return world;
    throw BadCut(fmt::format("{}: this is part {} of {}; name the file without .part-...", file.string(), world.part,
                             world.parts));
  }
  const Contents contents = contents_of(file.parent_path(), file.filename().string());
  std::optional<BadCut> first;
  for (const StoredWorld& world : listing_of(file.parent_path(), contents).whole) {
    if (world.file.filename() != file.filename()) continue;
    try {
      return PartStore::read(world);
    } catch (const BadCut& bad) {
      if (!first) first = bad;
    }
  }
  if (first) throw BadCut(*first);
  refuse_parts(file, contents);
}

}  // namespace aurasim::cut
