// A client of a run that knows ROS 2's messages and nothing else, made with Cyclone DDS: listens to /clock, /tf and
// /joint_states with the QoS of rclcpp, tf2 and RViz, looks at what the endpoints announce, drives "robot" by
// /robot/cmd_vel, and sees it stop when nobody speaks any more.
//   cyclone_ros2 DOMAIN REGIONS      exit code 0: all of it was seen, 1: not in time, what is missing is printed
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dds/dds.h"
#include "ros2.h"

enum { kSamples = 64, kEnough = 20 };

typedef rosgraph_msgs_msg_dds__Clock_ Clock;
typedef tf2_msgs_msg_dds__TFMessage_ TfMessage;
typedef sensor_msgs_msg_dds__JointState_ JointState;
typedef geometry_msgs_msg_dds__Twist_ Twist;

static unsigned clocks, joint_messages, other_frames;
static dds_instance_handle_t clock_writer;
static double now_s = -1;             ///< as /clock said last
static double robot[2], start[2];     ///< where it is
static double robot_s = -1;           ///< and when, in simulated time
static double swing, fastest_swing;   ///< of the joint: rad; rad/s
static dds_entity_t clock_reader, tf_reader, joint_reader;

static void fail(const char* what) {
  fprintf(stderr, "cyclone_ros2: %s\n", what);
  exit(1);
}

static dds_entity_t need(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "cyclone_ros2: %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static double seconds(const builtin_interfaces_msg_dds__Time_* time) { return time->sec_ + 1e-9 * time->nanosec_; }

static dds_qos_t* qos_of(dds_reliability_kind_t reliability, int32_t depth) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, reliability, DDS_SECS(1));
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

static dds_entity_t reader(dds_entity_t participant, const dds_topic_descriptor_t* type, const char* name,
                           dds_reliability_kind_t reliability, int32_t depth) {
  const dds_entity_t topic = need(dds_create_topic(participant, type, name, NULL, NULL), name);
  dds_qos_t* qos = qos_of(reliability, depth);
  const dds_entity_t made = need(dds_create_reader(participant, topic, qos, NULL), name);
  dds_delete_qos(qos);
  return made;
}

static void look_at_clock(const dds_sample_info_t* info, const void* sample) {
  const double time = seconds(&((const Clock*)sample)->clock_);
  if (clock_writer != 0 && clock_writer != info->publication_handle) fail("two nodes say what time it is");
  if (time < now_s) fail("the clock goes back");
  clock_writer = info->publication_handle;
  now_s = time;
  ++clocks;
}

static void look_at_tf(const dds_sample_info_t* info, const void* sample) {
  (void)info;
  const TfMessage* message = sample;
  for (uint32_t i = 0; i < message->transforms_._length; ++i) {
    const geometry_msgs_msg_dds__TransformStamped_* one = &message->transforms_._buffer[i];
    const geometry_msgs_msg_dds__Quaternion_* q = &one->transform_.rotation_;
    if (strcmp(one->header_.frame_id_, "world") != 0) fail("a frame whose parent is not the world");
    if (fabs(q->x_ * q->x_ + q->y_ * q->y_ + q->z_ * q->z_ + q->w_ * q->w_ - 1) > 1e-6) fail("no rotation in /tf");
    if (strcmp(one->child_frame_id_, "robot") != 0) {
      other_frames += strncmp(one->child_frame_id_, "body_", 5) == 0;
      continue;
    }
    robot[0] = one->transform_.translation_.x_;
    robot[1] = one->transform_.translation_.y_;
    robot_s = seconds(&one->header_.stamp_);
  }
}

static void look_at_joints(const dds_sample_info_t* info, const void* sample) {
  (void)info;
  const JointState* message = sample;
  const uint32_t count = message->name_._length;
  if (message->position_._length != count || message->velocity_._length != count) fail("joints without numbers");
  if (message->effort_._length != 0) fail("joints whose effort nobody knows");
  for (uint32_t i = 0; i < count; ++i) {
    if (strcmp(message->name_._buffer[i], "swing") != 0) fail("a joint that is not in the scene");
    swing = message->position_._buffer[i];
    fastest_swing = fmax(fastest_swing, fabs(message->velocity_._buffer[i]));
    ++joint_messages;
  }
}

static void take_all(dds_entity_t from, void (*look)(const dds_sample_info_t* info, const void* sample)) {
  void* samples[kSamples] = {NULL};
  dds_sample_info_t infos[kSamples];
  int32_t count;
  while ((count = dds_take(from, samples, infos, kSamples, kSamples)) > 0) {
    for (int32_t i = 0; i < count; ++i) {
      if (infos[i].valid_data) look(&infos[i], samples[i]);
    }
    dds_return_loan(from, samples, count);
    samples[0] = NULL;
  }
}

static void listen(void) {
  take_all(clock_reader, look_at_clock);
  take_all(tf_reader, look_at_tf);
  take_all(joint_reader, look_at_joints);
  dds_sleepfor(DDS_MSECS(5));
}

/// That every one of `count` endpoints at the other end has this type, and says its hash as ROS does.
static void check_announced(dds_builtintopic_endpoint_t* (*data_of)(dds_entity_t, dds_instance_handle_t),
                            int32_t (*matched)(dds_entity_t, dds_instance_handle_t*, size_t), dds_entity_t endpoint,
                            int32_t count, const char* type, const char* hash) {
  dds_instance_handle_t others[kSamples];
  const int32_t found = matched(endpoint, others, kSamples);
  if (found != count) fail("not one endpoint for each node");
  for (int32_t i = 0; i < found; ++i) {
    dds_builtintopic_endpoint_t* other = data_of(endpoint, others[i]);
    if (other == NULL || strcmp(other->type_name, type) != 0) fail("an endpoint of another type");
    void* user_data = NULL;
    size_t size = 0;
    char expected[128];
    snprintf(expected, sizeof expected, "typehash=RIHS01_%s;", hash);
    const int has_it = dds_qget_userdata(other->qos, &user_data, &size) && user_data != NULL;
    if (!has_it || size != strlen(expected) || memcmp(user_data, expected, size) != 0) fail("another type hash");
    printf("%s: %s\n", other->topic_name, expected);
    dds_free(user_data);
    dds_builtintopic_free_endpoint(other);
  }
}

static void wait_for(int (*condition)(void), const char* what) {
  const dds_time_t deadline = dds_time() + DDS_SECS(20);
  while (!condition()) {
    if (dds_time() > deadline) fail(what);
    listen();
  }
}

static int all_heard(void) {
  return clocks >= kEnough && joint_messages >= kEnough && other_frames > 0 && robot_s >= 0 && fastest_swing > 0.1;
}

/// Its ahead is the world's -x.
static double way(void) { return start[0] - robot[0]; }

static dds_entity_t driver;
static int drives(void) {
  static dds_time_t next;
  static Twist twist = {.linear_ = {.x_ = 1.5, .z_ = 7}, .angular_ = {.x_ = 3}};  // a base obeys neither z nor x
  if (dds_time() >= next) {
    need(dds_write(driver, &twist), "write a twist");
    next = dds_time() + DDS_MSECS(50);
  }
  return way() > 3;  // through the border
}

static void drive(dds_entity_t participant, int32_t regions) {
  const dds_entity_t topic =
      need(dds_create_topic(participant, &geometry_msgs_msg_dds__Twist__desc, "rt/robot/cmd_vel", NULL, NULL), "topic");
  dds_qos_t* qos = qos_of(DDS_RELIABILITY_RELIABLE, 10);
  driver = need(dds_create_writer(participant, topic, qos, NULL), "cmd_vel");
  dds_delete_qos(qos);
  dds_publication_matched_status_t matched = {0};
  for (int i = 0; i < 2000 && matched.current_count < (uint32_t)regions; ++i) {
    listen();
    dds_get_publication_matched_status(driver, &matched);
  }
  check_announced(dds_get_matched_subscription_data, dds_get_matched_subscriptions, driver, regions,
                  "geometry_msgs::msg::dds_::Twist_", "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a");
  start[0] = robot[0], start[1] = robot[1];
  const double before_s = robot_s;
  wait_for(drives, "the robot does not drive where it is told to");
  const double speed = way() / (robot_s - before_s);
  if (speed < 1 || speed > 1.6) fail("the robot has another speed than it was told");
  if (fabs(robot[1] - start[1]) > 0.3) fail("the robot does not drive straight ahead");
  printf("the robot has driven %.2f m in %.2f s\n", way(), robot_s - before_s);
}

static double silent_s, rest[2];
static int has_been_silent(void) { return robot_s > silent_s + 1.5; }
static int has_rested(void) { return robot_s > silent_s + 2.5; }

/// A second after nobody has spoken for control.silence.
static void see_it_stop(void) {
  silent_s = robot_s;
  wait_for(has_been_silent, "the robot is not heard of any more");
  rest[0] = robot[0], rest[1] = robot[1];
  wait_for(has_rested, "the robot is not heard of any more");
  if (hypot(robot[0] - rest[0], robot[1] - rest[1]) > 0.02) fail("the robot drives on, and nobody tells it to");
}

int main(int argc, char** argv) {
  if (argc != 3) fail("cyclone_ros2 DOMAIN REGIONS");
  const int32_t regions = atoi(argv[2]);
  const dds_entity_t participant = need(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "domain");
  clock_reader =
      reader(participant, &rosgraph_msgs_msg_dds__Clock__desc, "rt/clock", DDS_RELIABILITY_BEST_EFFORT, 1);
  tf_reader = reader(participant, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf", DDS_RELIABILITY_RELIABLE, 100);
  joint_reader =
      reader(participant, &sensor_msgs_msg_dds__JointState__desc, "rt/joint_states", DDS_RELIABILITY_RELIABLE, 10);
  wait_for(all_heard, "clock, frames or joints were not heard");
  check_announced(dds_get_matched_publication_data, dds_get_matched_publications, clock_reader, regions,
                  "rosgraph_msgs::msg::dds_::Clock_", "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  check_announced(dds_get_matched_publication_data, dds_get_matched_publications, tf_reader, regions,
                  "tf2_msgs::msg::dds_::TFMessage_", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  check_announced(dds_get_matched_publication_data, dds_get_matched_publications, joint_reader, regions,
                  "sensor_msgs::msg::dds_::JointState_",
                  "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e");
  printf("%u clocks, %u joint states, the joint turns by up to %.2f rad/s\n", clocks, joint_messages, fastest_swing);
  drive(participant, regions);
  see_it_stop();
  printf("the robot was driven, and stopped in silence\n");
  dds_delete(participant);
  return 0;
}
