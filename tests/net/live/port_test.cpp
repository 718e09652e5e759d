#include "net/live/port.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "net/live/messages.hpp"
#include "sim/kernel/error.hpp"
#include "tests/net/live/port_bed.hpp"

namespace hearsay::live {
namespace {

std::vector<std::byte> frame_of(std::uint64_t number, std::size_t size) {
  Frame frame{.agent = 3, .number = number, .content = std::vector<std::byte>(size)};
  for (std::size_t i = 0; i < size; ++i) frame.content[i] = static_cast<std::byte>(number + i);
  std::vector<std::byte> bytes;
  encode(frame, bytes);
  return bytes;
}

TEST(Port, WhatOneWritesTheOtherTakes) {
  Port world({.fleet = own_fleet("one")}), agent({.fleet = own_fleet("one")});
  const std::string partition = agent_partition(world.fleet(), 3);
  Writer writer = world.writer(order_topic(), partition);
  Reader reader = agent.reader(order_topic(), partition);
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  ASSERT_TRUE(wait(world, [&] { return writer.matched(); }));

  const std::vector<std::byte> sent = frame_of(7, 1001);
  ASSERT_TRUE(writer.write(sent));
  std::vector<std::byte> got;
  SampleInfo info;
  ASSERT_TRUE(wait(agent, [&] { return reader.take(got, &info); }));
  EXPECT_EQ(got, sent);
  EXPECT_NE(info.writer, 0u);
  EXPECT_GT(info.written_ns, 0);
  EXPECT_FALSE(reader.take(got));
  EXPECT_EQ(reader.malformed(), 0u);
}

TEST(Port, OrderIsKeptWhateverTheSizes) {
  Port world({.fleet = own_fleet("order")}), agent({.fleet = own_fleet("order")});
  Writer writer = world.writer(order_topic(), world.fleet());
  Reader reader = agent.reader(order_topic(), agent.fleet());
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  ASSERT_TRUE(wait(world, [&] { return writer.matched(); }));

  constexpr std::uint64_t samples = 10000;
  const auto size_of = [](std::uint64_t number) -> std::size_t {
    return number % 500 == 499 ? std::size_t{1} << 20 : (number * 7919) % 3000;
  };
  std::uint64_t sent = 0, taken = 0;
  std::vector<std::byte> got;
  Frame frame;
  while (taken < samples) {
    if (sent < samples && sent < taken + 200) {
      ASSERT_TRUE(writer.write(frame_of(sent, size_of(sent)))) << sent;
      ++sent;
      if (!reader.take(got)) continue;
    } else {
      ASSERT_TRUE(wait(agent, [&] { return reader.take(got); })) << taken << " of " << sent;
    }
    ASSERT_TRUE(decode(got, frame));
    ASSERT_EQ(frame.number, taken);
    ASSERT_EQ(got, frame_of(taken, size_of(taken)));
    ++taken;
  }
}

TEST(Port, TwoFleetsInADomainDoNotMix) {
  Port red({.fleet = own_fleet("red")}), blue({.fleet = own_fleet("blue")});
  Writer reds = red.writer(truth_topic(), fleet_partition(red.fleet()));
  Writer blues = blue.writer(truth_topic(), fleet_partition(blue.fleet()));
  Port red_ear({.fleet = red.fleet()}), blue_ear({.fleet = blue.fleet()});
  Reader of_red = red_ear.reader(truth_topic(), fleet_partition(red.fleet()));
  Reader of_blue = blue_ear.reader(truth_topic(), fleet_partition(blue.fleet()));
  ASSERT_TRUE(wait(red_ear, [&] { return of_red.writers_alive() == 1; }));
  ASSERT_TRUE(wait(blue_ear, [&] { return of_blue.writers_alive() == 1; }));
  ASSERT_TRUE(wait(red, [&] { return reds.matched(); }));
  ASSERT_TRUE(wait(blue, [&] { return blues.matched(); }));

  std::vector<std::byte> bytes;
  for (std::uint32_t i = 0; i < 20; ++i) {
    encode(Truth{.subject = 1000 + i}, bytes);
    ASSERT_TRUE(reds.write(bytes));
    encode(Truth{.subject = 2000 + i}, bytes);
    ASSERT_TRUE(blues.write(bytes));
  }
  Truth truth;
  for (std::uint32_t i = 0; i < 20; ++i) {
    ASSERT_TRUE(wait(red_ear, [&] { return of_red.take(bytes); }));
    ASSERT_TRUE(decode(bytes, truth));
    EXPECT_EQ(truth.subject, 1000 + i);
    ASSERT_TRUE(wait(blue_ear, [&] { return of_blue.take(bytes); }));
    ASSERT_TRUE(decode(bytes, truth));
    EXPECT_EQ(truth.subject, 2000 + i);
  }
  EXPECT_EQ(of_red.writers_alive(), 1);
  EXPECT_EQ(of_blue.writers_alive(), 1);
}

// Beside a network, samples of one port stay in the process, by another way through Cyclone.
TEST(Port, WhatIsMalformedIsCountedAndNeverTaken) {
  Port world({.fleet = own_fleet("bad")}), agent({.fleet = own_fleet("bad")});
  Writer writer = world.writer(order_topic(), world.fleet());
  Reader far = agent.reader(order_topic(), agent.fleet());
  Reader near = world.reader(order_topic(), world.fleet());
  ASSERT_TRUE(wait(agent, [&] { return far.writers_alive() == 1; }));
  ASSERT_TRUE(wait(world, [&] { return writer.readers() == 2; }));

  std::vector<std::byte> bytes = frame_of(1, 100);
  std::uint64_t bad = 0;
  const auto spoil = [&](std::vector<std::byte> other) {
    ASSERT_TRUE(writer.write(other));
    ++bad;
  };
  for (const std::size_t length : {4u, 8u, 20u, 23u, 100u, 119u}) {
    spoil({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)});  // truncated
  }
  std::vector<std::byte> other = bytes;
  other.resize(bytes.size() + 4);  // more than padding
  spoil(other);
  other = bytes;
  other[1] = std::byte{7};  // another encoding
  spoil(other);
  other = bytes;
  other[23] = std::byte{0x7f};  // a length of two thousand million
  spoil(other);
  std::vector<std::byte> hello;
  encode(Hello{.scenario = "abc", .version = "1"}, hello);
  spoil(hello);  // another type
  ASSERT_TRUE(writer.write(bytes));

  std::vector<std::byte> got;
  for (Reader* reader : {&far, &near}) {
    ASSERT_TRUE(wait(reader == &far ? agent : world, [&] { return reader->take(got); }));
    EXPECT_EQ(got, bytes);
    EXPECT_EQ(reader->malformed(), bad);
    EXPECT_FALSE(reader->take(got));
  }
}

TEST(Port, BytesOfTheOtherOrderAreTurned) {
  Port world({.fleet = own_fleet("turned")}), agent({.fleet = own_fleet("turned")});
  Writer writer = world.writer(truth_topic(), world.fleet());
  Reader reader = agent.reader(truth_topic(), agent.fleet());
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  ASSERT_TRUE(wait(world, [&] { return writer.matched(); }));
  std::vector<std::byte> big;
  const auto put = [&](std::uint64_t value, int bytes) {
    for (int i = bytes; i-- > 0;) big.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  put(0, 4);                        // big-endian
  put(5, 8), put(9, 4), put(1, 4);  // now_ns, subject, length
  put(std::bit_cast<std::uint64_t>(-2.5), 8);
  ASSERT_TRUE(writer.write(big));
  std::vector<std::byte> got;
  Truth truth;
  ASSERT_TRUE(wait(agent, [&] { return reader.take(got); }));
  ASSERT_TRUE(decode(got, truth));
  EXPECT_EQ(truth, (Truth{.now_ns = 5, .subject = 9, .state = {-2.5}}));
}

TEST(Port, AWriterThatGoesIsNoLongerAlive) {
  Port agent({.fleet = own_fleet("death")});
  Reader reader = agent.reader(clock_topic(), agent.fleet());
  EXPECT_EQ(reader.writers_alive(), 0);
  std::optional<Port> world(std::in_place, Port::Options{.fleet = agent.fleet()});
  std::optional<Writer> writer(world->writer(clock_topic(), agent.fleet()));
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  writer.reset();
  world.reset();
  EXPECT_TRUE(wait(agent, [&] { return reader.writers_alive() == 0; }));
}

// One that could not say goodbye. The process is forked before there are threads.
TEST(Port, AWriterThatIsKilledIsNoLongerAlive) {
  const std::string fleet = own_fleet("killed");
  const pid_t child = fork();
  if (child == 0) {
    Port world({.fleet = fleet});
    const Writer writer = world.writer(truth_topic(), fleet);
    while (getppid() != 1) sleep(1);
    _exit(0);
  }
  Port agent({.fleet = fleet});
  Reader reader = agent.reader(truth_topic(), fleet);
  const bool was_alive = wait(agent, [&] { return reader.writers_alive() == 1; });
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(was_alive);
  EXPECT_TRUE(wait(agent, [&] { return reader.writers_alive() == 0; }));
}

TEST(Port, WhoComesLateStillHearsTheLastOfTheClock) {
  Port world({.fleet = own_fleet("late")});
  Writer writer = world.writer(clock_topic(), world.fleet());
  std::vector<std::byte> bytes;
  for (std::int64_t now = 1; now <= 3; ++now) {
    encode(Clock{.now_ns = now, .state = Clock::State::running}, bytes);
    ASSERT_TRUE(writer.write(bytes));
  }
  Port agent({.fleet = world.fleet()});
  Reader reader = agent.reader(clock_topic(), agent.fleet());
  ASSERT_TRUE(wait(agent, [&] { return reader.take(bytes); }));
  Clock clock;
  ASSERT_TRUE(decode(bytes, clock));
  EXPECT_EQ(clock.now_ns, 3);
  EXPECT_FALSE(reader.take(bytes));
}

TEST(Port, WritersAndReadersOutliveIt) {
  Port agent({.fleet = own_fleet("outlive")});
  std::optional<Port> world(std::in_place, Port::Options{.fleet = agent.fleet()});
  Reader reader = agent.reader(truth_topic(), agent.fleet());
  Writer writer = world->writer(truth_topic(), agent.fleet());
  Reader own = world->reader(truth_topic(), agent.fleet());
  world.reset();
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  std::vector<std::byte> bytes;
  encode(Truth{.subject = 5}, bytes);
  ASSERT_TRUE(wait(agent, [&] { return writer.matched(); }));
  ASSERT_TRUE(writer.write(bytes));
  EXPECT_TRUE(own.take(bytes));
}

TEST(Port, WakesUntilDrained) {
  Port world({.fleet = own_fleet("wake")}), agent({.fleet = world.fleet()});
  Reader reader = agent.reader(truth_topic(), agent.fleet());
  const auto readable = [&](int timeout_ms) {
    pollfd ear{.fd = agent.wake_fd(), .events = POLLIN, .revents = 0};
    return poll(&ear, 1, timeout_ms) == 1;
  };
  agent.drain();
  EXPECT_FALSE(readable(0));
  Writer writer = world.writer(truth_topic(), world.fleet());
  ASSERT_TRUE(readable(wait_max_ms));
  ASSERT_TRUE(wait(agent, [&] { return reader.writers_alive() == 1; }));
  ASSERT_TRUE(wait(world, [&] { return writer.matched(); }));
  agent.drain();
  std::vector<std::byte> bytes;
  encode(Truth{.subject = 5}, bytes);
  ASSERT_TRUE(writer.write(bytes));
  EXPECT_TRUE(readable(wait_max_ms));
  EXPECT_TRUE(readable(0));
  agent.drain();
  EXPECT_TRUE(reader.take(bytes));
  agent.drain();
  EXPECT_FALSE(readable(0));
}

TEST(Port, OptionsOutOfRangeAreInputErrors) {
  EXPECT_THROW(Port({.fleet = ""}), InputError);
  EXPECT_THROW(Port({.fleet = "a.b"}), InputError);
  EXPECT_THROW(Port({.fleet = std::string(65, 'a')}), InputError);
  EXPECT_THROW(Port({.fleet = "a", .interface = "<lo>"}), InputError);
  EXPECT_THROW(Port({.fleet = "a", .interface = "no_such_0"}), InputError);
  EXPECT_THROW(Port({.fleet = "a", .domain = 231}), InputError);
}

}  // namespace
}  // namespace hearsay::live
