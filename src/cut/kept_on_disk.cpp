#include "cut/kept_on_disk.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace aurasim::cut {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRun = "run-";
constexpr const char* kOff = "off";
constexpr std::size_t kRoom_B = 16 << 10;  // size of a small world's part

std::optional<std::uint64_t> run_of(const fs::path& folder) {
  const std::string name = folder.filename().string();
  std::uint64_t run = 0;
  if (!name.starts_with(kRun)) return std::nullopt;
  const char* const end = name.data() + name.size();
  const auto [last, error] = std::from_chars(name.data() + kRun.size(), end, run, 16);
  return error == std::errc() && last == end ? std::optional(run) : std::nullopt;
}

/// Why no file with content can be written in the folder. Null if it can.
const char* problem_with_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return std::strerror(error.value());
  const fs::path probe = folder / fmt::format(".room-{}.new", ::getpid());
  const int fd = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return std::strerror(errno);
  const std::string room(kRoom_B, '\0');
  int why = 0;
  errno = ENOSPC;  // for the case that only some octets are written
  if (::write(fd, room.data(), room.size()) != static_cast<ssize_t>(room.size()) || ::fsync(fd) != 0) why = errno;
  ::close(fd);
  fs::remove(probe, error);
  return why == 0 ? nullptr : std::strerror(why);
}

/// Whole worlds of a run in its own folder. Worlds of other runs found there are named in `ignored`.
std::vector<StoredWorld> kept_by(const fs::path& folder, std::uint64_t run, std::vector<std::string>& ignored) {
  PartStore::Listing listing = PartStore(folder).list();
  ignored.insert(ignored.end(), listing.ignored.begin(), listing.ignored.end());
  std::erase_if(listing.whole, [&](const StoredWorld& world) {
    if (world.header.run == run) return false;
    ignored.push_back(fmt::format("{}: of another run, {:016x}", world.file.string(), world.header.run));
    return true;
  });
  return std::move(listing.whole);
}

}  // namespace

std::optional<fs::path> kept_folder(const config::Launch& launch, const SaveArguments& save) {
  const std::string& disk = launch.survival.disk;
  if (disk == kOff || kept_steps(launch) == 0) return std::nullopt;
  if (!disk.empty()) return (launch.file.parent_path() / disk).lexically_normal();
  return save.folder_is_given ? std::optional<fs::path>(save.folder) : std::nullopt;
}

core::Step kept_steps(const config::Launch& launch) {
  if (launch.survival.on_death != config::OnDeath::kRecover) return 0;
  return std::max<core::Step>(1, std::llround(launch.survival.checkpoint_s * launch.time.step_hz));
}

fs::path kept_folder_of(const fs::path& kept, std::uint64_t run) { return kept / fmt::format("{}{:016x}", kRun, run); }

void check_room_for_saves(const config::Launch& launch, const SaveArguments& save) {
  std::vector<std::pair<const char*, fs::path>> folders;
  if (save.folder_is_given || save.every_s > 0) folders.emplace_back("--saves", save.folder);
  if (const auto kept = kept_folder(launch, save); kept && !launch.survival.disk.empty()) {
    folders.emplace_back("survival.disk", *kept);
  }
  for (const auto& [what, folder] : folders) {
    const char* const problem = problem_with_folder(folder);
    if (problem == nullptr) continue;
    throw config::BadConfig({fmt::format(
        "{}: found {}: {}, allowed: a folder that can be written, on a disk with room for {} KiB and for the world",
        what, folder.string(), problem, kRoom_B >> 10U)});
  }
}

std::string world_to_resume(const config::Launch& launch, const SaveArguments& save) {
  SaveArguments there = save;
  there.folder_is_given = true;
  const std::optional<fs::path> kept = kept_folder(launch, there);
  std::vector<StoredWorld> worlds = PartStore(save.folder).list().whole;
  std::vector<std::string> ignored;
  std::error_code no_folder;
  for (const auto& entry : fs::directory_iterator(kept.value_or(save.folder), no_folder)) {
    const std::optional<std::uint64_t> run = run_of(entry.path());
    if (!run) continue;
    for (StoredWorld& world : kept_by(entry.path(), *run, ignored)) worlds.push_back(std::move(world));
  }
  std::erase_if(worlds, [wanted = launch.world_identity()](const StoredWorld& world) {
    return world.header.identity.world != wanted;
  });
  std::ranges::stable_sort(worlds, is_newer);
  std::optional<std::string> found;
  for (const StoredWorld& world : worlds) {
    try {
      PartStore::read(world);
      found = world.file.string();
      spdlog::info("goes on from state {}: {}", world.header.cut.step, *found);
      break;
    } catch (const BadCut& bad) {
      ignored.emplace_back(bad.what());
    }
  }
  for (const std::string& why : ignored) spdlog::warn("left out: {}", why);
  if (found) return *found;
  throw config::BadConfig({fmt::format(
      "--resume: found no whole world of {} in {}, allowed: the folder of a run that has kept its states on disk",
      launch.file.filename().string(), kept.value_or(save.folder).string())});
}

std::string launch_command(const config::Launch& launch) {
  std::string command = "aurasim launch " + launch.file.string();
  for (const std::string& change : launch.overrides) {
    if (!change.starts_with("physics.threads=")) command += fmt::format(" --set '{}'", change);
  }
  return command;
}

std::string resume_command(const config::Launch& launch, const SaveArguments& save) {
  const std::string saves = save.folder_is_given ? fmt::format(" --saves {}", save.folder) : std::string();
  return launch_command(launch) + saves + " --resume";
}

std::vector<fs::path> folders_of_run(const config::Launch& launch, const SaveArguments& save, std::uint64_t run) {
  std::vector<fs::path> folders = {save.folder};
  if (const auto kept = kept_folder(launch, save)) folders.push_back(kept_folder_of(*kept, run));
  return folders;
}

void conclude_kept(const config::Launch& launch, const SaveArguments& save, std::uint64_t run, bool may_go_on) {
  const std::optional<fs::path> kept = kept_folder(launch, save);
  if (!kept) return;
  const fs::path folder = kept_folder_of(*kept, run);
  std::optional<StoredWorld> newest;
  if (may_go_on) newest = newest_saved_world({folder}, {launch.world_identity(), {run}, launch_command(launch)});
  std::error_code ignored;
  if (!newest) {
    fs::remove_all(folder, ignored);
    return;
  }
  spdlog::info("state {} is kept on disk: `{}` goes on from it", newest->header.cut.step, resume_command(launch, save));
}

}  // namespace aurasim::cut
