#include "agents/agent.hpp"

#include <gtest/gtest.h>

#include "agents/catalog.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

/// Says its number every second and adds up what it hears.
class Adder final : public Agent {
 public:
  explicit Adder(Context& own) : Agent(own) {}
  void start() override { spawn(talk()); }
  void on_packet(const Packet& packet) override { sum += value_of<int>(packet).value(); }
  int sum = 0;

 private:
  Process talk() {
    for (;;) {
      co_await context().sleep(1_s);
      const int number = context().id() + 1;
      context().broadcast("number", bytes_of(number));
    }
  }
};

struct Fleet {
  explicit Fleet(int agents)
      : simulation({.end = Time::at(10_s)}), radio(simulation, Topology::full(agents), {}) {
    for (AgentId id = 0; id < agents; ++id) {
      contexts.push_back(
          std::make_unique<Context>(simulation, radio,
                                    Context::Identity{.id = id,
                                                      .name = "adder" + std::to_string(id),
                                                      .kind = "adder",
                                                      .parameters = {{"gain", 2.0}}}));
      adders.push_back(std::make_unique<Adder>(*contexts.back()));
      radio.attach(id, *adders.back());
    }
    for (auto& adder : adders) adder->start();
  }
  Simulation simulation;
  Radio radio;
  std::vector<std::unique_ptr<Context>> contexts;
  std::vector<std::unique_ptr<Adder>> adders;
};

TEST(Agent, HearsWhatTheOthersBroadcast) {
  Fleet fleet(3);
  EXPECT_EQ(fleet.simulation.run().reason, EndReason::time_reached);
  // Nine seconds' words arrive before the end; the tenth's are still on the air (32 µs at 1
  // Mbit/s).
  EXPECT_EQ(fleet.adders[0]->sum, 9 * (2 + 3));
  EXPECT_EQ(fleet.adders[2]->sum, 9 * (1 + 2));
}

TEST(Agent, ValuesOfAnotherSizeAreNotMistaken) {
  const double value = 1.0;
  const Packet packet{.sender = 0,
                      .receiver = 1,
                      .kind = 0,
                      .bytes = bytes_of(value),
                      .sent = Time(),
                      .rider = nullptr};
  EXPECT_EQ(value_of<double>(packet), 1.0);
  EXPECT_EQ(value_of<float>(packet), std::nullopt);
}

TEST(Context, GivesParametersOrWhatStandsInForThem) {
  Fleet fleet(1);
  EXPECT_EQ(fleet.contexts[0]->parameter("gain", 1.0), 2.0);
  EXPECT_EQ(fleet.contexts[0]->parameter("loss", 1.0), 1.0);
}

TEST(Context, StreamsOfAgentsAndPurposesAreApart) {
  Fleet fleet(2);
  const auto first = [](Stream stream) { return stream.bits(); };
  EXPECT_NE(first(fleet.contexts[0]->stream("a")), first(fleet.contexts[1]->stream("a")));
  EXPECT_NE(first(fleet.contexts[0]->stream("a")), first(fleet.contexts[0]->stream("b")));
  EXPECT_EQ(first(fleet.contexts[0]->stream("a")), first(fleet.contexts[0]->stream("a")));
}

TEST(Catalog, AKindIsNamedOnce) {
  Catalog catalog;
  catalog.add_agent<Adder>("adder", "adds");
  EXPECT_THROW(catalog.add_agent<Adder>("adder", "adds"), std::invalid_argument);
  EXPECT_THROW(catalog.add_agent<Adder>("estimator", "adds"), std::invalid_argument);
}

}  // namespace
}  // namespace hearsay
