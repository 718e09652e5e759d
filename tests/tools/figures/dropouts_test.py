"""Tests of the figures of rumour/dropouts: their numbers against those worked out by hand, and what
the figures say."""

import math
import sqlite3
import unittest

from small_study import RULES, WithDatabase, make_database  # first: it makes the scripts known

import data
import dropouts
import heal
import panels

INFINITY = float("inf")


class Dropouts(WithDatabase):
    def make_study(self, change=None, agreement=True):
        """The small study with what dropouts record. Agents send 1000 bytes, my-rule 3000; repetition r
        agrees again after r s, its fourth never."""
        connection = make_database(self.file, change=change)
        runs = connection.execute(
            "SELECT run.id, run.repetition, axis.value FROM run JOIN axis ON axis.run = run.id"
            " WHERE axis.name = 'rule'"
        ).fetchall()
        for run, repetition, rule in runs:
            rows = [(run, a, "bytes_sent", 3e3 if rule == "my-rule" else 1e3) for a in (0, 1)]
            if agreement:
                time_s = INFINITY if repetition == 4 else float(repetition)
                rows.append((run, -1, "agree_again_s", time_s))
            connection.executemany("INSERT INTO scalar VALUES (?, ?, ?, ?)", rows)
        connection.execute(
            "INSERT INTO series SELECT run, t_s, agent, subject, 'disagreement_m', 2 * value"
            " FROM series WHERE name = 'rms_error_m'"
        )
        connection.commit()
        connection.close()

    def levels(self, level="loss", **where):
        database = data.Database(self.file)
        return dropouts.Levels(database.select(database.study(None), where), level)


class Numbers(Dropouts):
    def test_a_curve_has_the_value_at_the_end_of_each_level(self):
        self.make_study()
        levels = self.levels()
        self.assertEqual(levels.names(), ["0 %", "30 %"])
        error = levels.error("ring", "naive")
        squares = [r * r for r in (1, 2, 3, 4)] + [r * r for r in (2, 3, 4, 5)]
        for i in range(2):
            self.assertAlmostEqual(error.value[i], math.sqrt(sum(squares) / 8) / 21.0, places=12)
            self.assertLess(error.low[i], error.value[i])
        self.assertAlmostEqual(levels.claimed("ring", "none").value[1], 2.0 / 21.0, places=12)
        self.assertAlmostEqual(levels.anees("line", "none").value[0], 1.125)
        self.assertEqual(list(levels.kilobytes("line", "my-rule")), [3.0, 3.0])

    def test_who_never_agrees_counts_as_later_than_all_others(self):
        self.make_study()
        middle, low, high, never = self.levels().agreement("ring", "naive")
        self.assertEqual(list(middle), [3.0, 3.0])
        self.assertEqual(list(low), [1.0, 1.0])
        self.assertEqual(list(high), [INFINITY, INFINITY])
        self.assertEqual(list(never), [0.25, 0.25])

    def test_a_rule_without_a_cell_has_a_gap_but_none_is_the_same_at_every_level(self):
        self.make_study()
        connection = sqlite3.connect(self.file)
        connection.execute(
            "DELETE FROM run WHERE id IN (SELECT a.run FROM axis a JOIN axis b ON a.run = b.run"
            " WHERE a.name = 'loss' AND a.value = '0.3' AND b.name = 'rule'"
            " AND b.value IN ('none', 'my-rule'))"
        )
        connection.commit()
        connection.close()
        levels = self.levels()
        none, mine = levels.error("ring", "none").value, levels.error("ring", "my-rule").value
        self.assertEqual(none[0], none[1])
        self.assertTrue(math.isfinite(mine[0]) and math.isnan(mine[1]))

    def test_disagreement_is_that_of_the_whole_fleet(self):
        self.make_study()
        database = data.Database(self.file)
        chosen = database.select(database.study(None), {"loss": "0"})
        apart, error, _ = heal.Heal(chosen, (5.0, 15.0)).curves("ring", "none")
        self.assertAlmostEqual(apart.value[0], 2.0 * math.sqrt((0 + 1 + 4 + 9) / 4), places=12)
        self.assertAlmostEqual(error.value[0], panels.rms(chosen.series(["rms_error_m"])
                               ["rms_error_m"], chosen.cell(topology="ring", rule="none")).value[0])


class Figures(Dropouts):
    def test_the_figure_says_what_was_measured(self):
        self.make_study()
        text = self.draw("dropouts.py", "a.svg", "--level", "loss").decode()
        for said in ("share of packets lost", "kB an agent", "seconds after the heal", "never",
                     "4 paired repetitions", *RULES):
            self.assertIn(said, text)
        self.assertEqual(text, self.draw("dropouts.py", "b.svg", "--level", "loss").decode())

    def test_without_times_of_agreement_there_is_no_such_panel(self):
        self.make_study(agreement=False)
        text = self.draw("dropouts.py", "a.svg", "--level", "loss").decode()
        self.assertNotIn("seconds after the heal", text)

    def test_indefinite_beliefs_and_absurd_errors_are_told(self):
        def change(rule, repetition, t, agent, name, value):
            if rule == "my-rule" and agent >= 0 and name == "claimed_sigma_m":
                return None
            absurd = {"rms_error_m": 1e6, "nees": 1e9}.get(name, 1.0) if rule == "naive" else 1.0
            return value * absurd if agent >= 0 else value

        self.make_study(change=change)
        text = self.draw("dropouts.py", "a.svg", "--level", "loss").decode()
        for said in ("half indefinite", "↑ errs by", "naive: up to"):
            self.assertIn(said, text)

    def test_a_cut_over_time_is_drawn(self):
        self.make_study()
        arguments = ("--loss", "0.3", "--cut", "5", "15")
        text = self.draw("heal.py", "a.svg", *arguments).decode()
        for said in ("5 to 15 s", "30 % loss", "How far estimates lie apart", *RULES):
            self.assertIn(said, text)
        self.assertEqual(text, self.draw("heal.py", "b.svg", *arguments).decode())

    def test_mistakes_are_named(self):
        self.make_study()
        self.assertEqual(
            self.refused("dropouts.py", "small.db", "x.png", "--level", "rate"),
            "small.db: study 'small' has no axis 'rate'",
        )
        self.assertIn("--level", self.refused("dropouts.py", "small.db", "x.png"))
        self.assertEqual(
            self.refused("heal.py", "small.db", "x.png", "--cut", "5", "15"),
            "small.db: choose one loss with --loss: 0, 0.3",
        )


if __name__ == "__main__":
    unittest.main()
