// An agent that is no part of hearsay: it takes the place of one agent of a fleet in real time, and
// of hearsay it knows the IDL alone. It believes in one subject, as an information vector and an
// information matrix, to which it adds what its sensor says and what it hears from others: naive
// fusion, which counts twice whatever two agents both know. README.md says how to run it.
#define _POSIX_C_SOURCE 200809L
#include <dds/dds.h>
#include <hearsay/idl/live.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: foreign_agent [-d DOMAIN] [-s SUBJECT] [-t SECONDS] FLEET AGENT\n"
    "Takes the place of an agent (its number, from 0) of a fleet whose world runs in real time.\n"
    "  -d DOMAIN   of DDS (77)\n"
    "  -s SUBJECT  what it believes in, from 0 (0)\n"
    "  -t SECONDS  of the fleet's time, from one message of it to the next (5)\n"
    "It stays on this machine, unless CYCLONEDDS_URI says how Cyclone DDS is set up.\n";

// As hearsay sets up Cyclone by default: the loopback interface and nothing else.
static const char loopback[] =
    "<CycloneDDS><Domain Id=\"any\"><General>"
    "<Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

enum { patience_s = 30 };                          // with a world that does not answer
enum { waiting, running, ended };                  // of a Clock
enum { dim_max = 64, entries_max = 64 * 65 / 2 };  // of a belief

static struct {
  const char* fleet;
  uint32_t id, subject;
  double talk_s;
  uint32_t dim;                // of what it believes; 0: nothing yet
  double vector[dim_max];      // information vector
  double matrix[entries_max];  // information matrix, upper triangle by rows
  hearsay_Counts counts;
  uint32_t said;            // messages
  int64_t told_ns, end_ns;  // the fleet's time as it was last told, and when it ends
  double speed;             // seconds of it in a second
  dds_time_t heard;         // when it was told, by the clock on the wall
} me = {.talk_s = 5};

#define fail(...) \
  (fprintf(stderr, "foreign_agent: " __VA_ARGS__), fputc('\n', stderr), exit(EXIT_FAILURE))

// Cyclone answers with a number below 0 where something went wrong.
static dds_return_t ok(dds_return_t result, const char* what) {
  if (result < 0) fail("DDS: %s: %s", what, dds_strretcode(-result));
  return result;
}

// A reader or writer as all topics want it: reliable, all samples kept; of the clock the last one,
// also for who comes later. A fleet is a partition of the topics, and so is each agent's share.
static dds_entity_t open_end(bool writes, dds_entity_t participant, const char* name,
                             const dds_topic_descriptor_t* type, const char* suffix) {
  char partition[128];
  snprintf(partition, sizeof partition, suffix ? "%s.%u%s" : "%s", me.fleet, me.id, suffix);
  const bool is_clock = type == &hearsay_Clock_desc;
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, partition);
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, is_clock ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, is_clock);
  dds_qset_durability(qos, is_clock ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  // After a second without a sign of life a writer is gone, and its agent with it.
  if (writes) dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(1));
  const dds_entity_t topic = ok(dds_create_topic(participant, type, name, NULL, NULL), name);
  dds_entity_t end;  // under a publisher or subscriber of its own, which is in the partition
  if (writes) {
    end = dds_create_writer(ok(dds_create_publisher(participant, qos, NULL), name), topic, qos, 0);
  } else {
    end = dds_create_reader(ok(dds_create_subscriber(participant, qos, NULL), name), topic, qos, 0);
  }
  dds_delete_qos(qos);
  return ok(end, name);
}

// The next sample, in place of `last`, which is given back; NULL if there is none.
static void* take(dds_entity_t reader, void* last) {
  dds_sample_info_t info = {.valid_data = false};
  for (;;) {
    if (last) ok(dds_return_loan(reader, &last, 1), "return of a sample");
    last = NULL;
    if (ok(dds_take(reader, &last, &info, 1, 1), "take") == 0) return NULL;
    if (info.valid_data) return last;
  }
}

// Adds what a sensor or another agent says, or refuses it: if it is of another dimension, or no
// number comes of it. (That a matrix is not indefinite the world has seen to.)
static bool add(const dds_sequence_double* vector, const dds_sequence_double* matrix) {
  const uint32_t n = vector->_length, entries = matrix->_length;
  if (n == 0 || n > dim_max || entries != n * (n + 1) / 2) return false;
  bool sound = me.dim == 0 || me.dim == n;
  for (uint32_t i = 0; i < n; ++i) sound &= isfinite(me.vector[i] + vector->_buffer[i]) != 0;
  for (uint32_t i = 0; i < entries; ++i) sound &= isfinite(me.matrix[i] + matrix->_buffer[i]) != 0;
  if (!sound) return false;
  me.dim = n;
  for (uint32_t i = 0; i < n; ++i) me.vector[i] += vector->_buffer[i];
  for (uint32_t i = 0; i < entries; ++i) me.matrix[i] += matrix->_buffer[i];
  return true;
}

// What it believes, as messages have it: their sequences refer to ours.
static hearsay_GaussianBelief belief(void) {
  const uint32_t entries = me.dim * (me.dim + 1) / 2;
  return (hearsay_GaussianBelief){.subject = me.subject,
                                  .information_vector = {me.dim, me.dim, me.vector, false},
                                  .information_matrix = {entries, entries, me.matrix, false}};
}

static void hear(dds_entity_t measurements, dds_entity_t packets) {
  for (hearsay_Measurement* m = NULL; (m = take(measurements, m));) {
    if (m->subject != me.subject) continue;
    const bool fits = add(&m->information_vector, &m->information_matrix);
    ++*(fits ? &me.counts.measurements : &me.counts.refused);
  }
  for (hearsay_GaussianPacket* p = NULL; (p = take(packets, p));) {
    for (uint32_t i = 0; i < p->message.beliefs._length; ++i) {
      const hearsay_GaussianBelief* b = &p->message.beliefs._buffer[i];
      if (b->subject != me.subject) continue;
      const bool fits = add(&b->information_vector, &b->information_matrix);
      ++*(fits ? &me.counts.fusions : &me.counts.refused);
    }
  }
}

// To all that the world's radio reaches. Others take no message that is older than one that they
// have heard, by (incarnation, count): the former rises from process to process.
static void talk(dds_entity_t said, int64_t now_ns, uint32_t incarnation) {
  hearsay_GaussianBelief one = belief();
  hearsay_GaussianPacket packet = {.message = {incarnation, ++me.said, {1, 1, &one, false}}};
  packet.envelope = (hearsay_Envelope){.sender = me.id, .receiver = UINT32_MAX, .tick = -1};
  packet.envelope.number = me.said;
  packet.envelope.sent_ns = now_ns;
  packet.envelope.subject = me.subject;
  ok(dds_write(said, &packet), "packet");
}

// For the world's record: belief, counts, and a series of its own.
static void report(dds_entity_t reports, int64_t now_ns) {
  hearsay_GaussianBelief one = belief();
  hearsay_Row row = {.now_ns = now_ns, .name = "information_xx", .text = "", .value = me.matrix[0]};
  const uint32_t n = me.dim > 0;
  const hearsay_Report all = {.agent = me.id,
                              .now_ns = now_ns,
                              .counts = me.counts,
                              .beliefs = {n, n, &one, false},
                              .rows = {n, n, &row, false}};
  ok(dds_write(reports, &all), "report");
}

// Says hello until the world answers. It need not know the scenario; its version is its own.
static void join(dds_entity_t hellos, dds_entity_t welcomes) {
  const hearsay_Hello hello = {.protocol = hearsay_PROTOCOL,
                               .agent = me.id,
                               .scenario = "",
                               .process = (uint64_t)dds_time() ^ (uint64_t)getpid() << 40,
                               .version = "foreign_agent 1"};
  for (int tries = 0; tries < 5 * patience_s; ++tries) {
    ok(dds_write(hellos, &hello), "hello");
    dds_sleepfor(DDS_MSECS(200));
    for (hearsay_Welcome* w = NULL; (w = take(welcomes, w));) {
      if (w->process != hello.process) continue;
      if (!w->accepted) fail("the world refused it: %s", w->reason);
      me.heard = dds_time();
      return;  // with the sample: nothing is read here any more
    }
  }
  fail("no world of fleet '%s' answered within %d s", me.fleet, patience_s);
}

// What the clock says now. @return its state.
static int look_at_clock(dds_entity_t clock, int state) {
  dds_liveliness_changed_status_t alive;
  ok(dds_get_liveliness_changed_status(clock, &alive), "clock");  // before its last words are read
  for (hearsay_Clock* c = NULL; (c = take(clock, c));) {
    state = c->state;
    me.told_ns = c->now_ns, me.end_ns = c->end_ns, me.speed = c->speed, me.heard = dds_time();
    if (state == ended && c->reason[0]) fail("the world ended: %s", c->reason);
  }
  const bool silent = alive.alive_count == 0 && dds_time() > me.heard + DDS_SECS(2);
  if (state != ended && silent) fail("the world of fleet '%s' is gone", me.fleet);
  return state;
}

// From the first hello to the end of the fleet's time. `p`: a participant of the domain.
static void live(dds_entity_t p) {
  const char *air = "hearsay_air_gaussian", *measured = "hearsay_measurement";
  const dds_entity_t clock = open_end(false, p, "hearsay_clock", &hearsay_Clock_desc, NULL);
  const dds_entity_t measurements = open_end(false, p, measured, &hearsay_Measurement_desc, "");
  const dds_entity_t packets = open_end(false, p, air, &hearsay_GaussianPacket_desc, "");
  const dds_entity_t said = open_end(true, p, air, &hearsay_GaussianPacket_desc, ".said");
  const dds_entity_t reports = open_end(true, p, "hearsay_report", &hearsay_Report_desc, "");
  join(open_end(true, p, "hearsay_hello", &hearsay_Hello_desc, NULL),
       open_end(false, p, "hearsay_welcome", &hearsay_Welcome_desc, NULL));
  printf("foreign_agent: welcome as agent %u of fleet '%s'\n", me.id, me.fleet);
  fflush(stdout);
  const uint32_t incarnation = (uint32_t)(dds_time() / DDS_SECS(1));
  double next_report_s = 0, next_talk_s = me.talk_s;
  for (int state = waiting; (state = look_at_clock(clock, state)) != ended;) {
    hear(measurements, packets);
    // Between two ticks of the clock the fleet's time goes on.
    double now_s = 1e-9 * ((double)me.told_ns + (double)(dds_time() - me.heard) * me.speed);
    if (now_s > 1e-9 * (double)me.end_ns) now_s = 1e-9 * (double)me.end_ns;
    if (state == running && now_s >= next_report_s) {
      report(reports, (int64_t)(1e9 * now_s));
      next_report_s = floor(now_s) + 1;
    }
    if (state == running && now_s >= next_talk_s && me.dim > 0) {
      talk(said, (int64_t)(1e9 * now_s), incarnation);
      next_talk_s = now_s + me.talk_s;
    }
    dds_sleepfor(DDS_MSECS(5));
  }
  printf("foreign_agent: %llu measurements, %llu fusions, %u messages\n",
         (unsigned long long)me.counts.measurements, (unsigned long long)me.counts.fusions,
         me.said);
}

// A whole number from 0 to `max`.
static uint32_t number(const char* text, uint32_t max) {
  char* end;
  const unsigned long long value = strtoull(text, &end, 10);
  if (*text < '0' || *text > '9' || *end || value > max) fail("'%s' is no number in range", text);
  return (uint32_t)value;
}

int main(int argc, char** argv) {
  uint32_t domain = 77;
  for (int option; (option = getopt(argc, argv, "d:s:t:")) != -1;) {
    if (option == 'd') domain = number(optarg, 230);
    if (option == 's') me.subject = number(optarg, UINT32_MAX);
    if (option == 't') me.talk_s = number(optarg, 1000000);
    if (option == '?') return fputs(usage, stderr), 2;
  }
  if (argc != optind + 2 || strlen(argv[optind]) > 64) return fputs(usage, stderr), 2;
  me.fleet = argv[optind];
  me.id = number(argv[optind + 1], UINT32_MAX - 1);
  if (!getenv("CYCLONEDDS_URI")) ok(dds_create_domain(domain, loopback), "domain");
  live(ok(dds_create_participant(domain, NULL, NULL), "participant"));
  return dds_delete(DDS_CYCLONEDDS_HANDLE) < 0;  // when what is on its way has arrived
}
