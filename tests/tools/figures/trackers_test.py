"""Tests of the figure of tracking/rules: its numbers against those worked out by hand."""

import unittest

from small_study import T_S, WithDatabase, make_database  # first: it makes the scripts known

import style

AT_END = {"missed_targets": 0.25, "false_tracks": 1.5, "double_tracks": 0.5}


class Trackers(WithDatabase):
    def make_study(self, topologies=("line",)):
        """The small study with the series of trackers in place of its own."""
        connection = make_database(self.file, losses=("0.0",), series=())
        connection.execute("DELETE FROM axis WHERE name = 'loss'")
        for (run,) in connection.execute("SELECT id FROM run").fetchall():
            (topology,) = connection.execute(
                "SELECT value FROM axis WHERE run = ? AND name = 'topology'", (run,)
            ).fetchone()
            if topology not in topologies:
                for table, key in (("run", "id"), ("axis", "run"), ("scalar", "run")):
                    connection.execute(f"DELETE FROM {table} WHERE {key} = ?", (run,))
                continue
            for t_s in T_S:
                for agent in (0, 1):
                    for name, value in {"gospa_m": 7.0, **AT_END}.items():
                        # An agent has twice as much as the mean, and the other nothing.
                        row = (run, t_s, agent, "", name, 2.0 * value * agent)
                        connection.execute("INSERT INTO series VALUES (?, ?, ?, ?, ?, ?)", row)
        connection.commit()
        connection.close()

    def test_the_figure_says_how_much_is_wrong_in_all(self):
        self.make_study()
        drawn = self.draw("trackers.py", "trackers.svg").decode()
        self.assertEqual(drawn.count(">2.2<"), 3)  # 0.25 + 1.5 + 0.5 for each rule
        for text in ("my-rule", "targets missed", "tracks of nothing", "4 repetitions"):
            self.assertIn(text, drawn)

    def test_no_two_rules_look_the_same(self):
        rules = ["none", "naive", "most-certain", "ci-det", "ci-trace", "inverse-ci", "ellipsoidal"]
        self.assertEqual(len({style.rule_style(rule, rules)[0] for rule in rules}), len(rules))
        many = rules + ["channel", "channel-robust", "ci-half", "split-ci", "my-rule"]
        self.assertEqual(len({style.rule_style(rule, many) for rule in many}), len(many))

    def test_equal_data_give_equal_bytes(self):
        self.make_study()
        self.assertEqual(self.draw("trackers.py", "a.png"), self.draw("trackers.py", "b.png"))

    def test_several_topologies_are_not_mixed(self):
        self.make_study(topologies=("line", "ring"))
        self.assertIn("choose one topology", self.refused("trackers.py", self.file, "x.png"))


if __name__ == "__main__":
    unittest.main()
