// Which endpoints announce their TypeObject, as another program with Fast DDS sees it.
#include <map>
#include <mutex>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <gtest/gtest.h>

#include "dds/participant_qos.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

/// Notes of each topic whether any of its writers has announced the type.
class OtherProgram : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  OtherProgram() : profiles_(testing::settings_for(own_domain()).profiles) {
    const Settings settings = testing::settings_for(own_domain());
    participant_ = factory().create_participant(settings.domain, participant_qos(profiles_, settings), this,
                                                eprosima::fastdds::dds::StatusMask::none());
  }
  ~OtherProgram() override {
    participant_->set_listener(nullptr);
    factory().delete_participant(participant_);
  }

  bool has_discovered(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return has_type_.contains(topic);
  }
  bool has_type(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return has_type_.at(topic);
  }

 private:
  static eprosima::fastdds::dds::DomainParticipantFactory& factory() {
    return *eprosima::fastdds::dds::DomainParticipantFactory::get_instance();
  }
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    has_type_[info.info.topicName().to_string()] |= info.info.has_type();
  }

  std::mutex mutex_;
  std::map<std::string, bool> has_type_;
  Profiles profiles_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
};

bool announces(bool settings_say) {
  OtherProgram other;
  Settings settings = testing::settings_for(own_domain());
  settings.announces_types = settings_say;
  Participant participant(settings);
  const ControlBus control(participant, {.region = core::RegionId{1}});
  EXPECT_TRUE(testing::holds_in_time([&] { return other.has_discovered("node_status"); }));
  return other.has_type("node_status");
}

TEST(TypeObjects, AreAnnouncedOnlyByParticipantsThatAreToDoIt) {
  EXPECT_FALSE(announces(false));
  EXPECT_TRUE(announces(true));
}

}  // namespace
}  // namespace aurasim::dds
