// Beliefs between two processes through a port of live mode: how many a second, and how long there
// and back. Usage: live_bench gaussian|trajectory|grid throughput|roundtrip [SECONDS]
// Prints the bytes of a packet (as ddsperf counts them: header left out) and the result: packets a
// second, or the median of microseconds there and back. tools/bench/live.py sets it beside ddsperf,
// to which `live_bench config` gives the same settings.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "filters/gaussian/codec.hpp"
#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/grid/codec.hpp"
#include "net/live/config.hpp"
#include "net/live/envelope.hpp"
#include "net/live/port.hpp"

namespace {

using namespace hearsay;
using Bytes = std::vector<std::byte>;
using Clock = std::chrono::steady_clock;

struct Load {
  live::TopicId topic;
  Bytes message;  ///< as the codec makes it
};

Load load_of(const std::string& name) {
  Bytes bytes;
  if (name == "gaussian") {
    gaussian::encode(gaussian::Message{1, 2, {{3, gaussian::Belief::unknown(4)}}}, bytes);
    return {live::air_topics(name, live::States::still).front(), bytes};
  }
  if (name == "trajectory") {
    gaussian::TrajectoryMessage message{1, 2, {{3, 0, {}}}};
    for (int step = 0; step < 20; ++step) {
      const gaussian::Matrix next = gaussian::Matrix::Zero(6, step < 19 ? 6 : 0);
      message.trajectories[0].steps.push_back(
          {step, gaussian::Belief::unknown(6), step < 19 ? next : gaussian::Matrix()});
    }
    gaussian::encode(message, bytes);
    return {live::air_topics("gaussian", live::States::trajectory).front(), bytes};
  }
  if (name == "grid") {
    const std::vector<float> evidence(100 * 100, 0.5F);
    grid::Encoder encoder;
    bytes = encoder.encode({1, 2, grid::Form::whole, evidence}, {100 * 100, 1}, 1 << 20)[0];
    return {live::air_topic("grid", live::States::still, bytes), bytes};
  }
  std::fprintf(stderr, "live_bench: no load '%s'\n", name.c_str());
  std::exit(2);
}

/// Waits for the port to wake; ends the process if nothing comes.
void wait(live::Port& port) {
  pollfd ear{.fd = port.wake_fd(), .events = POLLIN, .revents = 0};
  if (poll(&ear, 1, 20000) == 1) return port.drain();
  std::fprintf(stderr, "live_bench: nothing comes\n");
  std::exit(1);
}

struct Ends {
  live::Port port;
  live::Writer writer;
  live::Reader reader;

  Ends(const std::string& fleet, const live::TopicId& topic, const char* to, const char* from)
      : port({.fleet = fleet}),
        writer(port.writer(topic, fleet + to)),
        reader(port.reader(topic, fleet + from)) {
    while (!writer.matched() || reader.writers_alive() == 0) wait(port);
  }
};

/// The other process: sends back what is asked for (tick 0), counts the rest; ends at tick 1, and
/// answers that by what it counted and how long the first and the last were apart.
int echo(const std::string& fleet, const Load& load) {
  Ends ends(fleet, load.topic, ".back", ".there");
  live::Envelope envelope;
  std::uint64_t count = 0;
  Clock::time_point first;
  Bytes message;
  while (true) {
    if (!ends.reader.take_packet(envelope, message)) {
      wait(ends.port);
    } else if (envelope.tick == 1) {
      break;
    } else if (envelope.tick == 0) {
      if (!ends.writer.write_packet(envelope, message)) return 1;
    } else if (count++ == 0) {
      first = Clock::now();
    }
  }
  envelope.number = count;
  envelope.sent_ns = std::chrono::nanoseconds(Clock::now() - first).count();
  if (!ends.writer.write_packet(envelope, load.message)) return 1;
  while (ends.writer.matched()) wait(ends.port);
  return 0;
}

/// The answer to what was just written.
live::Envelope answer(Ends& ends) {
  live::Envelope envelope;
  Bytes message;
  while (!ends.reader.take_packet(envelope, message)) wait(ends.port);
  return envelope;
}

double throughput(Ends& ends, const Load& load, double seconds) {
  live::Envelope envelope;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    for (int i = 0; i < 16; ++i) {
      ++envelope.number;
      while (!ends.writer.write_packet_later(envelope, load.message)) {
      }
    }
  }
  envelope.tick = 1;
  while (!ends.writer.write_packet(envelope, load.message)) {
  }
  const live::Envelope counted = answer(ends);
  if (counted.number != envelope.number) {
    std::fprintf(stderr, "live_bench: packets were lost\n");
    std::exit(1);
  }
  return static_cast<double>(counted.number) / (1e-9 * static_cast<double>(counted.sent_ns));
}

double round_trip_us(Ends& ends, const Load& load, double seconds) {
  live::Envelope envelope{.tick = 0};
  std::vector<double> us;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    const auto begin = Clock::now();
    ++envelope.number;
    if (!ends.writer.write_packet(envelope, load.message)) std::exit(1);
    if (answer(ends).number != envelope.number) std::exit(1);
    us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
  }
  envelope.tick = 1;
  if (!ends.writer.write_packet(envelope, load.message)) std::exit(1);
  answer(ends);
  const auto middle = us.begin() + static_cast<std::ptrdiff_t>(us.size() / 2);
  std::nth_element(us.begin(), middle, us.end());
  return *middle;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "config") == 0) {
    std::puts(live::cyclone_config(live::Port::Options{}.domain, "").c_str());
    return 0;
  }
  if (argc < 3) {
    std::fprintf(stderr, "live_bench gaussian|trajectory|grid throughput|roundtrip [SECONDS]\n");
    return 2;
  }
  const Load load = load_of(argv[1]);
  if (std::strcmp(argv[2], "echo") == 0) return echo(argv[3], load);

  const double seconds = argc > 3 ? std::atof(argv[3]) : 3.0;
  const std::string fleet = "bench-" + std::to_string(getpid());
  const pid_t child = fork();
  if (child == 0) {
    execl("/proc/self/exe", "live_bench", argv[1], "echo", fleet.c_str(), nullptr);
    _exit(127);
  }
  {
    Ends ends(fleet, load.topic, ".there", ".back");
    const bool there = std::strcmp(argv[2], "throughput") == 0;
    const double result =
        there ? throughput(ends, load, seconds) : round_trip_us(ends, load, seconds);
    std::printf("%zu %.3f\n", load.message.size() - 4 + live::envelope_bytes, result);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
