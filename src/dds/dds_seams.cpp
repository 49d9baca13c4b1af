#include "dds/dds_seams.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/progress.h"
#include "dds/typed_endpoints.h"
#include "messages/seam_codec.h"
#include "messages/seam_pieces.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// After so long a wait for one parcel, the log names the region.
constexpr auto kLong = 2s;
/// From one look at who is lost, and which processes are nodes, to the next.
constexpr auto kLooks = 5ms;
/// From one question whether others stand to the next.
constexpr auto kAsksWhetherOthersStand = 100ms;
/// A region that has sent nothing for so long is asked for what has not come, once more after as long, and then after
/// twice as long each time: it may still compute.
constexpr Clock::duration kSilent = 2ms, kLongestSilent = 8ms;
/// Shortest time between two answers to one region. Most bytes of an answer.
constexpr auto kBetweenAnswers = 1ms;
constexpr std::size_t kMostOfAnAnswer_B = std::size_t{256} << 10;

double seconds_since(Clock::time_point begun) { return std::chrono::duration<double>(Clock::now() - begun).count(); }

struct StepName {
  core::Generation generation = 0;
  core::Step step = 0;

  bool operator==(const StepName&) const = default;
};

/// When a region that is waited for is asked.
class Asking {
 public:
  explicit Asking(Clock::time_point begun) : since_(begun) {}

  Clock::time_point due() const { return since_ + after_; }
  void note_heard(Clock::time_point now) { *this = Asking(now); }
  void note_asked(Clock::time_point now) {
    since_ = now;
    if (std::exchange(has_asked_, true)) after_ = std::min(2 * after_, kLongestSilent);
  }

 private:
  Clock::time_point since_;
  Clock::duration after_ = kSilent;
  bool has_asked_ = false;
};

struct Peer {
  bool is_near = false;
  std::optional<Writer> writer;  ///< of a peer that is not near: once a parcel goes to it
  double waited_s = 0;           ///< in this step
  std::vector<std::byte> last;   ///< parcel

  // Guarded by Impl::mutex.
  Writer* answers = nullptr;                     ///< `writer`, once it is there
  std::optional<ProcessPrefix> node;             ///< the region's, if known
  messages::PostedPieces posted, posted_before;  ///< in this step, and in the one before
  messages::ArrivedPieces arrived;
  std::uint64_t arrivals = 0;  ///< pieces and their repetitions
  Clock::time_point answered;
};

}  // namespace

struct DdsSeams::Impl {
  Impl(Participant& participant_in, const SeamSettings& settings_in);

  void make_writer(core::RegionId to);
  void look_at_nodes();
  void look_around(Clock::time_point begun);
  std::optional<core::RegionId> find_lost() const;
  void expect_same_step(core::RegionId from, const Peer& peer) const;
  void wait_for(core::RegionId from, Peer& peer, std::unique_lock<std::mutex>& lock);
  void ask(core::RegionId from, Peer& peer, std::span<const std::uint32_t> lacking);
  void hear();
  void hear(Peer& peer, const messages::SeamPiece& piece);
  void answer(Peer& peer, const messages::SeamPiece& question);
  void note_posted(Clock::time_point begun);
  void note_fetched(Peer& peer, Clock::time_point begun);
  void end_exchange();
  messages::SeamHeader header_to(core::RegionId to, const StepName& of, std::uint32_t number) const {
    return {settings.region, to, of.generation, of.step, number};
  }

  Participant& participant;
  SeamSettings settings;
  std::map<core::RegionId, Peer> peers;
  ExchangeTimes times;
  double exchange_s = 0;         ///< of the exchange that goes on
  bool has_fetched = false;      ///< in the exchange that goes on
  Clock::time_point last_asked;  ///< whether others stand
  SeamCounters told;             ///< by times(), in all
  wire::SeamPiece sample;        // reused

  // The DDS thread that takes what comes uses these.
  std::mutex hearing;
  messages::Expected expected;
  wire::SeamPiece heard;  // reused

  mutable std::mutex mutex;
  std::condition_variable has_come;
  std::optional<core::RegionId> waits_for;
  StepName step, step_before;
  wire::SeamPiece answer_sample;  // reused
  SeamCounters counters;

  std::optional<Reader> reader;  ///< of the parcels of all peers; ends first, and with it what DDS threads do here
};

DdsSeams::Impl::Impl(Participant& participant_in, const SeamSettings& settings_in)
    : participant(participant_in), settings(settings_in) {
  for (std::uint32_t i = 0; i < settings.region_count; ++i) {
    if (core::RegionId{i} != settings.region) peers.try_emplace(core::RegionId{i});
  }
  expected.map_version = settings.map_version;
  expected.destination = settings.region;
  expected.region_count = settings.region_count;
  for (const core::RegionId region : settings.near) {
    peers.at(region).is_near = true;
    make_writer(region);
  }
  const std::lock_guard until_ready(hearing);
  reader.emplace(participant.domain(),
                 on(TopicId::kSeam, {.destination = settings.region, .life = settings.life}, settings.region),
                 participant.domain().wakeup(), [this] { hear(); });
}

/// Must not be called with a lock that hear() takes: no datagram is processed while an endpoint is made.
void DdsSeams::Impl::make_writer(core::RegionId to) {
  const topics::Route route{.source = settings.region, .destination = to, .life = settings.life};
  Peer& peer = peers.at(to);
  peer.writer.emplace(participant.domain(), on(TopicId::kSeam, route, settings.region), participant.domain().wakeup());
  const std::lock_guard lock(mutex);
  peer.answers = &*peer.writer;
}

void DdsSeams::Impl::look_at_nodes() {
  if (!settings.node_of) return;
  for (auto& [region, peer] : peers) {
    const auto node = settings.node_of(region);
    const std::lock_guard lock(mutex);
    peer.node = node;
  }
}

/// Looks at the nodes while a parcel is waited for since `begun`. Throws core::SeamsBroken when a node is lost, or when
/// others stand.
void DdsSeams::Impl::look_around(Clock::time_point begun) {
  core::Progress::mark();
  participant.progress();
  look_at_nodes();
  if (const auto lost = find_lost())
    throw core::SeamsBroken(fmt::format("region {} was lost in the middle of a step", core::value_of(*lost)));
  const auto now = Clock::now();
  if (!settings.why_stand || now - std::max(begun, last_asked) < kAsksWhetherOthersStand) return;
  last_asked = now;
  // A node that only the others receive nothing from is lost to them, and they are not lost to it.
  if (const auto why = settings.why_stand()) throw core::SeamsBroken(*why);
}

/// A region whose node is lost. Without it nobody ends the step, and those who wait for it send nothing.
std::optional<core::RegionId> DdsSeams::Impl::find_lost() const {
  for (const auto& [region, peer] : peers) {
    if (settings.is_lost(region)) return region;
  }
  return std::nullopt;
}

/// A region begins the next step only when all have ended this one.
void DdsSeams::Impl::expect_same_step(core::RegionId from, const Peer& peer) const {
  const auto ahead = peer.arrived.ahead();
  if (!ahead) return;
  throw core::SeamsBroken(
      fmt::format("region {} is in another step: piece {} of state {} came instead of parcel {} of {}",
                  core::value_of(from), ahead->number, ahead->step, peer.arrived.next_parcel(), step.step));
}

/// Waits until the next parcel of a region is whole. Asks for what has not come.
void DdsSeams::Impl::wait_for(core::RegionId from, Peer& peer, std::unique_lock<std::mutex>& lock) {
  const auto begun = Clock::now();
  Asking asking(begun);
  auto next_look = begun + kLooks;
  std::uint64_t arrivals = peer.arrivals;
  bool is_named = false;
  while (!peer.arrived.take(peer.last)) {
    expect_same_step(from, peer);
    const auto now = Clock::now();
    if (std::exchange(arrivals, peer.arrivals) != peer.arrivals) asking.note_heard(now);
    if (now >= asking.due()) {
      asking.note_asked(now);
      const std::vector<std::uint32_t> lacking = peer.arrived.lacking();
      lock.unlock();
      ask(from, peer, lacking);
      lock.lock();
    } else if (now >= next_look) {
      next_look = now + kLooks;
      lock.unlock();
      look_around(begun);
      if (now - begun > kLong && !std::exchange(is_named, true)) {
        spdlog::warn("region {} waits for region {} in the middle of state {}", core::value_of(settings.region),
                     core::value_of(from), step.step);
      }
      lock.lock();
    } else {
      waits_for = from;
      has_come.wait_until(lock, std::min(asking.due(), next_look));
      waits_for.reset();
    }
  }
}

void DdsSeams::Impl::ask(core::RegionId from, Peer& peer, std::span<const std::uint32_t> lacking) {
  if (!peer.writer) make_writer(from);
  messages::encode(header_to(from, step, 0), settings.map_version, lacking, sample);
  peer.writer->write(&sample);  // what is lost is asked again
  const std::lock_guard lock(mutex);
  ++counters.questions;
}

/// Takes what has come. Called by DDS threads.
void DdsSeams::Impl::hear() {
  const std::lock_guard one_by_one(hearing);
  Origin origin;
  while (reader->take(&heard, &origin)) {
    const core::RegionId from =
        participant.domain().speakers().home_of(origin.writer).value_or(core::RegionId{heard.source()});
    const auto peer = peers.find(from);
    const auto is_of_another = [&] {
      const std::lock_guard lock(mutex);
      return peer->second.node && *peer->second.node != origin.writer.guidPrefix;
    };
    if (peer == peers.end() || is_of_another()) {
      reader->refuse_from(origin, fmt::format("it is not the node of region {}", core::value_of(from)));
      continue;
    }
    expected.source = from;
    auto decoded = messages::decode(heard, expected);
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      reader->refuse_from(origin, *error);
    } else {
      hear(peer->second, std::get<messages::SeamPiece>(decoded));
    }
  }
}

void DdsSeams::Impl::hear(Peer& peer, const messages::SeamPiece& piece) {
  bool is_waited_for = false;
  {
    const std::lock_guard lock(mutex);
    if (piece.is_question()) {
      answer(peer, piece);
      return;
    }
    ++peer.arrivals;
    peer.arrived.add(piece);
    is_waited_for = waits_for == piece.header.source;
  }
  if (is_waited_for) has_come.notify_one();
}

/// Sends again what a region asks for. A region that asks for what is still being computed gets no answer.
void DdsSeams::Impl::answer(Peer& peer, const messages::SeamPiece& question) {
  const StepName asked{question.header.generation, question.header.step};
  const auto now = Clock::now();
  if ((asked != step && asked != step_before) || peer.answers == nullptr || now < peer.answered + kBetweenAnswers)
    return;
  const messages::PostedPieces& posted = asked == step ? peer.posted : peer.posted_before;
  posted.answer(question.lacking, kMostOfAnAnswer_B, [&](const messages::PostedPieces::Piece& piece) {
    peer.answered = now;
    ++counters.repeated;
    messages::encode(header_to(question.header.source, asked, piece.number), settings.map_version, piece.octets,
                     piece.goes_on, answer_sample);
    peer.answers->write(&answer_sample);  // what is lost is asked for again
  });
}

void DdsSeams::Impl::note_posted(Clock::time_point begun) {
  if (has_fetched) end_exchange();
  exchange_s += seconds_since(begun);
}

void DdsSeams::Impl::note_fetched(Peer& peer, Clock::time_point begun) {
  const double took_s = seconds_since(begun);
  has_fetched = true;
  exchange_s += took_s;
  peer.waited_s += took_s;
}

void DdsSeams::Impl::end_exchange() {
  times.seconds.push_back(std::exchange(exchange_s, 0));
  has_fetched = false;
}

const ExchangeTimes& DdsSeams::times() {
  if (impl_->has_fetched) impl_->end_exchange();
  const SeamCounters now = counters(), before = std::exchange(impl_->told, now);
  impl_->times.counters = {now.questions - before.questions, now.repeated - before.repeated};
  impl_->times.waited_s = 0;
  for (const auto& [region, peer] : impl_->peers) {
    if (peer.waited_s <= impl_->times.waited_s) continue;
    impl_->times.waited_for = region;
    impl_->times.waited_s = peer.waited_s;
  }
  return impl_->times;
}

SeamCounters DdsSeams::counters() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->counters;
}

DdsSeams::DdsSeams(Participant& participant, const SeamSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

DdsSeams::~DdsSeams() = default;

std::size_t DdsSeams::endpoints_of(core::RegionId region) const {
  const auto peer = impl_->peers.find(region);
  if (peer == impl_->peers.end()) return 0;
  return (peer->second.is_near ? 1 : 0) + (peer->second.writer ? 1 : 0);
}

std::vector<std::string> DdsSeams::unmatched(core::RegionId region) const {
  std::vector<std::string> missing;
  const auto found = impl_->peers.find(region);
  if (found == impl_->peers.end()) return missing;
  const Peer& peer = found->second;
  if (peer.is_near && !impl_->reader->watch().any_matched({}, region)) missing.emplace_back("its seam writer");
  if (peer.writer && !peer.writer->reaches(region)) missing.emplace_back("its seam reader");
  return missing;
}

void DdsSeams::begin(core::Generation generation, core::Step step) {
  impl_->look_at_nodes();
  begin_exchanges();
  const std::lock_guard lock(impl_->mutex);
  impl_->step_before = std::exchange(impl_->step, {generation, step});
  for (auto& [region, peer] : impl_->peers) {
    std::swap(peer.posted, peer.posted_before);
    peer.posted.begin();
    peer.arrived.begin(generation, step);
  }
}

void DdsSeams::begin_exchanges() {
  impl_->times.seconds.clear();
  impl_->exchange_s = 0;
  impl_->has_fetched = false;
  for (auto& [region, peer] : impl_->peers) peer.waited_s = 0;
}

void DdsSeams::post(core::RegionId to, std::span<const std::byte> parcel) {
  const auto begun = Clock::now();
  Peer& peer = impl_->peers.at(to);
  if (!peer.writer) impl_->make_writer(to);
  const std::size_t most_B = peer.writer->largest_sample_B() - messages::empty_piece_B();
  messages::cut(parcel, most_B, [&](std::span<const std::byte> octets, bool goes_on) {
    std::uint32_t number = 0;
    {
      const std::lock_guard lock(impl_->mutex);
      number = peer.posted.add(octets, goes_on).number;
    }
    messages::encode(impl_->header_to(to, impl_->step, number), impl_->settings.map_version, octets, goes_on,
                     impl_->sample);
    if (peer.writer->write(&impl_->sample) == WriteResult::kFailed) {
      throw core::SeamsBroken(fmt::format("region {} takes no parcels", core::value_of(to)));
    }
  });
  impl_->note_posted(begun);
}

std::span<const std::byte> DdsSeams::fetch(core::RegionId from) {
  Peer& peer = impl_->peers.at(from);
  const auto begun = Clock::now();
  {
    std::unique_lock lock(impl_->mutex);
    impl_->wait_for(from, peer, lock);
  }
  impl_->note_fetched(peer, begun);
  return peer.last;
}

}  // namespace aurasim::dds
