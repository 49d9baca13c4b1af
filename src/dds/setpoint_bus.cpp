#include "dds/setpoint_bus.h"

#include <algorithm>
#include <deque>
#include <map>

#include <fmt/format.h>

#include "dds/random_id.h"
#include "dds/rations.h"
#include "dds/typed_endpoints.h"
#include "messages/setpoint_codec.h"

namespace aurasim::dds {
namespace {

/// Most programs whose last message number a node remembers: more than steer one run.
constexpr std::size_t kMostPrograms = 1024;

/// The number of each program's last message. When there are too many programs, the one that came first is forgotten.
class LastWords {
 public:
  void note(const core::ProgramWord& word) {
    const auto [known, is_new] = last_.try_emplace(word.program, word.number);
    if (!is_new) known->second = std::max(known->second, word.number);
    if (is_new) order_.push_back(word.program);
    if (order_.size() <= kMostPrograms) return;
    last_.erase(order_.front());
    order_.pop_front();
  }

  bool has(const core::ProgramWord& word) const {
    const auto known = last_.find(word.program);
    return known != last_.end() && known->second >= word.number;
  }

 private:
  std::map<std::uint64_t, std::uint64_t> last_;
  std::deque<std::uint64_t> order_;
};

}  // namespace

struct SetpointReader::Impl {
  explicit Impl(Participant& participant)
      : reader(participant.domain(), on(TopicId::kControl), participant.domain().wakeup()) {}

  TypedReader<wire::Setpoints> reader;
  LastWords last_words;
  RateLimit<ProcessPrefix> rates{kSetpointsASecond, kSetpointsAtOnce};
  std::uint64_t too_many = 0;
};

SetpointReader::SetpointReader(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

SetpointReader::~SetpointReader() = default;

std::vector<core::Setpoints> SetpointReader::take(core::Generation generation) {
  std::vector<core::Setpoints> taken;
  const auto now = std::chrono::steady_clock::now();
  impl_->reader.take_each({}, [&](core::Setpoints&& setpoints, const Origin& origin) {
    impl_->last_words.note({setpoints.client, setpoints.sequence});
    if (setpoints.generation != generation) return;
    const bool is_a_program = setpoints.client != core::kRecordedClient;
    if (!is_a_program || !impl_->rates.allows(origin.writer.guidPrefix, now)) {
      ++impl_->too_many;
      impl_->reader.ration(origin, fmt::format("{:g} a second, {:g} at once", kSetpointsASecond, kSetpointsAtOnce));
      return;
    }
    taken.push_back(std::move(setpoints));
  });
  return taken;
}

bool SetpointReader::has_received(const core::ProgramWord& word) const { return impl_->last_words.has(word); }

void SetpointReader::note_state() { impl_->rates.allow_more(kSetpointsAState); }

std::uint64_t SetpointReader::refused() const { return impl_->too_many + impl_->reader.refused().total(); }

struct SetpointWriter::Impl {
  explicit Impl(Participant& participant_in)
      : participant(participant_in),
        writer(participant.domain(), on(TopicId::kControl), participant.domain().wakeup()) {}

  void write(const core::Setpoints& setpoints) {
    if (writer.send(setpoints, std::uint64_t{0}) == WriteResult::kFailed) {
      throw DdsError("cannot send setpoints: topic control does not take them");
    }
  }

  Participant& participant;
  std::uint64_t client = draw_id();
  std::uint64_t sequence = 0;
  TypedWriter<wire::Setpoints> writer;
};

SetpointWriter::SetpointWriter(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

SetpointWriter::~SetpointWriter() = default;

void SetpointWriter::send(core::Setpoints setpoints) {
  impl_->participant.progress();
  setpoints.client = impl_->client;
  setpoints.sequence = ++impl_->sequence;
  impl_->write(setpoints);
}

core::ProgramWord SetpointWriter::last_word() const { return {impl_->client, impl_->sequence}; }

std::size_t SetpointWriter::listeners() const { return impl_->writer.foreign_reader_count(); }

}  // namespace aurasim::dds
