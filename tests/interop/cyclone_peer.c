// A client of a run that knows nothing of aurasim but idl/aurasim.idl, and nothing of Fast DDS: made with Cyclone DDS.
// Reads aura, node_status and replica, partition by partition, then asks for a body, pushes it, and sees it move.
//   cyclone_peer DOMAIN REGIONS      exit code 0: all of it was seen, 1: not in time, what is missing is printed
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "aurasim.h"
#include "dds/dds.h"

enum { kMaxRegions = 16, kEnough = 60, kSamples = 64 };
enum { kAccepted = 0, kDone = 1 };
enum { kSpawn = 0, kImpulse = 4, kSphere = 1, kRunning = 2 };

/// What has been read in the partition of one region.
struct Region {
  dds_entity_t aura, node_status, replica;
  unsigned auras, statuses, replicas;
  int64_t last_stamp;
};

static struct Region regions[kMaxRegions];
static unsigned region_count;
static int by_hub;  ///< then a reader of one region gets the statuses of all
static uint64_t body;          ///< the one that was asked for
static int body_was_seen;
static float body_rises_m_s;   ///< its upward velocity as last told

static void fail(const char* what) {
  fprintf(stderr, "cyclone_peer: %s\n", what);
  exit(1);
}

static dds_entity_t need(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "cyclone_peer: %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static dds_qos_t* reliable(dds_durability_kind_t durability) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, durability);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  return qos;
}

static dds_qos_t* in_partition(const char* name) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, name);
  return qos;
}

static dds_entity_t reader(dds_entity_t participant, dds_entity_t subscriber, const dds_topic_descriptor_t* type,
                           const char* topic_name, dds_durability_kind_t durability) {
  const dds_entity_t topic = need(dds_create_topic(participant, type, topic_name, NULL, NULL), topic_name);
  dds_qos_t* qos = reliable(durability);
  const dds_entity_t made = need(dds_create_reader(subscriber, topic, qos, NULL), topic_name);
  dds_delete_qos(qos);
  return made;
}

static void listen_to_region(dds_entity_t participant, unsigned r) {
  char partition[32];
  snprintf(partition, sizeof partition, "region/%u", r);
  dds_qos_t* qos = in_partition(partition);
  const dds_entity_t subscriber = need(dds_create_subscriber(participant, qos, NULL), partition);
  dds_delete_qos(qos);
  regions[r].last_stamp = -1;
  regions[r].aura = reader(participant, subscriber, &aurasim_wire_AuraBatch_desc, "aura", DDS_DURABILITY_VOLATILE);
  regions[r].node_status =
      reader(participant, subscriber, &aurasim_wire_NodeStatus_desc, "node_status", DDS_DURABILITY_TRANSIENT_LOCAL);
  regions[r].replica = reader(participant, subscriber, &aurasim_wire_Replica_desc, "replica", DDS_DURABILITY_VOLATILE);
}

/// Hands every sample that has come to `look`.
static void take_all(dds_entity_t from, unsigned r, void (*look)(unsigned r, const void* sample)) {
  void* samples[kSamples] = {NULL};
  dds_sample_info_t infos[kSamples];
  int32_t count;
  while ((count = dds_take(from, samples, infos, kSamples, kSamples)) > 0) {
    for (int32_t i = 0; i < count; ++i) {
      if (infos[i].valid_data) look(r, samples[i]);
    }
    dds_return_loan(from, samples, count);
    samples[0] = NULL;
  }
}

/// One batch per step, none left out.
static void look_at_aura(unsigned r, const void* sample) {
  const aurasim_wire_AuraBatch* batch = sample;
  if (batch->source != r) fail("an aura batch in another region's partition");
  if (regions[r].last_stamp >= 0 && batch->stamp != regions[r].last_stamp + 1) fail("a step without an aura batch");
  if (batch->p_WB._length + batch->grains_WB._length != 3 * batch->id._length) fail("an aura batch whose columns do not fit together");
  regions[r].last_stamp = batch->stamp;
  ++regions[r].auras;
}

static void look_at_status(unsigned r, const void* sample) {
  const aurasim_wire_NodeStatus* status = sample;
  if (status->source != r && by_hub) return;
  if (status->source != r) fail("a status in another region's partition");
  regions[r].statuses += status->state == kRunning;
}

static void look_at_replica(unsigned r, const void* sample) {
  const aurasim_wire_Replica* replica = sample;
  if (replica->source != r) fail("a replica in another region's partition");
  if (replica->v_WB._length != 3 * replica->id._length) fail("a replica whose columns do not fit together");
  ++regions[r].replicas;
  for (uint32_t i = 0; i < replica->id._length; ++i) {
    if (replica->id._buffer[i] != body) continue;
    body_was_seen = 1;
    body_rises_m_s = replica->v_WB._buffer[3 * i + 2];
  }
}

static void listen(void) {
  for (unsigned r = 0; r < region_count; ++r) {
    take_all(regions[r].aura, r, look_at_aura);
    take_all(regions[r].node_status, r, look_at_status);
    take_all(regions[r].replica, r, look_at_replica);
  }
  dds_sleepfor(DDS_MSECS(5));
}

static int all_heard(void) {
  for (unsigned r = 0; r < region_count; ++r) {
    if (regions[r].auras < kEnough || regions[r].statuses == 0 || regions[r].replicas == 0) return 0;
  }
  return 1;
}

static int is_seen(void) { return body_was_seen; }
static int rises(void) { return body_rises_m_s > 5; }

static void wait_for(int (*condition)(void), const char* what) {
  const dds_time_t deadline = dds_time() + DDS_SECS(15);
  while (!condition()) {
    if (dds_time() > deadline) fail(what);
    listen();
  }
}

static dds_sequence_double numbers(double* values, uint32_t count) {
  return (dds_sequence_double){._maximum = count, ._length = count, ._buffer = values, ._release = false};
}

/// Sends a command and waits until it is answered "accepted" and "done"; the object that it makes, -1 if none.
static int64_t obeyed(dds_entity_t writer, dds_entity_t replies, aurasim_wire_Command* command) {
  command->sender = 1;
  command->version = AURASIM_PROTOCOL_VERSION;
  need(dds_write(writer, command), "write a command");
  const dds_time_t deadline = dds_time() + DDS_SECS(10);
  int64_t object = -1;
  int accepted = 0;
  while (dds_time() < deadline) {
    listen();
    void* sample[1] = {NULL};
    dds_sample_info_t info;
    while (dds_take(replies, sample, &info, 1, 1) > 0) {
      const aurasim_wire_CommandReply* reply = sample[0];
      const int mine = info.valid_data && reply->request == command->request;
      const int outcome = reply->outcome;
      if (mine) {
        printf("request %" PRIu64 ": outcome %d, step %" PRId64 " %s\n", reply->request, outcome, reply->stamp,
               reply->text);
        if (reply->has_object) object = reply->object;
      }
      dds_return_loan(replies, sample, 1);
      sample[0] = NULL;
      accepted |= mine && outcome == kAccepted;
      if (mine && outcome == kDone && accepted) return object;
    }
  }
  fail("a command was not obeyed in 10 s");
  return -1;
}

static void act(dds_entity_t participant) {
  dds_qos_t* world = in_partition("world");
  const dds_entity_t subscriber = need(dds_create_subscriber(participant, world, NULL), "subscriber");
  const dds_entity_t publisher = need(dds_create_publisher(participant, world, NULL), "publisher");
  dds_delete_qos(world);
  const dds_entity_t replies =
      reader(participant, subscriber, &aurasim_wire_CommandReply_desc, "command_reply", DDS_DURABILITY_VOLATILE);
  const dds_entity_t topic =
      need(dds_create_topic(participant, &aurasim_wire_Command_desc, "command", NULL, NULL), "command");
  dds_qos_t* qos = reliable(DDS_DURABILITY_VOLATILE);
  const dds_entity_t writer = need(dds_create_writer(publisher, topic, qos, NULL), "command");
  dds_delete_qos(qos);
  dds_publication_matched_status_t matched = {0};
  for (int i = 0; i < 1000 && matched.current_count < region_count; ++i) {
    listen();
    dds_get_publication_matched_status(writer, &matched);
  }

  double radius[] = {0.5}, place[] = {6, 6, 12}, rotation[] = {1, 0, 0, 0}, velocity[] = {0, 0, 0};
  aurasim_wire_Command spawn = {.request = 7001, .kind = kSpawn, .shape = kSphere, .mass_kg = 2};
  spawn.size = numbers(radius, 1);
  spawn.p = numbers(place, 3);
  spawn.q = numbers(rotation, 4);
  spawn.v = numbers(velocity, 3);
  spawn.w = numbers(velocity, 3);
  const int64_t made = obeyed(writer, replies, &spawn);
  if (made < 0) fail("the answer does not name the body that was asked for");
  body = (uint64_t)made;
  wait_for(is_seen, "the body that was asked for is in no replica");

  double push[] = {0, 0, 60};
  aurasim_wire_Command impulse = {.request = 7002, .kind = kImpulse, .subject = (int64_t)body};
  impulse.v = numbers(push, 3);
  obeyed(writer, replies, &impulse);
  wait_for(rises, "the body that was pushed does not rise");
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) fail("cyclone_peer DOMAIN REGIONS [by_hub]");
  by_hub = argc == 4;
  region_count = (unsigned)atoi(argv[2]);
  if (region_count == 0 || region_count > kMaxRegions) fail("1 to 16 regions");
  body = UINT64_MAX;
  const dds_entity_t participant = need(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "domain");
  for (unsigned r = 0; r < region_count; ++r) listen_to_region(participant, r);
  wait_for(all_heard, "aura, node_status or replica of a region was not heard");
  for (unsigned r = 0; r < region_count; ++r) {
    printf("region %u: %u aura batches without a gap, %u statuses, %u replicas\n", r, regions[r].auras,
           regions[r].statuses, regions[r].replicas);
  }
  act(participant);
  printf("body %" PRIu64 " was made, pushed and seen to rise with %.1f m/s\n", body, (double)body_rises_m_s);
  dds_delete(participant);
  return 0;
}
