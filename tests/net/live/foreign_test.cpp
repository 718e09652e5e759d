// Programs that know the IDL alone: Cyclone's C interface on idlc's types, at the other end.
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <hearsay/idl/live.h>

#include <chrono>
#include <thread>

#include "filters/gaussian/codec.hpp"
#include "net/live/config.hpp"
#include "net/live/messages.hpp"
#include "sim/kernel/random.hpp"
#include "tests/net/live/cyclone.hpp"
#include "tests/net/live/port_bed.hpp"

namespace hearsay::live {
namespace {

/// A participant whose code is none of ours, but for the settings of the network.
class Foreigner {
 public:
  Foreigner() {
    std::string config = cyclone_config(Port::Options{}.domain, "");
    const std::string batch = "<WriteBatch>true</WriteBatch>";  // who has it must flush
    config.erase(config.find(batch), batch.size());
    constexpr dds_domainid_t unused = 200;
    domain_ = dds_create_domain(unused, config.c_str());
    participant_ = dds_create_participant(unused, nullptr, nullptr);
    qos_ = dds_create_qos();
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos_, DDS_HISTORY_KEEP_ALL, 0);
  }
  ~Foreigner() {
    dds_delete_qos(qos_);
    dds_delete(domain_);
  }
  dds_entity_t reader(const dds_topic_descriptor_t& type, const std::string& topic,
                      const std::string& partition) {
    dds_qset_partition1(qos_, partition.c_str());
    const dds_entity_t group = dds_create_subscriber(participant_, qos_, nullptr);
    return dds_create_reader(group, made(type, topic), qos_, nullptr);
  }
  dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& topic,
                      const std::string& partition) {
    dds_qset_partition1(qos_, partition.c_str());
    const dds_entity_t group = dds_create_publisher(participant_, qos_, nullptr);
    return dds_create_writer(group, made(type, topic), qos_, nullptr);
  }

 private:
  dds_entity_t made(const dds_topic_descriptor_t& type, const std::string& topic) {
    return dds_create_topic(participant_, &type, topic.c_str(), nullptr, nullptr);
  }
  dds_entity_t domain_, participant_;
  dds_qos_t* qos_;
};

/// Without a port that wakes.
template <class F>
bool wait_idly(F&& done) {
  for (int waited_ms = 0; waited_ms < wait_max_ms; ++waited_ms) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

bool has_reader(dds_entity_t writer) {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(writer, &status);
  return status.current_count > 0;
}

TEST(Foreigner, HearsWhatWeSay) {
  Foreigner foreigner;
  Port world({.fleet = own_fleet("hears")});
  const std::string partition = agent_partition(world.fleet(), 2);
  const dds_entity_t reader =
      foreigner.reader(hearsay_Measurement_desc, "hearsay_measurement", partition);
  Writer writer = world.writer(measurement_topic(), partition);
  ASSERT_TRUE(wait(world, [&] { return writer.matched(); }));
  Stream random(3, Purpose("foreigner"), {1});
  Bytes bytes;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const int n = 1 + static_cast<int>(i % 6);
    const Measurement sent{.agent = 2,
                           .subject = i,
                           .number = 7 * i,
                           .now_ns = -5,
                           .information = some_belief(random, n)};
    encode(sent, bytes);
    ASSERT_TRUE(writer.write(bytes));
    void* samples[1] = {nullptr};
    dds_sample_info_t info;
    ASSERT_TRUE(wait_idly([&] { return dds_take(reader, samples, &info, 1, 1) == 1; }));
    ASSERT_TRUE(info.valid_data);
    const auto& got = *static_cast<const hearsay_Measurement*>(samples[0]);
    EXPECT_EQ(got.subject, i);
    EXPECT_EQ(got.number, 7 * i);
    EXPECT_EQ(got.now_ns, -5);
    ASSERT_EQ(got.information_vector._length, static_cast<std::uint32_t>(n));
    ASSERT_EQ(got.information_matrix._length, static_cast<std::uint32_t>(n * (n + 1) / 2));
    for (int k = 0; k < n; ++k) {
      EXPECT_EQ(got.information_vector._buffer[k], sent.information.xi(k));
      EXPECT_EQ(got.information_matrix._buffer[k], sent.information.omega(0, k));
    }
    dds_return_loan(reader, samples, 1);
  }
}

TEST(Foreigner, IsHeardByUs) {
  Foreigner foreigner;
  Port agent({.fleet = own_fleet("heard")});
  const std::string partition = air_partition(agent.fleet());
  const dds_entity_t writer =
      foreigner.writer(hearsay_GaussianPacket_desc, "hearsay_air_gaussian", partition);
  Reader reader = agent.reader(air_topics("gaussian", States::still).front(), partition);
  ASSERT_TRUE(wait_idly([&] { return has_reader(writer); }));
  Stream random(3, Purpose("foreigner"), {2});
  for (std::uint32_t i = 0; i < 20; ++i) {
    const int n = 1 + static_cast<int>(i % 6);
    const gaussian::Belief belief = some_belief(random, n);
    Pool pool;
    hearsay_GaussianPacket packet{};
    packet.envelope = {4, everybody, i, 5, -1, 9};
    packet.message.count = i;
    const auto beliefs = pool.resize(packet.message.beliefs, 1);
    beliefs[0].subject = 9;
    pool.copy(beliefs[0].information_vector, belief.xi);
    pool.triangle(beliefs[0].information_matrix, belief.omega);
    ASSERT_EQ(dds_write(writer, &packet), DDS_RETCODE_OK);
    Bytes bytes;
    ASSERT_TRUE(wait(agent, [&] { return reader.take(bytes); }));
    Envelope envelope;
    std::span<std::byte> inside;
    gaussian::Message message;
    ASSERT_TRUE(unpack(bytes, envelope, inside));
    EXPECT_EQ(envelope, (Envelope{4, everybody, i, 5, -1, 9}));
    ASSERT_TRUE(decode(inside, message));
    ASSERT_EQ(message.beliefs.size(), 1u);
    EXPECT_EQ(message.beliefs[0].belief.xi, belief.xi);
    EXPECT_EQ(message.beliefs[0].belief.omega, belief.omega);
  }
  EXPECT_EQ(reader.malformed(), 0u);
}

// What has the topic's name but is of another type does not even come near.
TEST(Foreigner, OfAnotherTypeIsNotHeard) {
  Foreigner foreigner;
  Port agent({.fleet = own_fleet("type")});
  const dds_entity_t wrong = foreigner.writer(hearsay_Clock_desc, "hearsay_truth", agent.fleet());
  const dds_entity_t right = foreigner.writer(hearsay_Hello_desc, "hearsay_hello", agent.fleet());
  Reader truths = agent.reader(truth_topic(), agent.fleet());
  Reader hellos = agent.reader(hello_topic(), agent.fleet());
  ASSERT_TRUE(wait_idly([&] { return has_reader(right); }));
  EXPECT_FALSE(has_reader(wrong));
  EXPECT_EQ(truths.writers_alive(), 0);
}

}  // namespace
}  // namespace hearsay::live
