// Throws datagrams at a live participant, which must neither end nor hang nor grow; see datagram_mutator.h.
//   dds_guard_fuzz [--count N] [--seed S] [--keep FILE]        a target of its own, in a domain that is free
//   dds_guard_fuzz --domain D [--count N] [--seed S]           whoever is in domain D: a run of `aurasim launch`
//   dds_guard_fuzz --newcomer D                                sends nothing; exit 0 once it hears a target in domain D
// All on loopback: to every port of the domain's first participants, unicast and multicast. A target that ends or
// hangs: exit 1, and with --keep the last datagrams stand in FILE, each after its length in 4 octets (little-endian).
#include <charconv>
#include <csignal>
#include <deque>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string_view>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "datagram_mutator.h"
#include "datagram_recorder.h"
#include "run_endpoints.h"

namespace aurasim::dds::testing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kParticipants = 3;  // per domain, whose ports are tried
constexpr std::size_t kSockets = 64;        // a peer's limit must not hide the rest
constexpr std::size_t kBatch = 256;         // between two looks at the target
constexpr std::size_t kKept = 20'000;
constexpr auto kLongestSilence = 20s;

/// A program of this test, such as the one that the datagrams are for: its last line, and whether it lives.
class Target {
 public:
  Target(const std::string& program, std::vector<std::string> words) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], STDOUT_FILENO);
      ::close(ends[0]);
      ::close(ends[1]);
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      std::vector<char*> arguments = {const_cast<char*>(program.c_str())};  // NOLINT: as POSIX has it
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execv(program.c_str(), arguments.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    output_ = ends[0];
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
  }
  ~Target() {
    if (!ended()) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(output_);
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  /// Nothing while it runs, then its exit code or 128 + the signal.
  std::optional<int> ended() {
    if (code_) return code_;
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return code_;
  }
  /// Reads what it has said; returns how long it has said nothing.
  Clock::duration silence() {
    char text[4096];
    for (ssize_t n; (n = ::read(output_, text, sizeof text)) > 0;) {
      said_.append(text, static_cast<std::size_t>(n));
      heard_ = Clock::now();
    }
    if (const auto end = said_.rfind('\n'); end != std::string::npos) {
      const auto begin = said_.rfind('\n', end == 0 ? 0 : end - 1);
      last_line_ =
          said_.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin + 1));
      said_.erase(0, end + 1);
    }
    return Clock::now() - heard_;
  }
  const std::string& last_line() const { return last_line_; }
  void ask_to_end() { ::kill(pid_, SIGTERM); }

  /// Resident memory, MB.
  double memory_MB() const {
    std::ifstream statm("/proc/" + std::to_string(pid_) + "/statm");
    double all = 0, resident = 0;
    statm >> all >> resident;
    return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  std::string said_, last_line_;
  Clock::time_point heard_ = Clock::now();
  std::optional<int> code_;
};

/// Sends to every port of a domain, from many sockets.
class Sprayer {
 public:
  Sprayer(std::uint32_t domain, std::uint64_t seed) : random_(seed) {
    const std::uint32_t base = 7400 + 250 * domain;
    first_port_ = base;
    for (const std::uint32_t offset : {0U, 1U}) destinations_.push_back(address("239.255.0.1", base + offset));
    for (std::uint32_t p = 0; p < kParticipants; ++p) {
      destinations_.push_back(address("127.0.0.1", base + 10 + 2 * p));
      destinations_.push_back(address("127.0.0.1", base + 11 + 2 * p));
    }
    for (std::size_t i = 0; i < kSockets; ++i) {
      const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
      const in_addr loopback{htonl(INADDR_LOOPBACK)};
      ::setsockopt(socket, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
      const auto any_port = address("127.0.0.1", 0);
      if (socket < 0 || ::bind(socket, reinterpret_cast<const sockaddr*>(&any_port), sizeof any_port) != 0) {
        throw std::runtime_error("no socket on loopback");
      }
      sockets_.push_back(socket);
    }
  }
  ~Sprayer() {
    for (const int socket : sockets_) ::close(socket);
  }
  Sprayer(const Sprayer&) = delete;
  Sprayer& operator=(const Sprayer&) = delete;

  void send(const Bytes& bytes) {
    const auto& to = destinations_[random_() % destinations_.size()];
    ::sendto(sockets_[random_() % sockets_.size()], bytes.data(), bytes.size(), 0,
             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  /// Nothing waits in the domain's receiving sockets: all that was sent has been looked at.
  bool drained() const {
    std::ifstream table("/proc/net/udp");
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
      std::istringstream words(line);
      std::string slot, local, remote, state, queues;
      words >> slot >> local >> remote >> state >> queues;
      const auto port = std::stoul(local.substr(local.find(':') + 1), nullptr, 16);
      if (port < first_port_ || port >= first_port_ + 250) continue;
      if (queues.substr(queues.find(':') + 1) != "00000000") return false;
    }
    return true;
  }

 private:
  static sockaddr_in address(const char* ip, std::uint32_t port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, ip, &to.sin_addr);
    return to;
  }

  std::mt19937_64 random_;
  std::uint32_t first_port_ = 0;
  std::vector<sockaddr_in> destinations_;
  std::vector<int> sockets_;
};

struct Arguments {
  std::uint64_t count = 200'000, seed = 1;
  std::optional<std::uint32_t> domain;        ///< of others
  std::optional<std::uint32_t> heard_domain;  ///< of a newcomer
  std::string keep;
};

/// The last ones that were sent.
class Kept {
 public:
  void add(const Bytes& bytes) {
    last_.push_back(bytes);
    if (last_.size() > kKept) last_.pop_front();
  }
  void write(const std::string& name) const {
    std::ofstream file(name, std::ios::binary);
    for (const Bytes& bytes : last_) {
      const auto size = static_cast<std::uint32_t>(bytes.size());
      file.write(reinterpret_cast<const char*>(&size), sizeof size);
      file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
  }

 private:
  std::deque<Bytes> last_;
};

/// A peer of the target that behaves; what it says and hears is what the others are made from.
class Honest {
 public:
  explicit Honest(std::uint32_t domain) : endpoints_(domain, 1, {0}) {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      for (core::Step step = 1; !stop.stop_requested(); ++step) {
        endpoints_.say(step);
        endpoints_.listen();
        std::this_thread::sleep_for(17ms);
      }
    });
  }

 private:
  RunEndpoints endpoints_;
  std::jthread thread_;
};

/// Somebody new hears the target's status.
bool hears(std::uint32_t domain) {
  Participant participant(settings_for(domain));
  ControlBus control(participant, {});
  return holds_in_time([&] {
    const auto statuses = control.statuses();
    return std::ranges::any_of(statuses, [](const auto& entry) { return core::value_of(entry.first) == 0; });
  });
}

/// A process of its own. The participants of this one have ids that differ in one octet: a changed announcement may
/// have taken the next one's, and then nobody listens to the real one, as in every run without keys.
bool newcomer_hears(const std::string& own_program, std::uint32_t domain) {
  Target newcomer(own_program, {"--newcomer", std::to_string(domain)});
  holds_in_time([&] { return newcomer.ended().has_value(); });
  return newcomer.ended() == 0;
}

/// Until all was looked at; false when the target has ended or says nothing.
bool wait_until_looked_at(const Sprayer& sprayer, Target* target) {
  for (int i = 0; !sprayer.drained(); ++i) {
    if (target == nullptr ? i > 5000 : target->ended() || target->silence() > kLongestSilence) return target == nullptr;
    ::usleep(200);
  }
  return target == nullptr || !target->ended();
}

bool spray(const Arguments& arguments, std::uint32_t domain, Target* target, Kept& kept) {
  Sprayer sprayer(domain, arguments.seed);
  DatagramMutator mutator(arguments.seed);
  const auto begin = Clock::now();
  auto next_word = begin + 10s;
  for (std::uint64_t sent = 0; sent < arguments.count; sent += kBatch) {
    if (sent / kBatch % 400 == 0) {
      auto recorded = recorded_datagrams();
      if (recorded.empty()) throw std::runtime_error("nothing was recorded: is anybody there?");
      mutator.use(std::move(recorded));
    }
    for (std::size_t i = 0; i < kBatch; ++i) {
      const Bytes bytes = mutator.next();
      kept.add(bytes);
      sprayer.send(bytes);
    }
    if (!wait_until_looked_at(sprayer, target)) return false;
    if (target != nullptr && target->silence() > kLongestSilence) return false;
    if (Clock::now() > next_word || sent + kBatch >= arguments.count) {
      next_word = Clock::now() + 10s;
      std::cout << sent + kBatch << " sent in " << std::chrono::duration<double>(Clock::now() - begin).count() << " s";
      if (target != nullptr) std::cout << ", " << target->last_line() << ", " << target->memory_MB() << " MB";
      std::cout << std::endl;
    }
  }
  return true;
}

int fail(const Arguments& arguments, Target& target, const Kept& kept, const std::string& what) {
  if (!arguments.keep.empty()) kept.write(arguments.keep);
  std::cerr << "seed " << arguments.seed << ": " << what << "; it last said \"" << target.last_line() << "\"";
  target.ask_to_end();
  if (holds_in_time([&] { return target.ended().has_value(); })) {
    target.silence();
    std::cerr << ", at its end \"" << target.last_line() << "\"";
  }
  if (const auto code = target.ended()) std::cerr << ", and ended with " << *code;
  std::cerr << std::endl;
  return 1;
}

int against_own_target(const Arguments& arguments) {
  const auto own_program = std::filesystem::canonical("/proc/self/exe");
  const test::LeasedDomain domain;
  Target target(own_program.parent_path() / "dds_fuzz_target", {std::to_string(domain.number())});
  Kept kept;
  {
    const Honest honest(domain.number());
    std::this_thread::sleep_for(3s);
    stop_recording_this_thread();
    if (!spray(arguments, domain.number(), &target, kept)) return fail(arguments, target, kept, "the target is gone");
  }
  target.silence();
  std::this_thread::sleep_for(1s);
  if (target.silence() > kLongestSilence) return fail(arguments, target, kept, "the target says nothing");
  if (!newcomer_hears(own_program, domain.number()))
    return fail(arguments, target, kept, "a newcomer does not hear it");
  target.ask_to_end();
  if (!holds_in_time([&] { return target.ended().has_value(); }) || target.ended() != 0) {
    return fail(arguments, target, kept, "it does not end as it should");
  }
  target.silence();
  std::cout << target.last_line() << std::endl;
  return 0;
}

int against_a_run(const Arguments& arguments) {
  Participant participant(settings_for(*arguments.domain));
  ControlBus control(participant, {});
  ReplicaReader replicas(participant, RunEndpoints::observed());
  std::this_thread::sleep_for(3s);
  Kept kept;
  stop_recording_this_thread();
  spray(arguments, *arguments.domain, nullptr, kept);
  return 0;
}

template <class Number>
Number number_in(std::string_view text) {
  Number number{};
  if (std::from_chars(text.data(), text.data() + text.size(), number).ec != std::errc{}) {
    throw std::invalid_argument(std::string(text));
  }
  return number;
}

Arguments arguments_in(const std::vector<std::string_view>& words) {
  Arguments arguments;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    if (words[i] == "--count")
      arguments.count = number_in<std::uint64_t>(words[i + 1]);
    else if (words[i] == "--seed")
      arguments.seed = number_in<std::uint64_t>(words[i + 1]);
    else if (words[i] == "--domain")
      arguments.domain = number_in<std::uint32_t>(words[i + 1]);
    else if (words[i] == "--newcomer")
      arguments.heard_domain = number_in<std::uint32_t>(words[i + 1]);
    else if (words[i] == "--keep")
      arguments.keep = words[i + 1];
    else
      throw std::invalid_argument(std::string(words[i]));
  }
  return arguments;
}

}  // namespace
}  // namespace aurasim::dds::testing

int main(int argc, char** argv) {
  using namespace aurasim::dds::testing;
  const Arguments arguments = arguments_in({argv + 1, argv + argc});
  if (arguments.heard_domain) return hears(*arguments.heard_domain) ? 0 : 1;
  return arguments.domain ? against_a_run(arguments) : against_own_target(arguments);
}
