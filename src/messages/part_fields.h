// The part_* fields of the topic types (idl/aurasim.idl).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "messages/parts.h"

namespace aurasim::messages {

/// Access to the part_* fields of samples of one topic type.
class PartFields {
 public:
  virtual ~PartFields() = default;
  /// A sample without content.
  virtual std::shared_ptr<void> make_sample() const = 0;
  /// Serialized size of a part without octets, with the encapsulation.
  virtual std::uint32_t empty_B() const = 0;
  /// Makes `sample` a whole message. A sample that has been received into may still have the fields of a part.
  virtual void clear(void* sample) const = 0;
  /// Makes `sample` a part of the message `whole`.
  virtual void put(const void* whole, const Part& part, void* sample) const = 0;
  /// Returns the part that `sample` is; nothing when it is a whole message, or none at all.
  virtual std::optional<Part> get(const void* sample) const = 0;
};

/// A topic type whose messages may come in parts.
template <class Message>
concept InParts = requires(Message& message) {
  message.part_octets();
};

template <InParts Message>
class PartFieldsOf final : public PartFields {
 public:
  std::shared_ptr<void> make_sample() const override { return std::make_shared<Message>(); }

  std::uint32_t empty_B() const override {
    return kEncapsulation_B + static_cast<std::uint32_t>(Message::getCdrSerializedSize(Message{}));
  }

  void clear(void* sample) const override {
    auto& message = *static_cast<Message*>(sample);
    message.part_message(0);
    message.part_number(0);
    message.part_count(0);
    message.part_octets().clear();
  }

  void put(const void* whole, const Part& part, void* sample) const override {
    const auto& from = *static_cast<const Message*>(whole);
    auto& to = *static_cast<Message*>(sample);
    copy_header(from, to);
    to.part_message(part.message);
    to.part_number(part.number);
    to.part_count(part.count);
    to.part_octets().assign(part.octets.begin(), part.octets.end());
  }

  std::optional<Part> get(const void* sample) const override {
    const auto& from = *static_cast<const Message*>(sample);
    if (from.version() == 0 || from.part_message() == 0) return std::nullopt;  // version 0: set by GuardedType
    return Part{from.part_message(), from.part_number(), from.part_count(), from.part_octets()};
  }

 private:
  static constexpr std::uint32_t kEncapsulation_B = 4;

  /// Copies the header and the key, whose fields differ from type to type.
  static void copy_header(const Message& from, Message& to) {
    to.version(from.version());
    to.generation(from.generation());
    to.stamp(from.stamp());
    to.map_version(from.map_version());
    if constexpr (requires { from.source(); }) to.source(from.source());
    if constexpr (requires { from.destination(); }) to.destination(from.destination());
    if constexpr (requires { from.kind(); }) to.kind(from.kind());
    if constexpr (requires { from.sender(); }) to.sender(from.sender());
    if constexpr (requires { from.client(); }) to.client(from.client());
    if constexpr (requires { from.hash(); }) to.hash(from.hash());
  }
};

/// Base of the types that Domain registers.
class HasPartFields {
 public:
  virtual ~HasPartFields() = default;
  /// Null: messages of this type are never larger than a datagram.
  virtual const PartFields* part_fields() const = 0;
};

}  // namespace aurasim::messages
