// The publications of one neighbour: its aura batches in order of stamp, and the auras that result from them, as they
// have taken effect and, for the check, as they have arrived.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/messages.h"
#include "core/published_auras.h"

namespace aurasim::core {

class Neighbour {
 public:
  /// `start`: the first state that the neighbour publishes.
  Neighbour(RegionId id, RegionId self, Step start = 0)
      : id_(id),
        self_(self),
        start_(start),
        in_effect_(self),
        arrived_(self),
        received_(start - 1),
        applied_(start - 1) {}

  RegionId id() const { return id_; }
  /// The first state that the neighbour publishes.
  Step start() const { return start_; }
  bool alive() const { return alive_; }

  /// Keeps a batch until its turn. False when it is a copy of one already seen. Calls `arrived(*this)` for each batch
  /// after which none is missing, in order of stamp, if it is not empty.
  using Arrived = std::function<void(const Neighbour&)>;
  bool accept(AuraBatch batch, const Arrived& arrived = {});

  /// Keeps a word (AuraBatch::word), and drops those of earlier states. False when it is a copy or out of date.
  bool accept_word(AuraBatch word);
  /// The word of this number that the neighbour has said in state `stamp`; null: it has not arrived.
  const AuraBatch* word(Step stamp, std::uint32_t number) const;

  /// From now on has_gathered() is false until note_gathered() is called with the word of kGathered.
  void await_gathering() { has_gathered_ = false; }
  bool has_gathered() const { return has_gathered_; }
  /// False when it is a copy.
  bool note_gathered(const AuraBatch& word);

  /// Stamp up to which every batch has arrived; start - 1 at first.
  Step received() const { return received_; }
  /// Stamp of the newest batch that has taken effect; start - 1 at first.
  Step applied() const { return applied_; }

  /// Lets the received batches with stamp <= `last` take effect, in order.
  void apply_until(Step last);

  /// Sequence of the neighbour's last hand-off to us with a stamp <= `stamp`, as announced by the batches received.
  std::uint64_t hand_offs_until(Step stamp) const;

  /// Marks the neighbour dead and drops all that it has published.
  void mark_dead();

  /// The auras in effect that are for us, ascending id.
  const std::vector<AuraRecord>& auras() const { return in_effect_.auras(); }
  /// The auras that are for us after batch received(). Kept for those who accept() batches with `arrived` only.
  const std::vector<AuraRecord>& auras_arrived() const { return arrived_.auras(); }
  /// AuraBatch::past of batch received(): made-up states of bodies that joined the neighbour late.
  const std::vector<AuraRecord>& past_arrived() const { return past_; }
  double top_speed_m_s() const { return top_speed_m_s_; }
  double top_radius_m() const { return top_radius_m_; }
  std::uint64_t violations() const { return violations_; }
  /// Orders in the batches that have arrived since the last call.
  std::vector<Order> take_orders();
  std::vector<Alarm> take_alarms();
  struct Introduced {
    Step stamp = 0;
    Introduction pair;
    RegionId by{};
  };
  std::vector<Introduced> take_introductions();

 private:
  void note_arrival(const AuraBatch& batch);
  void note_marks(const AuraBatch& batch);
  void apply(const AuraBatch& batch);

  RegionId id_;
  RegionId self_;
  Step start_;
  PublishedAuras in_effect_, arrived_;
  bool alive_ = true;
  bool has_gathered_ = true;
  Step received_;
  Step applied_;
  std::vector<AuraBatch> waiting_;  ///< batches not yet in effect, ascending stamp, a few at most
  struct Mark {
    Step stamp;
    std::uint64_t last_sequence;
  };
  std::vector<Mark> marks_;  ///< marks of hand-offs to us, ascending stamp; of those in effect only the last is kept
  double top_speed_m_s_ = 0;
  double top_radius_m_ = 0;
  std::uint64_t violations_ = 0;
  std::vector<Order> orders_;
  std::vector<Alarm> alarms_;
  std::vector<Introduced> introductions_;
  std::vector<AuraRecord> past_;
  std::vector<AuraBatch> words_;  ///< of the newest state in which the neighbour stands
};

}  // namespace aurasim::core
