#include "dds/dds_seams.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/progress.h"
#include "dds/typed_endpoints.h"
#include "messages/seam_codec.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

/// After so long a wait for one parcel, the log names the region.
constexpr auto kLong = 2s;
/// After so long a wait it is asked whether the node of any region is lost.
constexpr auto kAsksForAll = 5ms;
/// From one question whether others stand to the next.
constexpr auto kAsksWhetherOthersStand = 100ms;

double seconds_since(std::chrono::steady_clock::time_point begun) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

struct Peer {
  bool is_near = false;
  std::optional<Writer> writer;              ///< of a peer that is not near: once a parcel goes to it
  std::deque<messages::SeamParcel> waiting;  ///< parcels that came while those of another region were fetched
  std::uint32_t posted = 0, fetched = 0;     ///< in this step
  double waited_s = 0;                       ///< in this step
  messages::SeamParcel last;
};

}  // namespace

struct DdsSeams::Impl {
  Impl(Participant& participant_in, const SeamSettings& settings_in)
      : participant(participant_in),
        settings(settings_in),
        wakeup(participant.domain().wakeup()),
        reader(participant.domain(),
               on(TopicId::kSeam, {.destination = settings.region, .life = settings.life}, settings.region), wakeup) {
    for (std::uint32_t i = 0; i < settings.region_count; ++i) {
      if (core::RegionId{i} == settings.region) continue;
      peers.try_emplace(core::RegionId{i});
    }
    for (const core::RegionId region : settings.near) {
      peers.at(region).is_near = true;
      make_writer(region);
    }
    expected.map_version = settings.map_version;
    expected.destination = settings.region;
    expected.region_count = settings.region_count;
  }

  void make_writer(core::RegionId to);
  void wait_for_reader(core::RegionId to);
  void expect_alive(core::RegionId region, std::chrono::steady_clock::time_point begun);
  bool take(core::RegionId from, Peer& peer);
  std::optional<core::RegionId> find_lost() const;
  bool receive();
  void note_posted(std::chrono::steady_clock::time_point begun);
  void note_fetched(Peer& peer, std::chrono::steady_clock::time_point begun);
  void end_exchange();

  Participant& participant;
  SeamSettings settings;
  Wakeup& wakeup;
  Reader reader;  ///< of the parcels of all peers
  std::map<core::RegionId, Peer> peers;
  messages::Expected expected;
  core::Generation generation = 0;
  core::Step step = 0;
  ExchangeTimes times;
  double exchange_s = 0;                             ///< of the exchange that goes on
  bool has_fetched = false;                          ///< in the exchange that goes on
  std::chrono::steady_clock::time_point last_asked;  ///< whether others stand
  wire::SeamParcel sample;                           // reused
};

void DdsSeams::Impl::make_writer(core::RegionId to) {
  const topics::Route route{.source = settings.region, .destination = to, .life = settings.life};
  peers.at(to).writer.emplace(participant.domain(), on(TopicId::kSeam, route, settings.region), wakeup);
}

/// A parcel that is written before is lost: the writer keeps none for readers that it does not know yet. The other
/// end may not know the writer yet. It then asks for the parcel once it does.
void DdsSeams::Impl::wait_for_reader(core::RegionId to) {
  const auto begun = std::chrono::steady_clock::now();
  const Writer& writer = *peers.at(to).writer;
  while (!writer.reaches(to)) {
    expect_alive(to, begun);
    core::Progress::mark();
    participant.progress();
    wakeup.wait(1ms);
  }
}

/// Throws core::SeamsBroken when a region that is waited for is lost, or after a while any other, or when others stand.
void DdsSeams::Impl::expect_alive(core::RegionId region, std::chrono::steady_clock::time_point begun) {
  const auto now = std::chrono::steady_clock::now();
  std::optional<core::RegionId> lost;
  if (settings.is_lost(region)) lost = region;
  if (!lost && now - begun > kAsksForAll) lost = find_lost();
  if (lost) throw core::SeamsBroken(fmt::format("region {} was lost in the middle of a step", core::value_of(*lost)));
  if (!settings.why_stand || now - std::max(begun, last_asked) < kAsksWhetherOthersStand) return;
  last_asked = now;
  // A node that only the others receive nothing from is lost to them, and they are not lost to it.
  if (const auto why = settings.why_stand()) throw core::SeamsBroken(*why);
}

/// Takes the next parcel of this step. Parcels of earlier steps are dropped.
bool DdsSeams::Impl::take(core::RegionId from, Peer& peer) {
  for (;;) {
    while (peer.waiting.empty()) {
      if (!receive()) return false;
    }
    messages::SeamParcel parcel = std::move(peer.waiting.front());
    peer.waiting.pop_front();
    if (parcel.header.generation < generation || parcel.header.step < step) continue;
    const bool is_next = parcel.header.generation == generation && parcel.header.step == step &&
                         parcel.header.number == peer.fetched + 1;
    if (!is_next) {
      throw core::SeamsBroken(
          fmt::format("region {} is in another step: parcel {} of state {} came instead of {} of {}",
                      core::value_of(from), parcel.header.number, parcel.header.step, peer.fetched + 1, step));
    }
    ++peer.fetched;
    peer.last = std::move(parcel);
    return true;
  }
}

/// Takes one sample, and puts its parcel to those of its region. False when there is none.
bool DdsSeams::Impl::receive() {
  Origin origin;
  if (!reader.take(&sample, &origin)) return false;
  const core::RegionId from =
      participant.domain().speakers().home_of(origin.writer).value_or(core::RegionId{sample.source()});
  const auto peer = peers.find(from);
  if (peer == peers.end() || !settings.is_node(from, origin.writer.guidPrefix)) {
    reader.refuse_from(origin, fmt::format("it is not the node of region {}", core::value_of(from)));
    return true;
  }
  expected.source = from;
  auto decoded = messages::decode(sample, expected);
  if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
    reader.refuse_from(origin, *error);
  } else {
    peer->second.waiting.push_back(std::move(std::get<messages::SeamParcel>(decoded)));
  }
  return true;
}

/// A region whose node is lost. Without it nobody ends the step, and those who wait for it send nothing.
std::optional<core::RegionId> DdsSeams::Impl::find_lost() const {
  for (const auto& [region, peer] : peers) {
    if (settings.is_lost(region)) return region;
  }
  return std::nullopt;
}

void DdsSeams::Impl::note_posted(std::chrono::steady_clock::time_point begun) {
  if (has_fetched) end_exchange();
  exchange_s += seconds_since(begun);
}

void DdsSeams::Impl::note_fetched(Peer& peer, std::chrono::steady_clock::time_point begun) {
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
  impl_->times.waited_s = 0;
  for (const auto& [region, peer] : impl_->peers) {
    if (peer.waited_s <= impl_->times.waited_s) continue;
    impl_->times.waited_for = region;
    impl_->times.waited_s = peer.waited_s;
  }
  return impl_->times;
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
  if (peer.is_near && !impl_->reader.watch().any_matched({}, region)) missing.emplace_back("its seam writer");
  if (peer.writer && !peer.writer->reaches(region)) missing.emplace_back("its seam reader");
  return missing;
}

void DdsSeams::begin(core::Generation generation, core::Step step) {
  impl_->generation = generation;
  impl_->step = step;
  impl_->times.seconds.clear();
  impl_->exchange_s = 0;
  impl_->has_fetched = false;
  for (auto& [region, peer] : impl_->peers) {
    peer.posted = peer.fetched = 0;
    peer.waited_s = 0;
    if (peer.writer) peer.writer->forget_acknowledged();
  }
}

void DdsSeams::post(core::RegionId to, std::span<const std::byte> parcel) {
  const auto begun = std::chrono::steady_clock::now();
  Peer& peer = impl_->peers.at(to);
  if (!peer.writer) {
    impl_->make_writer(to);
    impl_->wait_for_reader(to);
  }
  const messages::SeamHeader header{impl_->settings.region, to, impl_->generation, impl_->step, ++peer.posted};
  messages::encode(header, impl_->settings.map_version, parcel, impl_->sample);
  if (peer.writer->write(&impl_->sample) == WriteResult::kFailed) {
    throw core::SeamsBroken(fmt::format("region {} takes no parcels", core::value_of(to)));
  }
  impl_->note_posted(begun);
}

std::span<const std::byte> DdsSeams::fetch(core::RegionId from) {
  Peer& peer = impl_->peers.at(from);
  const auto begun = std::chrono::steady_clock::now();
  bool is_named = false;
  for (;;) {
    impl_->wakeup.clear();
    if (impl_->take(from, peer)) {
      impl_->note_fetched(peer, begun);
      return peer.last.octets;
    }
    impl_->expect_alive(from, begun);
    core::Progress::mark();
    impl_->participant.progress();
    impl_->wakeup.wait(5ms);
    if (!is_named && std::chrono::steady_clock::now() - begun > kLong) {
      is_named = true;
      spdlog::warn("region {} waits for region {} in the middle of state {}", core::value_of(impl_->settings.region),
                   core::value_of(from), impl_->step);
    }
  }
}

}  // namespace aurasim::dds
