// Who may take part in a fleet, and what the others are told.
#include "tools/live/roster.hpp"

#include <gtest/gtest.h>

#include "tests/net/live/port_bed.hpp"

namespace hearsay::fleet {
namespace {

WorldOptions world_options(const std::string& fleet, bool lockstep) {
  return {.fleet = {.fleet = fleet},
          .seed = 42,
          .lockstep = lockstep,
          .speed = 4.0,
          .scenario_hash = "the scenario",
          .version = "hearsay 1.2.3"};
}

/// A world of four agents, and somebody who says hello.
class Door {
 public:
  Door(const std::string& name, bool lockstep)
      : fleet_(live::own_fleet(name)), options_(world_options(fleet_, lockstep)) {
    live::wait(stranger_, [&] { return hellos_.matched() && welcomes_.writers_alive() > 0; });
  }

  live::Hello hello() {
    return {.agent = 2,
            .process = ++processes_,
            .scenario = "the scenario",
            .version = "hearsay 1.2.3"};
  }
  /// Says hello until it is answered, as processes do.
  live::Welcome answer_to(const live::Hello& hello) {
    std::vector<std::byte> words, bytes;
    live::encode(hello, words);
    live::Welcome welcome;
    WallTime again;
    EXPECT_TRUE(live::wait(stranger_, [&] {
      if (WallClock::now() >= again) {
        again = WallClock::now() + wall(0.2);
        EXPECT_TRUE(hellos_.write(words));
      }
      roster_.update(777);
      while (welcomes_.take(bytes)) {
        EXPECT_TRUE(live::decode(bytes, welcome));
        if (welcome.process == hello.process) return true;
      }
      return false;
    }));
    EXPECT_EQ(welcome.agent, hello.agent);
    return welcome;
  }
  void expect_refusal(const live::Hello& hello, const std::string& reason) {
    const int before = roster_.refused();
    const live::Welcome welcome = answer_to(hello);
    EXPECT_FALSE(welcome.accepted);
    EXPECT_EQ(welcome.reason, reason);
    EXPECT_EQ(roster_.refused(), before + 1);
    answer_to(hello);  // who asks again is the same
    EXPECT_EQ(roster_.refused(), before + 1);
  }
  Roster& roster() { return roster_; }
  live::Port& stranger() { return stranger_; }
  const std::string& fleet() const { return fleet_; }

 private:
  std::string fleet_;
  WorldOptions options_;
  live::Port world_{{.fleet = fleet_}};
  live::Port stranger_{{.fleet = fleet_}};
  Reactor reactor_{world_};
  Roster roster_{world_, reactor_, options_, 4};
  live::Writer hellos_ = stranger_.writer(live::hello_topic(), live::fleet_partition(fleet_));
  live::Reader welcomes_ = stranger_.reader(live::welcome_topic(), live::fleet_partition(fleet_));
  std::uint64_t processes_ = 0;
};

TEST(Roster, WelcomesWhoBelongsToIt) {
  Door door("welcome", true);
  const live::Welcome welcome = door.answer_to(door.hello());
  EXPECT_TRUE(welcome.accepted) << welcome.reason;
  EXPECT_TRUE(welcome.lockstep);
  EXPECT_EQ(welcome.seed, 42u);
  EXPECT_EQ(welcome.now_ns, 777);
  EXPECT_EQ(welcome.speed, 4.0);
  EXPECT_EQ(welcome.reason, "");
  EXPECT_EQ(door.roster().refused(), 0);
}

TEST(Roster, RefusesAnotherProtocolScenarioNumberOrVersionAndSaysWhy) {
  Door door("refusals", true);
  live::Hello hello = door.hello();
  hello.protocol = 99;
  door.expect_refusal(hello, "it speaks protocol 99, this world 1");
  hello = door.hello();
  hello.scenario = "another";
  door.expect_refusal(hello, "it has another scenario, or other settings of it");
  hello = door.hello();
  hello.agent = 4;
  door.expect_refusal(hello, "there is no agent 4: the scenario has 4");
  hello.process = door.hello().process;
  hello.agent = live::everybody;
  door.expect_refusal(hello, "there is no agent 4294967295: the scenario has 4");
  hello = door.hello();
  hello.version = "hearsay 1.2.2";
  door.expect_refusal(hello, "it is of version 'hearsay 1.2.2', this world of 'hearsay 1.2.3'");
  hello = door.hello();
  hello.version = "somebody's own";
  door.expect_refusal(hello, "this world moves in lockstep, which only hearsay's own agents can");
}

TEST(Roster, InRealTimeProgramsOfOthersAreWelcome) {
  Door door("others", false);
  live::Hello hello = door.hello();
  hello.version = "somebody's own";
  hello.scenario = "";
  EXPECT_TRUE(door.answer_to(hello).accepted);
  hello = door.hello();
  hello.version = "somebody's own";
  hello.scenario = "another";
  door.expect_refusal(hello, "it has another scenario, or other settings of it");
}

TEST(Roster, AnAgentIsThereOnceUntilItIsGone) {
  Door door("once", false);
  live::Hello first = door.hello();
  first.version = "somebody's own";
  ASSERT_TRUE(door.answer_to(first).accepted);
  {
    const live::Writer life =
        door.stranger().writer(live::report_topic(), live::agent_partition(door.fleet(), 2));
    ASSERT_TRUE(live::wait(door.stranger(), [&] {
      door.roster().update(0);
      return door.roster().member(2).here;
    }));
    live::Hello second = first;
    second.process = door.hello().process;
    door.expect_refusal(second, "agent 2 is there already");
    EXPECT_TRUE(door.answer_to(first).accepted);  // who did not hear the answer asks again
  }
  ASSERT_TRUE(live::wait(door.stranger(), [&] { return !door.roster().member(2).alive(); }));
  EXPECT_TRUE(door.answer_to(door.hello()).accepted);
}

}  // namespace
}  // namespace hearsay::fleet
