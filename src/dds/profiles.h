// QoS by name from the XML files in qos/. See Settings::profiles for the rule of names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

namespace aurasim::dds {

class Profiles {
 public:
  /// Loads `file`. Throws DdsError when it cannot be read or Fast DDS refuses it.
  explicit Profiles(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }

  // Each getter throws DdsError with the file and the names that were looked for.
  eprosima::fastdds::dds::DomainParticipantQos participant();  ///< with the properties of `<stem>_impairment`
  eprosima::fastdds::dds::DataWriterQos writer(eprosima::fastdds::dds::Publisher& publisher, std::string_view name);
  eprosima::fastdds::dds::DataReaderQos reader(eprosima::fastdds::dds::Subscriber& subscriber, std::string_view name);

 private:
  template <class Qos, class Get>
  Qos find(std::string_view kind, std::string_view own_name, std::string_view shared_name, Get get);

  std::filesystem::path file_;
  std::filesystem::path shared_file_;  ///< aurasim.xml beside it or one folder up, for what it lacks
};

}  // namespace aurasim::dds
