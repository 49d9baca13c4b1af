// What a node has composed of states that may still be computed again. It is given out once its state is certain
// (node::Node::shown_step), and dropped if the run goes back to before the state. So nobody sees a state that does not
// count.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <utility>

#include "core/ids.h"

namespace aurasim::process {

class HeldBack {
 public:
  /// Keeps what `give` gives out, of state `step`.
  void add(core::Step step, std::function<void()> give) { held_.push_back({step, std::move(give)}); }
  /// Gives out what is held of states up to `shown`, in the order in which it was added.
  void give_out(core::Step shown) {
    std::deque<Held> held = std::exchange(held_, {});
    for (Held& one : held) {
      if (one.step <= shown) {
        one.give();
      } else {
        held_.push_back(std::move(one));
      }
    }
  }
  /// To be called when the run goes back to state `step`. Later states are computed again.
  void put_back(core::Step step) {
    std::erase_if(held_, [step](const Held& one) { return one.step > step; });
  }
  void clear() { held_.clear(); }

 private:
  struct Held {
    core::Step step = 0;
    std::function<void()> give;
  };
  std::deque<Held> held_;
};

}  // namespace aurasim::process
