"""Agents that are killed or stopped in the midst of a run: the others go on, and another process may take their
place."""
import os
import signal
import unittest

from live_bed import LiveBed

# Nothing is lost, so that what is not heard was not said; who is outdated is refused.
CALM = ["--set", "radio.loss.probability=0.0", "--set", 'agents.estimator.fusion="channel-robust"',
        "--set", "record.messages=all"]
DURATION_S = {"--lockstep": 800.0, "--speed": 160.0}


class AnAgentIsKilled(LiveBed):
    def words(self, mode):
        return ["ring.toml", *CALM, "--set", f"duration_s={DURATION_S[mode]}"]

    def world(self, mode):
        pace = ["--lockstep"] if mode == "--lockstep" else ["--speed", 20]
        return [*pace, "--out", "live.db"]

    def delivered(self, sender, since_s):
        """@return who got packets that were sent after this."""
        return {receiver for (receiver,) in self.rows(
            "live.db", "SELECT receiver FROM message WHERE sender = ? AND sent_s > ? AND fate = 'delivered'",
            sender, since_s)}

    def test_in_lockstep_the_others_go_on(self):
        words, mode = self.words("--lockstep"), "--lockstep"
        world, agents = self.world_and_agents(*words, world=self.world(mode))
        self.until(lambda: world.now_s() > 0, "the run begins")
        agents[1].kill()
        self.ends(world)
        self.ends(agents[1], -signal.SIGKILL)
        for other in [0, 2, 3]:
            self.ends(agents[other])
        ((silent_s, who),) = self.came("silent")
        self.assertEqual(who, 1)
        self.assertTrue(0 < silent_s < DURATION_S[mode], silent_s)
        self.assertEqual(self.came("joined again"), [])
        self.assertEqual(self.delivered(1, silent_s), set())
        self.assertEqual(self.delivered(2, silent_s), {3})
        self.assertEqual(self.delivered(3, silent_s), {0, 2})

    def expect_to_join_again(self, mode, radio=(), memory=()):
        return self.joined_again([*self.words(mode), *radio], self.world(mode), memory)

    def expect_to_be_heard(self, joined_s):
        """What it says counts again: delivered, and not taken for what it said in its life before."""
        self.assertEqual(self.delivered(1, joined_s), {0, 2})
        self.assertEqual(self.delivered(0, joined_s), {1, 3})
        self.assertEqual([self.value("live.db", agent, "messages_refused") for agent in range(4)], [0, 0, 0, 0])

    def test_in_lockstep_another_process_takes_its_place(self):
        self.expect_to_be_heard(self.expect_to_join_again("--lockstep"))

    def test_in_real_time_another_process_takes_its_place(self):
        self.expect_to_be_heard(self.expect_to_join_again("--speed"))
        self.assertGreater(self.value("live.db", 1, "measurements"), 0)

    def test_it_joins_again_with_what_it_remembers(self):
        for mode in ["--lockstep", "--speed"]:
            with self.subTest(mode):
                self.expect_to_be_heard(self.expect_to_join_again(mode, memory=["--memory", f"memory{mode}"]))
                self.assertEqual(self.rows("live.db", "SELECT detail FROM event WHERE kind = 'joined again'"),
                                 [("with its memory",)])
                (self.dir / "live.db").unlink()

    def test_the_memory_of_another_agent_and_no_memory_at_all_are_refused(self):
        words = ["ring.toml", "--id", 1, "--memory", "memory"]
        self.write("memory", "nonsense")
        agent = self.start("agent", *words)
        self.ends(agent, 2)
        self.assertIn("memory: is no memory of an agent, or damaged", agent.trouble())
        common = ["ring.toml", "--set", "duration_s=10"]
        world = self.start("world", *common, "--lockstep")
        agents = [self.start("agent", *common, "--id", i, *(["--memory", "memory0"] if i == 0 else []))
                  for i in range(4)]
        for process in [world, *agents]:
            self.ends(process)
        agent = self.start("agent", *common, "--id", 1, "--memory", "memory0")
        self.ends(agent, 2)
        self.assertIn("memory0: is the memory of another agent: of agent 0 of scenario", agent.trouble())

    def expect_one_that_was_stopped_to_begin_anew(self, mode, absent_s):
        world, agents = self.world_and_agents(*self.words(mode), world=self.world(mode))
        self.until(lambda: world.now_s() > 0, "the run begins")
        agents[1].kill(signal.SIGSTOP)
        then_s = world.now_s()
        self.until(lambda: world.now_s() > then_s + absent_s, "the world goes on without it")
        agents[1].kill(signal.SIGCONT)
        self.ends(world)
        for agent in agents:
            self.ends(agent)
        ((_, silent),), ((joined_s, joined),) = self.came("silent"), self.came("joined again")
        self.assertEqual((silent, joined), (1, 1))
        self.expect_to_be_heard(joined_s)

    def test_in_lockstep_a_process_that_was_taken_for_gone_begins_anew(self):
        self.expect_one_that_was_stopped_to_begin_anew("--lockstep", 0.0)

    def test_in_real_time_a_process_that_was_taken_for_gone_begins_anew(self):
        self.expect_one_that_was_stopped_to_begin_anew("--speed", 60.0)

    def test_without_the_worlds_radio_another_process_is_heard_as_well(self):
        self.expect_to_join_again("--speed", ["--radio", "direct"])
        self.assertEqual([self.value("live.db", agent, "messages_refused") for agent in range(4)], [0, 0, 0, 0])

    def test_a_fleet_that_was_started_together_goes_on(self):
        fleet = self.start("live", *self.words("--speed"), *self.world("--speed"), terminal=True)
        self.until(lambda: fleet.now_s() > 0, "the run begins")
        os.kill(self.child(2), signal.SIGKILL)
        self.ends(fleet)
        ((silent_s, who),) = self.came("silent")
        self.assertEqual(who, 2)
        self.assertTrue(0 < silent_s < DURATION_S["--speed"], silent_s)
        self.assertEqual(self.delivered(2, silent_s), set())
        self.assertEqual(self.delivered(0, silent_s), {1, 3})
        for line in ["estimator2   killed by signal 9", "estimator3   done", "world        done"]:
            self.assertIn(line, fleet.text())


if __name__ == "__main__":
    unittest.main()
