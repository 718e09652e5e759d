"""A world that is killed: its agents end, and say why."""
import os
import signal
import unittest

from live_bed import LiveBed


class TheWorldIsKilled(LiveBed):
    def expect_agents_to_say_so(self, *pace):
        words = ["ring.toml", "--set", "duration_s=100000"]
        world, agents = self.world_and_agents(*words, world=pace)
        self.until(lambda: world.now_s() > 0, "the run begins")
        world.kill()
        for i, agent in enumerate(agents):
            self.ends(agent, 1)
            self.assertEqual(agent.trouble(), f"hearsay agent {i}: the world of fleet '{self.fleet}' is gone\n")
            self.assertEqual(agent.text(), "")

    def test_in_lockstep_agents_end(self):
        self.expect_agents_to_say_so("--lockstep")

    def test_in_real_time_agents_end(self):
        self.expect_agents_to_say_so("--speed", 10)

    def test_before_it_began_agents_end(self):
        world = self.start("world", "ring.toml")
        agent = self.start("agent", "ring.toml", "--id", 0, "--status")
        self.until(lambda: "waits for the others" in agent.text(), "it was welcome")
        world.kill()
        self.ends(agent, 1)

    def test_where_there_is_none_agents_do_not_wait_for_ever(self):
        agent = self.start("agent", "ring.toml", "--id", 1, "--patience", 0.3)
        self.ends(agent, 1)
        self.assertEqual(agent.trouble(),
                         f"hearsay agent 1: no world of fleet '{self.fleet}' answered within 0.3 s\n")

    def test_a_fleet_that_was_started_together_fails(self):
        fleet = self.start("live", "ring.toml", "--set", "duration_s=100000", "--lockstep", "--out", "live.db")
        self.until(lambda: len(self.members()) == 6, "all are there")
        os.kill(self.world_of_live(), signal.SIGKILL)
        self.ends(fleet, 1)
        self.assertEqual(self.members(), {})


if __name__ == "__main__":
    unittest.main()
