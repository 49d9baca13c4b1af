// Makes, packs, checks and revokes the keys of a run (security/key_store.h).
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/commands.h"
#include "command_line/exit_code.h"
#include "config/launch.h"
#include "host/spawn.h"
#include "security/key_store.h"

namespace aurasim::cli {
namespace {

using security::KeyStore;

constexpr std::uint32_t kMostRegions = 1024;
constexpr auto kEndsSoon = std::chrono::days(30);

struct KeysArguments {
  std::string folder;
  std::string name;
  std::vector<std::string> names;
  std::string regions;
  std::string role;
  std::string file;
  int days = 365;
  int authority_days = 3650;

  KeyStore::Days valid() const { return KeyStore::Days(days); }
};

std::uint32_t number_in(std::string_view text, const std::string& whole) {
  std::uint32_t number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && rest == text.data() + text.size() && number < kMostRegions) return number;
  throw security::BadKeys(fmt::format("REGIONS: found '{}', allowed: a number such as 3, or two such as 0-3, below {}",
                                      whole, kMostRegions));
}

/// "3", or "0-3".
std::pair<std::uint32_t, std::uint32_t> range_in(const std::string& text) {
  const std::size_t dash = text.find('-');
  const std::uint32_t first = number_in(std::string_view(text).substr(0, dash), text);
  const std::uint32_t last =
      dash == std::string::npos ? first : number_in(std::string_view(text).substr(dash + 1), text);
  if (first <= last) return {first, last};
  return {last, first};
}

void init(const KeysArguments& a) {
  KeyStore::create(a.folder, KeyStore::Days(a.authority_days));
  fmt::print("{0}: keep {0}/private to yourself: whoever has it can make keys\n", a.folder);
}

void add_regions(const KeysArguments& a) {
  KeyStore store(a.folder);
  const auto [first, last] = range_in(a.regions);
  for (std::uint32_t r = first; r <= last; ++r) store.add(security::member_of_region(r), a.valid());
}

void add(const KeysArguments& a) { KeyStore(a.folder).add({a.name, *security::role_named(a.role)}, a.valid()); }

/// By tar, which any host can unpack. The file is the owner's alone, like the key in it.
void pack(const KeysArguments& a) {
  const std::string file = a.file.empty() ? a.names.front() + ".tar" : a.file;
  std::vector<std::string> words = {"/bin/tar", "--create", "--owner=0", "--group=0", "--directory=" + a.folder};
  for (const auto& path : KeyStore(a.folder).files_for_host(a.names)) words.push_back(path.string());
  const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (out < 0) throw security::BadKeys(fmt::format("{}: cannot create it: is it there already?", file));
  int status = -1;
  ::waitpid(host::spawn(std::move(words), out), &status, 0);
  ::close(out);
  if (status != 0) {
    ::unlink(file.c_str());
    throw security::BadKeys(fmt::format("{}: tar has failed", file));
  }
  fmt::print(
      "{}: bring it to its host by a way that nobody else can read, unpack it (mkdir -m 700 keys && tar -xpf {} "
      "-C keys), and name that folder in dds.security\n",
      file, std::filesystem::path(file).filename().string());
}

void revoke(const KeysArguments& a) {
  KeyStore(a.folder).revoke(a.name);
  fmt::print("{}/crl.pem: copy it into the keys of every host; a process reads it when it starts\n", a.folder);
}

void rotate(const KeysArguments& a) {
  KeyStore store(a.folder);
  std::vector<std::string> names = a.names;
  if (names.empty()) {
    for (const security::Member& member : store.members()) names.push_back(member.name);
  }
  for (const std::string& name : names) store.rotate(name, a.valid());
  fmt::print("{} new keys; what was there before is good until it ends, unless you revoke it first\n", names.size());
}

/// One line for each name.
int check(const KeysArguments& a) {
  int problems = 0;
  const auto now = std::chrono::system_clock::now();
  for (const security::MemberState& state : KeyStore(a.folder).check()) {
    std::string until = "?";
    std::string remark = state.problem.empty() ? "good" : state.problem;
    if (state.valid) {
      until = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::chrono::system_clock::to_time_t(state.valid->until)));
      if (state.problem.empty() && !state.has_all_rights) {
        remark = "made before its role had all its rights: aurasim keys rotate";
      }
      if (state.problem.empty() && state.valid->until < now + kEndsSoon) remark = "ends soon: aurasim keys rotate";
    }
    fmt::print("{:<20} {:<9} until {}  {}\n", state.name, state.role, until, remark);
    problems += state.problem.empty() ? 0 : 1;
  }
  return problems == 0 ? 0 : static_cast<int>(command_line::ExitCode::kBadConfig);
}

using Arguments = std::shared_ptr<KeysArguments>;

template <class Work>
CLI::App* add_command(CLI::App& keys, command_line::Action& action, const Arguments& arguments, const char* name,
                      const char* text, const char* example, Work work) {
  CLI::App* command = keys.add_subcommand(name, text);
  command->add_option("DIR", arguments->folder, "folder of the keys")->required();
  command->footer(fmt::format("Example:\n  aurasim keys {} {}", name, example));
  command->callback([arguments, &action, work] {
    action = [arguments, work] {
      try {
        if constexpr (std::is_void_v<decltype(work(*arguments))>) {
          work(*arguments);
          return 0;
        } else {
          return work(*arguments);
        }
      } catch (const security::BadKeys& error) {
        throw config::BadConfig({error.what()});
      }
    };
  });
  return command;
}

void add_days(CLI::App& command, const Arguments& arguments) {
  command.add_option("--days", arguments->days, "so long the certificates are good")->check(CLI::Range(1, 36500));
}

}  // namespace

void add_keys(CLI::App& program, command_line::Action& action) {
  CLI::App* keys = program.add_subcommand("keys", "make, pack, check and revoke the keys of a run");
  keys->require_subcommand(1);
  keys->footer(
      "Example:\n  aurasim keys init keys && aurasim keys add-region keys 0-3 && aurasim keys add keys desk --role "
      "operator\n  aurasim launch demo --set dds.security=$PWD/keys");
  const auto a = std::make_shared<KeysArguments>();
  const auto command = [&](const char* name, const char* text, const char* example, auto work) {
    return add_command(*keys, action, a, name, text, example, work);
  };
  command("init", "make a new folder of keys, with the two authorities that all keys come from", "keys", init)
      ->add_option("--days", a->authority_days, "so long the authorities are good")
      ->check(CLI::Range(1, 36500));

  CLI::App* regions = command("add-region", "make keys for the nodes of regions", "keys 0-3", add_regions);
  regions->add_option("REGIONS", a->regions, "a number, or two with a - between")->required();
  add_days(*regions, a);

  CLI::App* one = command("add", "make a key for a process of another role", "keys desk --role operator", add);
  one->add_option("NAME", a->name, "letters, digits, - and _")->required();
  one->add_option(
         "--role", a->role,
         "spare: takes over a region; viewer: sees; operator: steers as well; recorder: reads everything; hub: "
         "passes on what nodes publish to all nodes")
      ->required()
      ->check(CLI::IsMember({"spare", "viewer", "operator", "recorder", "hub"}));
  add_days(*one, a);

  CLI::App* packed = command("pack", "put what a host needs into one file", "keys region-2 spare-1", pack);
  packed->add_option("NAME", a->names, "whose keys")->required();
  packed->add_option("--to", a->file, "the file; default: that of the first name, NAME.tar");

  command("revoke", "let nobody believe NAME any more", "keys region-2", revoke)
      ->add_option("NAME", a->name, "whose keys")
      ->required();

  CLI::App* rotated = command("rotate", "make new keys for names that are there", "keys region-2", rotate);
  rotated->add_option("NAME", a->names, "whose; default: everybody's");
  add_days(*rotated, a);

  command("check", "is every key there, private, in time and not revoked?", "keys", check);
}

}  // namespace aurasim::cli
