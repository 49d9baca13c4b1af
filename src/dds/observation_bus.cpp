#include "dds/observation_bus.h"

#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "dds/observing.h"
#include "dds/random_id.h"
#include "dds/rate_limit.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
namespace {

/// Interests that one process may publish a second: far more than a sensor that moves with its body needs.
constexpr double kInterestsASecond = 100;
constexpr double kInterestsAtOnce = 300;

/// Most observations of one observer that are not acknowledged: less than the writer keeps, and what fits into its
/// socket's buffer.
constexpr std::size_t kMostUnderWay = 48;
constexpr std::size_t kMostUnderWay_B = 2'000'000;

/// Most observations that an observer takes per call: large ones may arrive faster than they are decoded.
constexpr std::size_t kMostAtOnce = 64;

/// Approximate size on the wire, bytes; some octets are left out.
std::size_t size_of(const core::Observation& observation) {
  constexpr std::size_t kBody_B = 85, kJoint_B = 20, kContact_B = 72;
  return kBody_B * observation.bodies.size() + 8 * observation.outside.size() + kJoint_B * observation.joints.size() +
         kContact_B * observation.contacts.size();
}

}  // namespace

struct ObservationServer::Impl {
  struct Observer {
    Observer(Impl& of, std::uint64_t client)
        : writer(of.participant.domain(),
                 on(TopicId::kObservation, {.source = of.region, .observer = client}, of.region), of.wakeup) {}

    core::Interest interest;
    Guid origin;
    std::uint64_t changes = 0;
    std::size_t under_way = 0, under_way_B = 0;  ///< samples and bytes sent since it had acknowledged everything
    TypedWriter<wire::Observation> writer;
  };

  Impl(Participant& participant_in, core::RegionId region_in)
      : participant(participant_in),
        region(region_in),
        wakeup(participant.domain().wakeup()),
        interests(participant.domain(), on(TopicId::kInterest), wakeup) {}

  void receive(core::Interest&& interest, const Origin& origin);
  void forget_the_gone();
  void list();
  void refuse(const Origin& origin, const std::string& why) {
    ++refused;
    interests.refuse_from(origin, why);
  }

  Participant& participant;
  core::RegionId region;
  Wakeup& wakeup;
  TypedReader<wire::Interest> interests;
  std::map<std::uint64_t, Observer> observers;  ///< by client
  std::vector<Asked> asked;
  RateLimit<ProcessPrefix> limit{kInterestsASecond, kInterestsAtOnce};
  std::uint64_t refused = 0;
};

ObservationServer::ObservationServer(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ObservationServer::~ObservationServer() = default;

void ObservationServer::Impl::receive(core::Interest&& interest, const Origin& origin) {
  if (!limit.allows(origin.writer.guidPrefix, std::chrono::steady_clock::now())) {
    return refuse(origin, "too many a second");
  }
  const auto known = observers.find(interest.client);
  if (known != observers.end() && known->second.origin != origin.writer) {
    return refuse(origin, "an interest in the name of another client");
  }
  if (interest.ended) {
    if (known != observers.end()) observers.erase(known);
    return;
  }
  if (known == observers.end() && observers.size() >= core::kMostObservers) {
    return refuse(origin, fmt::format("more than {} observers", core::kMostObservers));
  }
  Observer& observer = known != observers.end()
                           ? known->second
                           : observers.try_emplace(interest.client, *this, interest.client).first->second;
  if (interest.sequence < observer.interest.sequence) return;
  observer.interest = std::move(interest);
  observer.origin = origin.writer;
  ++observer.changes;
}

/// Drops the interests of writers that are gone, however they ended.
void ObservationServer::Impl::forget_the_gone() {
  if (observers.empty()) return;
  const std::vector<RemoteWriter> writers = interests.watch().writers();
  std::erase_if(observers, [&](const auto& entry) {
    return std::ranges::none_of(
        writers, [&](const RemoteWriter& writer) { return writer.matched && writer.guid == entry.second.origin; });
  });
}

void ObservationServer::Impl::list() {
  asked.clear();
  for (const auto& [client, observer] : observers) {
    if (observer.writer.reader_count() == 0) continue;
    asked.push_back({&observer.interest, observer.changes + observer.writer.matches(), client});
  }
}

void ObservationServer::look() {
  const auto refuse = [this](const wire::Interest&, messages::WireError) { ++impl_->refused; };
  impl_->interests.take_each(
      {}, [this](core::Interest&& interest, const Origin& origin) { impl_->receive(std::move(interest), origin); },
      refuse);
  impl_->forget_the_gone();
  impl_->list();
}

bool ObservationServer::anybody_asks() const { return !impl_->observers.empty(); }

const std::vector<ObservationServer::Asked>& ObservationServer::asked() const { return impl_->asked; }

bool ObservationServer::takes_more(std::uint64_t key) {
  const auto found = impl_->observers.find(key);
  if (found == impl_->observers.end()) return false;
  Impl::Observer& observer = found->second;
  if (observer.under_way > 0 && observer.writer.all_acknowledged()) observer.under_way = observer.under_way_B = 0;
  return observer.under_way < kMostUnderWay && observer.under_way_B < kMostUnderWay_B;
}

bool ObservationServer::send(std::uint64_t key, const core::Observation& observation) {
  const auto observer = impl_->observers.find(key);
  if (observer == impl_->observers.end()) return false;
  ++observer->second.under_way;
  observer->second.under_way_B += size_of(observation);
  return observer->second.writer.send(observation) != WriteResult::kFailed;
}

std::uint64_t ObservationServer::refused() const { return impl_->refused; }

struct ObserverEndpoint::Impl {
  Impl(Participant& participant_in, const ObserverSettings& settings_in)
      : participant(participant_in),
        settings(settings_in),
        wakeup(participant.domain().wakeup()),
        observations(participant.domain(), on(TopicId::kObservation, {.observer = client}), wakeup),
        interests(participant.domain(), on(TopicId::kInterest), wakeup) {}

  void say_what_is_wanted() {
    if (interests.send_newest(*wanted, std::uint64_t{0}) == WriteResult::kFailed) {
      throw DdsError("cannot send the interest: topic interest does not take it");
    }
  }

  Participant& participant;
  std::uint64_t client = draw_id();
  std::uint64_t sequence = 0;
  ObserverSettings settings;
  std::optional<core::Interest> wanted;
  Wakeup& wakeup;
  TypedReader<wire::Observation> observations;
  TypedWriter<wire::Interest> interests;
};

ObserverEndpoint::ObserverEndpoint(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ObserverEndpoint::~ObserverEndpoint() {
  core::Interest none;
  none.ended = true;
  none.client = impl_->client;
  none.sequence = impl_->sequence + 1;
  impl_->interests.send_newest(none, std::uint64_t{0});
}

std::uint64_t ObserverEndpoint::client() const { return impl_->client; }

std::uint64_t ObserverEndpoint::want(core::Interest interest) {
  interest.client = impl_->client;
  interest.sequence = ++impl_->sequence;
  impl_->wanted = std::move(interest);
  impl_->say_what_is_wanted();
  return impl_->sequence;
}

std::vector<core::Observation> ObserverEndpoint::take() {
  impl_->participant.progress();
  std::vector<core::Observation> observations;
  const Speakers& speakers = impl_->participant.domain().speakers();
  const auto take_one = [&](core::Observation&& observation, const Origin& origin) {
    const bool may_say =
        speakers.may_speak(origin.writer, observation.source) && speakers.is_at_home(origin.writer, observation.source);
    if (may_say) return observations.push_back(std::move(observation));
    impl_->observations.refuse_from(origin,
                                    fmt::format("it is not the node of region {}", core::value_of(observation.source)));
  };
  const auto ignore = [](const wire::Observation&, messages::WireError) {};
  impl_->observations.take_each(expected_of(impl_->settings), take_one, ignore, kMostAtOnce);
  return observations;
}

void ObserverEndpoint::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

void ObserverEndpoint::use(const ObserverSettings& settings) {
  if (std::exchange(impl_->settings, settings) != settings && impl_->wanted) impl_->say_what_is_wanted();
}

std::uint64_t ObserverEndpoint::refused() const { return impl_->observations.refused().total(); }

}  // namespace aurasim::dds
