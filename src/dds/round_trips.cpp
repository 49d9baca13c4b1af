#include "dds/round_trips.h"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "dds/typed_endpoints.h"
#include "messages/seam_codec.h"

namespace aurasim::dds {
namespace {

constexpr std::uint32_t kQuestion = 1, kAnswer = 2;

}  // namespace

struct RoundTrips::Impl {
  Impl(Participant& participant_in, core::RegionId self_in, std::uint32_t region_count, std::uint64_t map_version)
      : participant(participant_in),
        self(self_in),
        reader(participant.domain(), on(TopicId::kProbe, {.destination = self}, self), participant.domain().wakeup()) {
    expected.map_version = map_version;
    expected.destination = self;
    expected.region_count = region_count;
    for (std::uint32_t r = 0; r < region_count; ++r) {
      const core::RegionId peer{r};
      if (peer == self || (core::value_of(self) != 0 && r != 0)) continue;
      writers.try_emplace(peer, participant.domain(), on(TopicId::kProbe, {.source = self, .destination = peer}, self),
                          participant.domain().wakeup());
    }
  }

  void send(core::RegionId to, std::uint32_t number, std::uint32_t what) {
    messages::encode({self, to, 0, number, what}, *expected.map_version, std::span<const std::byte>(), false, sample);
    writers.at(to).write(&sample);  // a message that is not sent counts as lost
  }
  std::vector<Answer> take(std::uint32_t what);

  Participant& participant;
  core::RegionId self;
  Reader reader;                             ///< of the questions, or answers, of all peers
  std::map<core::RegionId, Writer> writers;  ///< by peer
  messages::Expected expected;
  wire::SeamPiece sample;  // reused
};

std::vector<RoundTrips::Answer> RoundTrips::Impl::take(std::uint32_t what) {
  std::vector<Answer> taken;
  participant.progress();
  const Speakers& speakers = participant.domain().speakers();
  Origin origin;
  while (reader.take(&sample, &origin)) {
    const core::RegionId region{sample.source()};
    if (!writers.contains(region) || !speakers.may_speak(origin.writer, region) ||
        !speakers.is_at_home(origin.writer, region)) {
      reader.refuse_from(origin, fmt::format("it is not the node of region {}", core::value_of(region)));
      continue;
    }
    expected.source = region;
    const auto decoded = messages::decode(sample, expected);
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      reader.refuse_from(origin, *error);
      continue;
    }
    const messages::SeamHeader& header = std::get<messages::SeamPiece>(decoded).header;
    if (header.number == what) taken.push_back({region, static_cast<std::uint32_t>(header.step)});
  }
  return taken;
}

RoundTrips::RoundTrips(Participant& participant, core::RegionId self, std::uint32_t region_count,
                       std::uint64_t map_version)
    : impl_(std::make_unique<Impl>(participant, self, region_count, map_version)) {}

RoundTrips::~RoundTrips() = default;

void RoundTrips::ask(core::RegionId region, std::uint32_t number) { impl_->send(region, number, kQuestion); }

std::vector<RoundTrips::Answer> RoundTrips::take_answers() { return impl_->take(kAnswer); }

void RoundTrips::answer() {
  for (const Answer& question : impl_->take(kQuestion)) impl_->send(question.region, question.number, kAnswer);
}

}  // namespace aurasim::dds
