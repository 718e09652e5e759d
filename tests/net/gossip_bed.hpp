// A fleet whose agents gossip and write down what they are handed.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "net/gossip.hpp"
#include "net/link_plan.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {

enum class Policy { bundles, slots };

class GossipBed {
 public:
  struct Options {
    RadioOptions radio;
    GossipOptions gossip;
    std::uint64_t seed = 1;
    Time end = Time::at(60_s);
  };

  GossipBed(Policy policy, LinkPlan plan, const Options& options)
      : simulation({.seed = options.seed,
                    .end = options.end,
                    .record = {.keep_messages = true, .digest = &digest}}),
        radio(simulation,
              Reach{.topology = std::move(plan.topology), .changes = std::move(plan.changes)},
              options.radio),
        kind(simulation.record().name("note")) {
    const int agents = radio.topology().agents();
    for (AgentId a = 0; a < agents; ++a) {
      auto store = policy == Policy::bundles ? make_bundle_store(a, agents, options.gossip)
                                             : make_slot_store(a, agents, options.gossip);
      nodes.push_back(
          std::make_unique<Gossip>(simulation, radio, a, std::move(store), options.gossip));
      ears_.push_back(std::make_unique<Ear>(*this));
      nodes.back()->attach(*ears_.back());
      nodes.back()->start();
    }
  }
  GossipBed(Policy policy, Topology topology, const Options& options)
      : GossipBed(policy, LinkPlan{.topology = std::move(topology), .changes = {}}, options) {}

  // Writes now. A subject is a slot.
  bool write(AgentId from, std::string_view text, AgentId to = no_agent, std::uint64_t subject = 0,
             RiderPtr rider = {}) {
    return node(from).write({.kind = kind,
                             .bytes = bytes_of(text),
                             .receiver = to,
                             .rider = std::move(rider),
                             .subject = subject});
  }
  template <typename What>
  void at(Duration since_start, What what) {
    todo_.push_back(std::move(what));
    simulation.schedule(Time::at(since_start), Phase::act,
                        [this, n = todo_.size() - 1] { todo_[n](); });
  }
  // Away and back without memory.
  void reboot(AgentId agent) {
    radio.set_up(agent, false);
    radio.set_up(agent, true);
    node(agent).forget();
  }
  void run() {
    const RunEnd end = simulation.run();
    EXPECT_TRUE(end.ok()) << end.message;
    radio.finish();
    simulation.record().finish();
  }

  Gossip& node(AgentId agent) { return *nodes[static_cast<std::size_t>(agent)]; }
  const GossipCounts& counts(AgentId agent) { return node(agent).counts(); }
  // How often an agent was handed a text.
  std::size_t times(AgentId agent, std::string_view text) const {
    std::size_t count = 0;
    for (const Heard& h : heard) count += h.receiver == agent && h.text == text ? 1 : 0;
    return count;
  }
  // Packets of a kind that `agent` handed to its radio, by receivers.
  std::size_t rows(AgentId agent, std::string_view of_kind) const {
    std::size_t count = 0;
    for (const MessageRow& row : simulation.record().messages()) {
      count += row.sender == agent && simulation.record().text(row.kind) == of_kind ? 1 : 0;
    }
    return count;
  }

  FnvDigest digest;
  Simulation simulation;
  Radio radio;
  NameId kind;
  std::vector<Heard> heard;  // by whom, of whom, what
  std::vector<std::unique_ptr<Gossip>> nodes;
  std::function<void(const Packet&)> reaction;  // of everybody, after writing down

 private:
  class Ear final : public Receiver {
   public:
    explicit Ear(GossipBed& bed) : bed_(bed) {}
    void on_packet(const Packet& packet) override {
      bed_.heard.push_back({bed_.simulation.now().nanoseconds(), packet.sender, packet.receiver,
                            text_of(packet.bytes)});
      if (bed_.reaction) bed_.reaction(packet);
    }

   private:
    GossipBed& bed_;
  };
  std::vector<std::unique_ptr<Ear>> ears_;
  std::deque<std::function<void()>> todo_;
};

}  // namespace hearsay
