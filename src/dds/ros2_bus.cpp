#include "dds/ros2_bus.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fmt/format.h>

#include "core/fnv1a.h"
#include "dds/participant_qos.h"
#include "dds/rations.h"
#include "dds/ros2_topics.h"
#include "dds/speakers.h"
#include "dds/watch.h"
#include "dds/wire_transport.h"
#include "ros2PubSubTypes.h"
#include "rtps/datagram_guard.h"

namespace aurasim::dds {

using eprosima::fastdds::dds::DataReader;
using eprosima::fastdds::dds::DataWriter;
using eprosima::fastdds::dds::DomainParticipant;
using eprosima::fastdds::dds::DomainParticipantFactory;
using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::dds::HANDLE_NIL;
using eprosima::fastdds::dds::Publisher;
using eprosima::fastdds::dds::SampleInfo;
using eprosima::fastdds::dds::StatusMask;
using eprosima::fastdds::dds::Subscriber;
using eprosima::fastdds::dds::Topic;
using eprosima::fastdds::dds::TypeSupport;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

/// Most transforms in one message. With names of usual length it fits into a datagram of 64 kB.
constexpr std::size_t kTransformsAtOnce = 400;

/// Type support without type object and type information, as in ROS 2. With them Fast DDS 2.9.1 ends processes that do
/// not know the type.
template <class Generated>
class RosType : public Generated {
 public:
  RosType() {
    this->auto_fill_type_information(false);
    this->auto_fill_type_object(false);
  }

  /// Deserializes an invalid message as one whose number is not finite. If it were refused here, the reader would
  /// request it for ever.
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    if constexpr (std::is_same_v<typename Generated::type, geometry_msgs::msg::dds_::Twist_>) {
      if (!is_one(payload, data)) {
        static_cast<typename Generated::type*>(data)->linear_().x_(std::numeric_limits<double>::quiet_NaN());
      }
      return true;
    }
    return is_one(payload, data);
  }

 private:
  bool is_one(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) {
    if (payload == nullptr || payload->data == nullptr || payload->length < 4) return false;
    try {
      return Generated::deserialize(payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }
};

builtin_interfaces::msg::dds_::Time_ time_of(Ros2Time now) {
  using std::chrono::seconds;
  const auto whole = std::chrono::floor<seconds>(now);
  builtin_interfaces::msg::dds_::Time_ time;
  time.sec_(static_cast<std::int32_t>(whole.count()));
  time.nanosec_(static_cast<std::uint32_t>((now - whole).count()));
  return time;
}

core::Vec3 vector_of(const geometry_msgs::msg::dds_::Vector3_& v) { return {v.x_(), v.y_(), v.z_()}; }

std::uint64_t number_of(const Guid& writer) {
  core::Fnv1a hash;
  const auto add = [&hash](unsigned char octet) { hash.add_octet(octet); };
  std::ranges::for_each(writer.guidPrefix.value, add);
  std::ranges::for_each(writer.entityId.value, add);
  return std::max<std::uint64_t>(hash.value(), 1);
}

struct Leave {
  void operator()(DomainParticipant* participant) const {
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
};
using OwnParticipant = std::unique_ptr<DomainParticipant, Leave>;

OwnParticipant join(const Settings& settings, Profiles& profiles, const std::shared_ptr<rtps::DatagramGuard>& guard) {
  DomainParticipantQos qos = participant_qos(profiles, settings);
  const std::string_view enclave = "enclave=/;";  // ROS takes a participant with this user data for one of its own
  qos.user_data().setValue({enclave.begin(), enclave.end()});
  install(qos, {guard, nullptr});
  OwnParticipant participant(
      DomainParticipantFactory::get_instance()->create_participant(settings.domain, qos, nullptr, StatusMask::none()));
  if (participant == nullptr) {
    throw DdsError(fmt::format("cannot join ROS's DDS domain {} (ros2.domain) with the profiles of {}", settings.domain,
                               settings.profiles.string()));
  }
  guard->set_own(prefix_of(participant->guid().guidPrefix));
  const TypeSupport types[] = {TypeSupport(new RosType<rosgraph_msgs::msg::dds_::Clock_PubSubType>()),
                               TypeSupport(new RosType<tf2_msgs::msg::dds_::TFMessage_PubSubType>()),
                               TypeSupport(new RosType<sensor_msgs::msg::dds_::JointState_PubSubType>()),
                               TypeSupport(new RosType<geometry_msgs::msg::dds_::Twist_PubSubType>())};
  for (const TypeSupport& type : types) {
    if (type.register_type(participant.get()) != ReturnCode_t::RETCODE_OK) {
      throw DdsError(fmt::format("cannot register the type {}", type.get_type_name()));
    }
  }
  return participant;
}

}  // namespace

struct Ros2Bus::Impl {
  struct Publication {
    explicit Publication(Wakeup& wakeup) : watch(wakeup) {}

    void write(void* message) const { writer->write(message, HANDLE_NIL); }
    bool is_wanted() const { return !watch.readers().empty(); }

    WriterWatch watch;
    DataWriter* writer = nullptr;
  };
  struct Subscription {
    explicit Subscription(Wakeup& wakeup) : watch(wakeup) {}

    ReaderWatch watch;
    DataReader* reader = nullptr;
  };

  explicit Impl(const Ros2Settings& settings)
      : profiles(settings.dds.profiles), participant(join(settings.dds, profiles, guard)) {
    publisher = participant->create_publisher(eprosima::fastdds::dds::PUBLISHER_QOS_DEFAULT);
    subscriber = participant->create_subscriber(eprosima::fastdds::dds::SUBSCRIBER_QOS_DEFAULT);
    if (publisher == nullptr || subscriber == nullptr)
      throw DdsError("cannot create a publisher and a subscriber in ROS's DDS domain (ros2.domain)");
    advertise("/clock", kRos2Clock, "ros2_clock_writer", clock);
    advertise("/tf", kRos2Tf, "ros2_tf_writer", tf);
    advertise("/joint_states", kRos2JointState, "ros2_joint_states_writer", joints);
    for (const std::string& name : settings.cmd_vel) subscribe(ros2_cmd_vel_topic(name));
  }

  ~Impl() {
    const auto stopped = guard->delivery().stop();
    for (const Publication* publication : {&clock, &tf, &joints}) {
      if (publication->writer != nullptr) publication->writer->set_listener(nullptr);
    }
    for (const auto& subscription : drivers) subscription->reader->set_listener(nullptr);
  }

  Topic& topic(const std::string& name, const Ros2Type& type) {
    Topic* const made = participant->create_topic(ros2_wire_name(name), std::string(type.dds_name),
                                                  eprosima::fastdds::dds::TOPIC_QOS_DEFAULT);
    if (made == nullptr) throw DdsError(fmt::format("cannot create the topic {} of ROS", name));
    return *made;
  }

  void advertise(const std::string& name, const Ros2Type& type, const char* profile, Publication& publication) {
    Topic& of_ros = topic(name, type);
    auto qos = profiles.writer(*publisher, profile);
    qos.user_data().setValue(ros2_user_data(type));
    const auto stopped = guard->delivery().stop();
    publication.writer =
        publisher->create_datawriter(&of_ros, qos, &publication.watch, StatusMask::publication_matched());
    if (publication.writer == nullptr) throw DdsError(fmt::format("cannot create the writer of {} of ROS", name));
  }

  void subscribe(const std::string& name) {
    Topic& of_ros = topic(name, kRos2Twist);
    auto qos = profiles.reader(*subscriber, "ros2_cmd_vel_reader");
    qos.user_data().setValue(ros2_user_data(kRos2Twist));
    auto subscription = std::make_unique<Subscription>(wakeup);
    const auto stopped = guard->delivery().stop();
    subscription->reader = subscriber->create_datareader(
        &of_ros, qos, &subscription->watch, StatusMask::data_available() << StatusMask::subscription_matched());
    if (subscription->reader == nullptr) throw DdsError(fmt::format("cannot create the reader of {} of ROS", name));
    drivers.push_back(std::move(subscription));
  }

  void take(std::size_t listener, std::vector<Ros2Twist>& taken) {
    geometry_msgs::msg::dds_::Twist_ message;
    SampleInfo info;
    const auto now = std::chrono::steady_clock::now();
    while (drivers[listener]->reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const Guid writer = eprosima::fastrtps::rtps::iHandle2GUID(info.publication_handle);
      Ros2Twist twist{listener, number_of(writer), info.sample_identity.sequence_number().to64long(),
                      vector_of(message.linear_()), vector_of(message.angular_())};
      const bool is_sound = twist.linear.allFinite() && twist.angular.allFinite();
      if (is_sound && rates.allows(writer, now)) {
        taken.push_back(std::move(twist));
      } else {
        ++refused;
      }
    }
  }

  Wakeup wakeup;  // no thread waits on it: a node polls before each state
  std::shared_ptr<rtps::DatagramGuard> guard = std::make_shared<rtps::DatagramGuard>();
  Profiles profiles;
  Publication clock{wakeup}, tf{wakeup}, joints{wakeup};
  std::vector<std::unique_ptr<Subscription>> drivers;  ///< as Ros2Settings::cmd_vel
  OwnParticipant participant;                          // destroyed before the listeners of its endpoints
  Publisher* publisher = nullptr;
  Subscriber* subscriber = nullptr;
  RateLimit<Guid> rates{kSetpointsASecond, kSetpointsAtOnce};
  std::uint64_t refused = 0;
  rosgraph_msgs::msg::dds_::Clock_ clock_message;
  tf2_msgs::msg::dds_::TFMessage_ tf_message;  // reused
  sensor_msgs::msg::dds_::JointState_ joints_message;
  std::string frame;
};

Ros2Bus::Ros2Bus(const Ros2Settings& settings) : impl_(std::make_unique<Impl>(settings)) {
  impl_->frame = settings.frame;
}

Ros2Bus::~Ros2Bus() = default;

bool Ros2Bus::wants_clock() const { return impl_->clock.is_wanted(); }

bool Ros2Bus::wants_tf() const { return impl_->tf.is_wanted(); }

bool Ros2Bus::wants_joints() const { return impl_->joints.is_wanted(); }

std::uint64_t Ros2Bus::arrivals() const {
  return impl_->clock.watch.matches() + impl_->tf.watch.matches() + impl_->joints.watch.matches();
}

void Ros2Bus::say_clock(Ros2Time now) {
  impl_->clock_message.clock_(time_of(now));
  impl_->clock.write(&impl_->clock_message);
}

void Ros2Bus::say_tf(Ros2Time now, std::span<const Ros2Transform> transforms) {
  auto& rows = impl_->tf_message.transforms_();
  const auto stamp = time_of(now);
  for (std::size_t first = 0; first < transforms.size(); first += kTransformsAtOnce) {
    const auto some = transforms.subspan(first, std::min(kTransformsAtOnce, transforms.size() - first));
    rows.resize(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
      const core::Vec3& p = some[i].pose.p_WB;
      const core::Quat& q = some[i].pose.q_WB;
      rows[i].header_().stamp_(stamp);
      rows[i].header_().frame_id_(impl_->frame);
      rows[i].child_frame_id_(some[i].child);
      auto& translation = rows[i].transform_().translation_();
      translation.x_(p.x()), translation.y_(p.y()), translation.z_(p.z());
      auto& rotation = rows[i].transform_().rotation_();
      rotation.x_(q.x()), rotation.y_(q.y()), rotation.z_(q.z()), rotation.w_(q.w());
    }
    impl_->tf.write(&impl_->tf_message);
  }
}

void Ros2Bus::say_joints(Ros2Time now, const Ros2Joints& joints) {
  impl_->joints_message.header_().stamp_(time_of(now));
  impl_->joints_message.name_(joints.name);
  impl_->joints_message.position_(joints.position);
  impl_->joints_message.velocity_(joints.velocity);
  impl_->joints.write(&impl_->joints_message);
}

std::vector<Ros2Twist> Ros2Bus::take() {
  std::vector<Ros2Twist> taken;
  for (std::size_t i = 0; i < impl_->drivers.size(); ++i) impl_->take(i, taken);
  return taken;
}

std::uint64_t Ros2Bus::refused() const { return impl_->refused; }

}  // namespace aurasim::dds
