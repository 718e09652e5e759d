// A simulation with a radio on which everybody listens and writes down what they hear.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "net/radio.hpp"

namespace hearsay {

// FNV-1a: enough to see whether two runs recorded the same.
class FnvDigest final : public DigestSink {
 public:
  void update(std::span<const std::byte> bytes) override {
    for (const std::byte b : bytes) {
      hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3ULL;
    }
  }
  std::uint64_t hash = 0xcbf29ce484222325ULL;
};

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}
inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct Heard {
  std::int64_t at_ns;
  AgentId sender;
  AgentId receiver;
  std::string text;
  bool operator==(const Heard&) const = default;
};
inline void PrintTo(const Heard& h, std::ostream* out) {
  *out << h.at_ns << " ns: " << h.sender << "→" << h.receiver << " '" << h.text << "'";
}

// What a sender was told of a packet that was to be acknowledged.
struct Outcome {
  std::int64_t at_ns;
  AgentId sender;
  AgentId receiver;
  std::string text;
  bool acknowledged;
  bool operator==(const Outcome&) const = default;
};
inline void PrintTo(const Outcome& o, std::ostream* out) {
  *out << o.at_ns << " ns: " << o.sender << "→" << o.receiver << " '" << o.text << "' "
       << (o.acknowledged ? "acknowledged" : "given up");
}

class Bed {
 public:
  struct Options {
    RadioOptions radio;
    std::uint64_t seed = 1;
    Time end = Time::at(Duration::nanoseconds(1'000'000'000'000));
    bool keep_messages = true;
  };

  Bed(Topology topology, const Options& options)
      : simulation({.seed = options.seed,
                    .end = options.end,
                    .record = {.keep_messages = options.keep_messages, .digest = &digest}}),
        radio(std::make_unique<Radio>(simulation, std::move(topology), options.radio)),
        kind(simulation.record().name("note")) {
    for (AgentId a = 0; a < radio->topology().agents(); ++a) {
      ears_.push_back(std::make_unique<Ear>(*this));
      radio->attach(a, *ears_.back());
    }
  }

  // Sends now; true if the packet found room.
  bool send(AgentId from, std::string_view text, AgentId to = no_agent,
            std::optional<std::uint64_t> tick = {}, RiderPtr rider = {}) {
    return radio->send(from, {.kind = kind,
                              .bytes = bytes_of(text),
                              .receiver = to,
                              .tick = tick,
                              .rider = std::move(rider)});
  }

  // To be acknowledged.
  bool send_safely(AgentId from, std::string_view text, AgentId to,
                   std::optional<std::uint64_t> tick = {}) {
    return radio->send(from, {.kind = kind,
                              .bytes = bytes_of(text),
                              .receiver = to,
                              .tick = tick,
                              .acknowledged = true});
  }

  // Does `what` at an instant, in the phase in which agents talk.
  template <typename What>
  void at(Duration since_start, What what) {
    todo_.push_back(std::move(what));
    simulation.schedule(Time::at(since_start), Phase::act,
                        [this, n = todo_.size() - 1] { todo_[n](); });
  }

  RunEnd run() {
    const RunEnd end = simulation.run();
    radio->finish();
    simulation.record().finish();
    return end;
  }

  // How many rows of a fate the record holds.
  std::size_t rows(Fate fate) const {
    std::size_t count = 0;
    for (const MessageRow& row : simulation.record().messages()) {
      if (fate_of(row) == to_string(fate)) ++count;
    }
    return count;
  }
  const std::string& fate_of(const MessageRow& row) const {
    return simulation.record().text(row.fate);
  }
  std::uint64_t count(AgentId sender, Fate fate) const {
    return radio->counts(sender).fates[static_cast<std::size_t>(fate)];
  }

  FnvDigest digest;
  Simulation simulation;
  std::unique_ptr<Radio> radio;
  NameId kind;
  std::vector<Heard> heard;
  std::vector<Outcome> outcomes;
  std::function<void(const Packet&)> reaction;    // of everybody, after writing down
  std::function<void(const Packet&, bool)> told;  // of an outcome

 private:
  class Ear final : public Receiver {
   public:
    explicit Ear(Bed& bed) : bed_(bed) {}
    void on_packet(const Packet& packet) override {
      bed_.heard.push_back({bed_.simulation.now().nanoseconds(), packet.sender, packet.receiver,
                            text_of(packet.bytes)});
      if (bed_.reaction) bed_.reaction(packet);
    }
    void on_outcome(const Packet& packet, bool acknowledged) override {
      bed_.outcomes.push_back({bed_.simulation.now().nanoseconds(), packet.sender, packet.receiver,
                               text_of(packet.bytes), acknowledged});
      if (bed_.told) bed_.told(packet, acknowledged);
    }

   private:
    Bed& bed_;
  };
  std::vector<std::unique_ptr<Ear>> ears_;
  std::deque<std::function<void()>> todo_;  // they stay where they are while one adds another
};

}  // namespace hearsay
