// Messages to observers about states that may still be computed again. A message is given out once its state is certain
// (node::Node::shown_step), and dropped if the run goes back to before the state. So nobody sees a state that does not
// count.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "core/ids.h"

namespace aurasim::process {

class HeldBack {
 public:
  /// Keeps what `give` gives out, of state `step`.
  void add(core::Step step, std::function<void()> give) { held_.push_back({step, std::move(give)}); }
  /// Gives out what is held of states up to `shown`, in the order in which it was added.
  void give_out(core::Step shown) {
    for (Held& one : held_) {
      if (one.step <= shown) one.give();
    }
    std::erase_if(held_, [shown](const Held& one) { return one.step <= shown; });
  }
  /// To be called when the run goes back to state `step`. Later states are computed again. Those up to `confirmed` are
  /// given out first, by all nodes, because a body may have another host afterwards.
  void put_back(core::Step step, core::Step confirmed) {
    give_out(confirmed);
    std::erase_if(held_, [step](const Held& one) { return one.step > step; });
  }
  void clear() { held_.clear(); }

 private:
  struct Held {
    core::Step step = 0;
    std::function<void()> give;
  };
  std::vector<Held> held_;
};

}  // namespace aurasim::process
