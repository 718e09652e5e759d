"""A world that is killed: its agents end, and say why."""
import os
import signal
import unittest

from live_bed import LiveBed


class TheWorldIsKilled(LiveBed):
    def begun(self, fleet, *pace):
        """@return a world in the midst of a run, and its agents."""
        words = ["ring.toml", "--set", "duration_s=100000"]
        world = self.start("world", *words, *pace, "--status", fleet=fleet)
        agents = [self.start("agent", *words, "--id", i, fleet=fleet) for i in range(4)]
        self.until(lambda: world.now_s() > 0, "the run begins")
        return world, agents

    def test_agents_end_and_say_why(self):
        """It takes them a while to be sure; hence all at once: in lockstep, in real time, and before it began."""
        names = [self.fleet + suffix for suffix in ["-lockstep", "-real", "-before"]]
        early = self.start("world", "ring.toml", fleet=names[2])
        waits = self.start("agent", "ring.toml", "--id", 0, "--status", fleet=names[2])
        self.until(lambda: "waits for the others" in waits.text(), "it was welcome")
        fleets = [self.begun(names[0], "--lockstep"), self.begun(names[1], "--speed", 10)]
        for world in [early, fleets[0][0], fleets[1][0]]:
            world.kill()
        for name, (_, agents) in zip(names, fleets):
            for i, agent in enumerate(agents):
                self.ends(agent, 1)
                self.assertEqual(agent.trouble(), f"hearsay agent {i}: the world of fleet '{name}' is gone\n")
                self.assertEqual(agent.text(), "")
        self.ends(waits, 1)
        self.assertEqual(waits.trouble(), f"hearsay agent 0: the world of fleet '{names[2]}' is gone\n")

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
