"""Agents that have more of their world than a radio, as processes: robots, trackers, explorers."""
import unittest

from bed import SOURCE
from live_bed import LiveBed

CORRIDOR = SOURCE / "scenarios/lost/corridor.toml"
CROSSING = SOURCE / "scenarios/tracking/crossing.toml"
EXPLORE = SOURCE / "scenarios/merino/ch4-explore.toml"


class Lockstep(LiveBed):
    def expect_same(self, *words):
        self.assertEqual(self.live(*words, "--lockstep", "--digest"), self.good("run", *words, "--digest"))

    def test_robots_with_trails_have_the_digest_of_the_simulated_run(self):
        self.expect_same(CORRIDOR, "--set", "duration_s=60")

    def test_trackers_have_it(self):
        self.expect_same(CROSSING, "--set", "duration_s=40")

    def test_explorers_have_it(self):
        self.expect_same(EXPLORE, "--set", "duration_s=40")


class Refused(LiveBed):
    def test_a_memory_of_who_keeps_none(self):
        for words in [[CORRIDOR], [CROSSING], [EXPLORE], [SOURCE / "scenarios/merino/ch3-window.toml"]]:
            agent = self.start("agent", *words, "--id", 0, "--memory", "memory")
            self.ends(agent, 2)
            self.assertIn("keeps no memory (--memory); estimators of kind", agent.trouble())


class RealTime(LiveBed):
    def expect_names(self, *words):
        """The record is one like any other."""
        self.good("run", *words, "--out", "run.db")
        for table in ["agent", "scalar", "series"]:
            names = f"SELECT DISTINCT name FROM {table} ORDER BY name"
            self.assertEqual(self.rows("live.db", names), self.rows("run.db", names))

    def series(self, name, agent):
        return [value for (value,) in self.rows(
            "live.db", "SELECT value FROM series WHERE name = ? AND agent = ? ORDER BY t_s", name, agent)]

    def test_trackers_with_trails_understand_each_other(self):
        self.live(CROSSING, "--set", "duration_s=100", "--set", "agents.tracker.trail_s=10", "--speed", 20,
                  "--out", "live.db")
        for tracker in range(4):
            self.assertGreater(self.value("live.db", tracker, "fusions"), 5)
            self.assertEqual(self.value("live.db", tracker, "messages_refused"), 0)

    def test_robots_lay_and_follow_trails(self):
        words = [CORRIDOR, "--set", "duration_s=300"]
        self.live(*words, "--speed", 20, "--out", "live.db")
        self.expect_names(*words)
        for robot in range(4):
            self.assertGreater(self.value("live.db", robot, "distance_driven_m"), 20.0)
            self.assertGreater(self.value("live.db", robot, "crumbs_taken"), 0)
            self.assertEqual(self.value("live.db", robot, "messages_refused"), 0)
        # Who has seen no place lays no crumbs.
        for name in ["crumbs_laid", "packets_delivered"]:
            self.assertGreater(sum(self.value("live.db", robot, name) for robot in range(4)), 50)

    def test_trackers_find_what_there_is(self):
        words = [CROSSING, "--set", "duration_s=100"]
        self.live(*words, "--speed", 20, "--out", "live.db")
        self.expect_names(*words)
        for tracker in range(4):
            self.assertGreater(self.value("live.db", tracker, "tracks_confirmed"), 1)
            self.assertGreater(self.value("live.db", tracker, "fusions"), 5)
            # What it told of itself was compared with the truth: of three targets it has some.
            missed = self.series("missed_targets", tracker)[-10:]
            self.assertLess(sum(missed) / len(missed), 2.5)

    def test_explorers_look_where_they_fly(self):
        words = [EXPLORE, "--set", "duration_s=100", "--set", "record.ledger=off"]
        self.live(*words, "--speed", 20, "--out", "live.db")
        self.expect_names(*words)
        for explorer in range(4):
            self.assertGreater(self.value("live.db", explorer, "distance_flown_m"), 50.0)
            self.assertGreater(self.value("live.db", explorer, "cells_seen_share"), 0.1)
            self.assertGreater(self.value("live.db", explorer, "fusions"), 3)
            entropy = self.series("entropy_nats", explorer)
            self.assertLess(entropy[-1], 0.9 * entropy[0])


class AnotherProcessTakesTheirPlace(LiveBed):
    def expect_robots_to(self, mode, duration_s, *speed):
        words = [CORRIDOR, "--set", f"duration_s={duration_s}", "--set", 'record.series=["robot_x_m"]',
                 "--set", "record.series_period_s=5", "--set", "record.messages=all"]
        joined_s = self.joined_again(words, [mode, *speed, "--out", "live.db"])
        places = self.rows("live.db", "SELECT t_s, value FROM series WHERE agent = 1 AND name = 'robot_x_m' ORDER BY t_s")
        after = [place for time, place in places if time > joined_s]
        self.assertGreater(max(after) - min(after), 1.0)
        heard = self.rows("live.db", "SELECT count(*) FROM message WHERE receiver = 1 AND sent_s > ? AND fate = 'delivered'",
                          joined_s)
        self.assertGreater(heard[0][0], 10)
        # The steps of its control since the run began are not made up for. (A busy machine's are.)
        longest = max(abs(b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(places, places[1:]))
        self.assertLess(longest, 1.0)

    def test_robots_drive_on_in_lockstep(self):
        self.expect_robots_to("--lockstep", 500)

    def test_robots_drive_on_in_real_time(self):
        self.expect_robots_to("--speed", 300, 20)


if __name__ == "__main__":
    unittest.main()
