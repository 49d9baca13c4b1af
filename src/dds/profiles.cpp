#include "dds/profiles.h"

#include <mutex>
#include <set>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fmt/format.h>

#include "dds/settings.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DomainParticipantFactory;
using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

/// Loads a file unless it was loaded before. Fast DDS keeps one set of profiles per process and refuses a name that it
/// already has.
void load_once(const std::filesystem::path& file) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> loaded;
  const std::lock_guard lock(mutex);
  std::error_code error;
  const auto path = std::filesystem::canonical(file, error);
  if (error) {
    throw DdsError(fmt::format("{}: cannot read the DDS profiles: {}", file.string(), error.message()));
  }
  if (loaded.contains(path)) {
    return;
  }
  if (DomainParticipantFactory::get_instance()->load_XML_profiles_file(path.string()) != ReturnCode_t::RETCODE_OK) {
    throw DdsError(fmt::format(
        "{}: Fast DDS refuses these profiles (its message is on standard error): an unknown element, a wrong value, or "
        "a profile name that another loaded file has too",
        file.string()));
  }
  loaded.insert(path);
}

/// Variants of a file lie in a folder below it, as in qos/impaired/.
std::filesystem::path shared_file_for(const std::filesystem::path& file) {
  const std::filesystem::path beside = file.parent_path() / "aurasim.xml";
  const std::filesystem::path above = file.parent_path() / ".." / "aurasim.xml";
  return !std::filesystem::exists(beside) && std::filesystem::exists(above) ? above : beside;
}

}  // namespace

Profiles::Profiles(std::filesystem::path file) : file_(std::move(file)), shared_file_(shared_file_for(file_)) {
  if (file_.empty()) {
    throw DdsError("no file with DDS profiles given (dds.profiles)");
  }
  load_once(file_);
}

template <class Qos, class Get>
Qos Profiles::find(std::string_view kind, std::string_view own_name, std::string_view shared_name, Get get) {
  Qos qos;
  const auto found = [&](std::string_view name) { return get(std::string(name), qos) == ReturnCode_t::RETCODE_OK; };
  if (found(own_name) || found(shared_name)) {
    return qos;
  }
  if (std::filesystem::exists(shared_file_)) {
    load_once(shared_file_);
    if (found(shared_name)) {
      return qos;
    }
  }
  throw DdsError(fmt::format("{}: no {} profile named '{}' or '{}', and none named '{}' in {}", file_.string(), kind,
                             own_name, shared_name, shared_name, shared_file_.string()));
}

DomainParticipantQos Profiles::participant() {
  const auto get = [](const std::string& name, auto& qos) {
    return DomainParticipantFactory::get_instance()->get_participant_qos_from_profile(name, qos);
  };
  auto qos =
      find<DomainParticipantQos>("participant", file_.stem().string() + "_participant", "aurasim_participant", get);
  DomainParticipantQos impairment;
  if (get(file_.stem().string() + "_impairment", impairment) == ReturnCode_t::RETCODE_OK) {
    for (const auto& property : impairment.properties().properties()) {
      qos.properties().properties().push_back(property);
    }
  }
  return qos;
}

eprosima::fastdds::dds::DataWriterQos Profiles::writer(eprosima::fastdds::dds::Publisher& publisher,
                                                       std::string_view name) {
  return find<eprosima::fastdds::dds::DataWriterQos>(
      "data_writer", fmt::format("{}_{}", file_.stem().string(), name), name,
      [&](const std::string& profile, auto& qos) { return publisher.get_datawriter_qos_from_profile(profile, qos); });
}

eprosima::fastdds::dds::DataReaderQos Profiles::reader(eprosima::fastdds::dds::Subscriber& subscriber,
                                                       std::string_view name) {
  return find<eprosima::fastdds::dds::DataReaderQos>(
      "data_reader", fmt::format("{}_{}", file_.stem().string(), name), name,
      [&](const std::string& profile, auto& qos) { return subscriber.get_datareader_qos_from_profile(profile, qos); });
}

}  // namespace aurasim::dds
