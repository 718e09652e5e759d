"""Tests of the table of rumour/rules: its numbers against those worked out by hand."""

import csv
import math
import os
import re
import unittest

from small_study import WithDatabase, make_database  # first: it makes the scripts known

import choice
import data


class TableOfChoice(WithDatabase):
    """Errors of the small study are (repetition + agent)/21 for all rules. Ledger's ANEES of agent a:
    "none" 1, "naive" 3 + a on the ring and 0.5 elsewhere, "my-rule" 0.5. Bytes sent: 1000 (a + 1),
    saved: ½ m by "naive", ±1 m by "my-rule" in turn."""

    def make_study(self, change=None):
        connection = make_database(self.file, change=change)
        run = connection.execute
        run("INSERT INTO series SELECT run, t_s, agent, subject, 'ledger_anees', CASE"
            " (SELECT value FROM axis a WHERE a.run = series.run AND name = 'rule') WHEN 'none' THEN 1.0"
            " WHEN 'naive' THEN CASE (SELECT value FROM axis a WHERE a.run = series.run AND name ="
            " 'topology') WHEN 'ring' THEN 3.0 + agent ELSE 0.5 END ELSE 0.5 END"
            " FROM series WHERE name = 'nees' AND agent >= 0")
        run("INSERT INTO scalar SELECT run, agent, 'bytes_sent', 1000.0 * (agent + 1) FROM scalar"
            " WHERE name = 'distance_error_m' AND agent >= 0")
        run("INSERT INTO scalar SELECT s.run, agent, 'distance_saved_m', CASE a.value WHEN 'none' THEN 0"
            " WHEN 'naive' THEN 0.5 ELSE 2 * (repetition % 2) - 1 END FROM scalar s JOIN axis a"
            " ON a.run = s.run AND a.name = 'rule' JOIN run r ON r.id = s.run"
            " WHERE s.name = 'distance_error_m' AND agent >= 0")
        run("UPDATE axis SET name = 'network', value = value || ', ' ||"
            " (SELECT CASE l.value WHEN '0.0' THEN 'good' ELSE '30 % lost' END FROM axis l"
            "  WHERE l.run = axis.run AND l.name = 'loss') WHERE name = 'topology'")
        run("DELETE FROM axis WHERE name = 'loss'")
        connection.commit()
        connection.close()

    def choice(self):
        database = data.Database(self.file)
        return choice.Choice(database.select(database.study(None), {}), ["line"])

    def test_the_table_knows_what_every_rule_takes_for_granted(self):
        here = os.path.dirname(os.path.abspath(__file__))
        with open(os.path.join(here, "../../../filters/gaussian/rules.cpp"), encoding="utf-8") as stream:
            names = re.findall(r'\{Rule::\w+,\s*"([a-z-]+)"', stream.read())
        self.assertGreaterEqual(len(names), 18)
        self.assertLessEqual(set(names), set(choice.ASSUMES))

    def test_errors_are_put_beside_those_of_the_central_filter(self):
        self.make_study()
        agents = sum(r * r for r in (1, 2, 3, 4)) + sum(r * r for r in (2, 3, 4, 5))
        central = sum(r * r for r in (0, 1, 2, 3))
        self.assertAlmostEqual(
            self.choice().relative_error("my-rule", "ring", "good"),
            math.sqrt((agents / 8) / (central / 4)), places=12)

    def test_the_worst_agent_decides_who_claims_too_much(self):
        self.make_study()
        of = self.choice()
        self.assertEqual(of.ends.worst_anees("naive", "ring", "good"), 4.0)
        self.assertEqual(choice.verdict(of, "naive", ["line"]), "yes (0.5)")
        self.assertEqual(choice.verdict(of, "naive", ["line", "ring"]), "**no** (4)")
        self.assertEqual(choice.verdict(of, "none", ["ring"]), "yes (1)")
        self.assertEqual(of.best("ring", "good"), ["none", "my-rule"])  # equal errors
        self.assertEqual(of.ends.best("ring", "good"), ["none", "my-rule"])
        self.assertIn("Shaded", self.draw("rules.py", "rules.svg").decode())

    def test_one_belief_that_is_none_is_enough_to_be_no_honest_rule(self):
        def change(rule, repetition, t, agent, name, value):
            broken = (rule, repetition, t, agent, name) == ("my-rule", 2, 20.0, 1, "claimed_sigma_m")
            return None if broken else value

        self.make_study(change)
        self.assertEqual(choice.verdict(self.choice(), "my-rule", ["ring"]), "**no** (indefinite)")

    def test_a_metre_costs_what_was_sent_over_what_was_saved(self):
        self.make_study()
        of = self.choice()
        self.assertEqual(of.mean(of.bytes, "naive", "line", "good"), 1500.0)
        self.assertAlmostEqual(of.bytes_per_m("naive", "line", "good"), 3000.0, places=9)
        self.assertTrue(math.isnan(of.bytes_per_m("my-rule", "line", "good")))  # of no certain sign
        self.assertTrue(math.isnan(of.bytes_per_m("none", "line", "good")))

    def test_the_table_has_a_row_a_rule_and_the_csv_a_line_a_cell(self):
        self.make_study()
        text = self.draw("choice.py", "choice.md").decode()
        for rule in ("none", "naive", "my-rule"):
            self.assertEqual(sum(line.startswith(f"| {rule} ") for line in text.splitlines()), 1)
        self.assertIn("| all that is heard is news |", text)
        self.assertIn("by 4 paired repetitions", text)
        with open(self.path("choice.csv"), newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(len(rows), 12)
        naive = next(row for row in rows if (row["rule"], row["graph"]) == ("naive", "ring"))
        self.assertEqual(naive["worst_ledger_anees"], "4")
        self.assertIn("no such graph", self.refused("choice.py", self.file, "x.md", "--trees", "star"))


if __name__ == "__main__":
    unittest.main()
