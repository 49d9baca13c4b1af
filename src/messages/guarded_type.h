// Wraps the generated type supports to make them safe. As generated, one boolean that is neither 0 nor 1 throws through
// a DDS thread and ends the process, and getKey() writes one buffer from several threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <set>

#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SerializedPayload.h>

#include "messages/part_fields.h"

namespace aurasim::messages {

/// Largest number of keys per topic; further keys all share one. Readers keep state for every key and cannot forget one
/// whose samples are still to come, and a limit in the reader would end the process (DataReaderHistory.cpp, find_key).
inline constexpr std::size_t kMostKeys = 4096;

/// Deserializes a sample whose bytes do not fit the type as version 0, which the codec calls malformed. Refusing it
/// here is no option: the reader would ask its writer for it for ever.
template <class Generated>
class GuardedType final : public Generated, public HasPartFields {
 public:
  using Message = typename Generated::type;

  /// `announces`: each endpoint of the type announces its TypeObject, with which generic tools print samples.
  explicit GuardedType(bool announces = true) {
    this->auto_fill_type_information(false);  // CycloneDDS 0.10.2 rejects endpoints that announce it
    this->auto_fill_type_object(announces);
  }

  const PartFields* part_fields() const override {
    if constexpr (InParts<Message>) {
      static const PartFieldsOf<Message> kFields{};
      return &kFields;
    } else {
      return nullptr;
    }
  }

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    if (!deserialize_safely(*payload, data)) {
      static_cast<Message*>(data)->version(0);
    }
    return true;
  }

  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override {
    const std::lock_guard lock(key_mutex_);
    if (!Generated::getKey(data, handle, force_md5)) return false;
    if (keys_.size() < kMostKeys) keys_.insert(handle->value);
    if (!keys_.contains(handle->value)) std::fill_n(&handle->value[0], kKeyBytes, 0xff);
    return true;
  }

 private:
  bool deserialize_safely(eprosima::fastrtps::rtps::SerializedPayload_t& payload, void* data) {
    if (payload.data == nullptr || payload.length < 4 || payload.length > kLargestMessage_B) {
      return false;
    }
    try {
      return Generated::deserialize(&payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }

  static constexpr std::size_t kKeyBytes = sizeof(eprosima::fastrtps::rtps::KeyHash_t);

  std::mutex key_mutex_;
  std::set<eprosima::fastrtps::rtps::InstanceHandleValue_t> keys_;
};

}  // namespace aurasim::messages
