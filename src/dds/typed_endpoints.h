// Writers and readers of one message type each: they encode on sending, and check and decode on receipt.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "aurasim.h"
#include "dds/endpoints.h"
#include "messages/checkpoint_codec.h"
#include "messages/cluster_graph_codec.h"
#include "messages/codec.h"
#include "messages/command_codec.h"
#include "messages/control_codec.h"
#include "messages/interest_codec.h"
#include "messages/observation_codec.h"
#include "messages/replica_codec.h"
#include "messages/setpoint_codec.h"

namespace aurasim::dds {

/// `Wire` is the generated type of the topic.
template <class Wire>
class TypedWriter : public Writer {
 public:
  using Writer::Writer;

  /// Encodes by encode(message..., Wire) and writes the result.
  template <class... Message>
  WriteResult send(const Message&... message) {
    messages::encode(message..., sample_);
    return write(&sample_);
  }
  /// Sends a message that replaces all earlier ones of this writer. Readers that join later receive it alone.
  template <class... Message>
  WriteResult send_newest(const Message&... message) {
    messages::encode(message..., sample_);
    forget_all();
    return write(&sample_);
  }

 private:
  Wire sample_;  // reused
};

/// Reader of one type. Unsound samples are counted and dropped.
template <class Wire>
class TypedReader : public Reader {
 public:
  using Message =
      std::variant_alternative_t<0, decltype(messages::decode(std::declval<const Wire&>(), messages::Expected{}))>;

  using Reader::Reader;

  /// Calls `visit(message)` or `visit(message, origin)` for each message that has arrived, and `refuse(sample, error)`
  /// for each invalid sample. `at_most` limits the samples of one call, in case they arrive faster than they are taken.
  template <class Visit, class Refuse>
  void take_each(const messages::Expected& expected, Visit&& visit, Refuse&& refuse, std::size_t at_most = SIZE_MAX) {
    Origin origin;
    while (at_most-- > 0 && take(&sample_, &origin)) {
      auto decoded = messages::decode(sample_, expected);
      if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
        refused_.add(*error);
        refuse_from(origin, *error);
        refuse(std::as_const(sample_), *error);
      } else if constexpr (std::is_invocable_v<Visit, Message&&, const Origin&>) {
        visit(std::move(std::get<Message>(decoded)), std::as_const(origin));
      } else {
        visit(std::move(std::get<Message>(decoded)));
      }
    }
    refused_.add(messages::WireError::kParts, take_lost());
  }
  template <class Visit>
  void take_each(const messages::Expected& expected, Visit&& visit) {
    take_each(expected, std::forward<Visit>(visit), [](const Wire&, messages::WireError) {});
  }
  /// Appends all messages that have arrived to `out`.
  void take_all(const messages::Expected& expected, std::vector<Message>& out) {
    take_each(expected, [&out](Message&& message) { out.push_back(std::move(message)); });
  }

  const messages::WireErrors& refused() const { return refused_; }

 private:
  Wire sample_;  // reused
  messages::WireErrors refused_;
};

}  // namespace aurasim::dds
