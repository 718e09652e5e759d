"""A world and its agents as processes. In lockstep they leave what the simulated run leaves; in real time they
measure, talk and fuse."""
import unittest

from bed import SOURCE
from live_bed import LiveBed

TRACK = SOURCE / "scenarios/merino/ch3-track.toml"


class Lockstep(LiveBed):
    def expect_same(self, *words):
        simulated = self.good("run", *words, "--digest")
        self.assertRegex(simulated, r"^xxh3-128/1:[0-9a-f]{32}")
        self.assertEqual(self.live(*words, "--lockstep", "--digest"), simulated)
        return simulated

    def test_a_ring_of_agents_has_the_digest_of_the_simulated_run(self):
        first = self.expect_same("ring.toml")
        self.assertNotEqual(self.expect_same("ring.toml", "--seed", "2"), first)

    def test_trajectories_of_something_that_moves_have_it(self):
        self.expect_same(TRACK, "--set", "duration_s=40")

    def test_agents_that_fail_and_come_back_have_it(self):
        calm = self.good("run", "ring.toml", "--digest")
        for kind in ["sleep", "reboot"]:
            dropouts = f'dropouts=[{{ kind = "{kind}", mean_up_s = 8.0, mean_down_s = 4.0 }}]'
            self.assertNotEqual(self.expect_same("ring.toml", "--set", dropouts), calm)

    def test_the_database_is_that_of_the_simulated_run(self):
        self.good("run", "ring.toml", "--out", "run.db", "--set", "record.messages=all")
        text = self.live("ring.toml", "--lockstep", "--out", "live.db", "--set", "record.messages=all")
        self.assertIn("stored in live.db", text)
        self.assertEqual(self.good("diff", "run.db", "live.db"), "the same\n")
        # diff does not only see that there are runs.
        self.live("ring.toml", "--lockstep", "--out", "other.db", "--seed", "2")
        self.assertEqual(self.command("diff", "run.db", "other.db").returncode, 1)
        for table in ["agent", "scalar", "series", "message", "link", "event", "run"]:
            columns = "count(*)" if table == "run" else "*"
            self.assertEqual(*(self.rows(file, f"SELECT {columns} FROM {table}") for file in ["run.db", "live.db"]))
        self.assertGreater(len(self.rows("live.db", "SELECT * FROM message")), 20)

    def test_processes_come_in_any_order(self):
        simulated = self.good("run", "ring.toml", "--digest")
        agents = [self.start("agent", "ring.toml", "--id", i) for i in [3, 2, 1, 0]]
        world = self.start("world", "ring.toml", "--lockstep", "--digest")
        self.ends(world)
        for agent in agents:
            self.ends(agent)
            self.assertEqual(agent.text() + agent.trouble(), "")
        self.assertEqual(world.text(), simulated)

    def test_twenty_agents_finish(self):
        self.expect_same("ring.toml", "--set", "agents.count=20", "--set", "duration_s=10")


class RealTime(LiveBed):
    def expect_life(self, *words):
        """At 20 times the pace of the clock on the wall, and the record is one like any other (but for ledgers)."""
        self.good("run", "ring.toml", "--out", "run.db", "--set", "record.ledger=off")
        process = self.start("live", "ring.toml", "--speed", 20, "--out", "live.db", *words)
        self.assertEqual(process.wait(30.0), 0, process.trouble())
        self.assertIn("time reached at 30 s", process.text())
        self.assertIn("deadlines of 10 ms missed", process.text())
        for table in ["agent", "scalar", "series"]:
            names = f"SELECT DISTINCT name FROM {table} ORDER BY name"
            self.assertEqual(self.rows("live.db", names), self.rows("run.db", names))
        for query in ["SELECT name, kind FROM agent", "SELECT status, reason, seed FROM run"]:
            self.assertEqual(self.rows("live.db", query), self.rows("run.db", query))
        for agent in range(4):
            # One look a second; of the last few an agent may not have heard when it is over.
            self.assertGreaterEqual(self.value("live.db", agent, "measurements"), 25)
            self.assertGreaterEqual(self.value("live.db", agent, "fusions"), 3)
            self.assertEqual(self.value("live.db", agent, "messages_refused"), 0)
            self.assertLess(self.value("live.db", agent, "distance_error_m"), 10.0)

    def test_a_run_takes_the_time_it_should_and_leaves_the_record_of_a_run(self):
        self.expect_life()
        self.assertGreater(self.value("live.db", 1, "packets_delivered"), 3)

    def test_agents_hear_each_other_without_the_worlds_radio(self):
        # Whoever is no neighbour in the scenario is heard all the same, and refused.
        self.expect_life("--radio", "direct", "--set", 'radio.topology="full"')
        for agent in range(4):
            self.assertEqual(self.value("live.db", agent, "packets_delivered"), 0)

    def test_trajectories_are_fused(self):
        self.live(TRACK, "--set", "duration_s=60", "--speed", 30, "--out", "live.db")
        for agent in [1, 2]:
            self.assertGreaterEqual(self.value("live.db", agent, "fusions"), 3)
            self.assertEqual(self.value("live.db", agent, "messages_refused"), 0)


if __name__ == "__main__":
    unittest.main()
