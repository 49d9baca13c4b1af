#include "core/body_state.h"

namespace aurasim::core {

BodyState state_of(const BodyRecord& record) {
  BodyState state;
  state.id = record.id;
  state.epoch = record.epoch;
  state.prototype = record.prototype;
  state.awake = record.activation_state != 2 && record.activation_state != 5;
  state.birth = record.birth;
  state.pose = {record.p_WB, Quat(record.R_WB)};
  state.v_WB = record.v_WB;
  state.w_WB = record.w_WB;
  return state;
}

}  // namespace aurasim::core
