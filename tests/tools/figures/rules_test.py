"""Tests of the figure of rumour/rules: its numbers against those worked out by hand, and what it says."""

import math
import unittest

from small_study import WithDatabase, make_database  # first: it makes the scripts known

import data
import rules
import style


class Rules(WithDatabase):
    def make_study(self, change=None):
        """The small study with topology and loss as one axis."""
        connection = make_database(self.file, change=change)
        connection.execute(
            "UPDATE axis SET name = 'network', value = value || ', ' ||"
            " (SELECT CASE l.value WHEN '0.0' THEN 'good' ELSE '30 % lost' END FROM axis l"
            "  WHERE l.run = axis.run AND l.name = 'loss') WHERE name = 'topology'"
        )
        connection.execute("DELETE FROM axis WHERE name = 'loss'")
        connection.commit()
        connection.close()

    def ends(self):
        database = data.Database(self.file)
        return rules.Ends(database.select(database.study(None), {}))

    def assert_says(self, *texts):
        drawn = self.draw("rules.py", "rules.svg").decode()
        for text in texts:
            self.assertIn(text, drawn)

    def test_rows_and_columns_are_those_of_the_labels(self):
        self.make_study()
        ends = self.ends()
        self.assertEqual(ends.topologies, ["line", "ring"])
        self.assertEqual(ends.radios, ["good", "30 % lost"])

    def test_a_rule_has_the_values_at_the_end_of_the_runs(self):
        self.make_study()
        error, low, high, claimed = self.ends().of("naive", "ring", "good")
        squares = [r * r for r in (1, 2, 3, 4)] + [r * r for r in (2, 3, 4, 5)]
        self.assertAlmostEqual(error, math.sqrt(sum(squares) / 8) / 21.0, places=12)
        self.assertTrue(low < error < high)
        self.assertAlmostEqual(self.ends().of("none", "ring", "30 % lost")[3], 2.0 / 21.0, places=12)
        self.assertTrue(math.isnan(self.ends().of("none", "ring", "no such radio")[0]))

    def test_colours_say_who_claims_too_much(self):
        self.assertEqual(rules.color_of(1.0, 1.05), style.BLACK)
        self.assertEqual(rules.color_of(1.0, 2.0), rules.CAUTIOUS)
        self.assertEqual(rules.color_of(1.0, 0.5), rules.OVERCONFIDENT)
        self.assertEqual(rules.color_of(1.0, math.nan), rules.OVERCONFIDENT)

    def test_without_a_ledger_nobody_is_called_honest(self):
        self.make_study()
        self.assertEqual(self.ends().best("ring", "good"), [])
        self.assertNotIn("Shaded", self.draw("rules.py", "rules.svg").decode())

    def test_the_figure_says_what_was_measured(self):
        self.make_study()
        self.assert_says("4 paired repetitions", "my-rule", "radio: good", "overconfident")

    def test_absurd_claims_and_indefinite_beliefs_are_told(self):
        def change(rule, repetition, t, agent, name, value):
            if agent < 0 or name != "claimed_sigma_m":
                return value
            return 1e-9 if rule == "naive" else None if rule == "my-rule" else value

        self.make_study(change)
        self.assert_says("claims 1.0×10⁻⁹", "no claim: indefinite")


if __name__ == "__main__":
    unittest.main()
