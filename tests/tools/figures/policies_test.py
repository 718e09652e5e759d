"""Tests of the figure of rumour/policies: its numbers against those worked out by hand."""

import math
import unittest

from small_study import T_S, WithDatabase, make_database  # first: it makes the scripts known

import data
import policies


class Policies(WithDatabase):
    def make_study(self):
        """The small study with its axes renamed; agent a sent 100·(a + 1) bytes, the central filter none."""
        connection = make_database(self.file)
        for old, new in (("rule", "content"), ("topology", "policy"), ("loss", "radio")):
            connection.execute("UPDATE axis SET name = ? WHERE name = ?", (new, old))
        connection.execute("UPDATE axis SET value = 'every 1 s' WHERE value = 'line'")
        connection.execute("UPDATE axis SET value = 'on update' WHERE value = 'ring'")
        connection.execute(
            "INSERT INTO scalar SELECT run, agent, 'bytes_sent', 100.0 * (agent + 1) FROM scalar"
            " WHERE name = 'distance_error_m'"
        )
        connection.commit()
        connection.close()

    def price(self):
        database = data.Database(self.file)
        return policies.Price(database.select(database.study(None), {}))

    def test_a_point_has_the_bytes_of_the_agents_and_errors_over_time(self):
        self.make_study()
        price = self.price()
        self.assertEqual(price.policies, ["every 1 s", "on update"])
        sent, error, low, high, claimed = price.of("on update", "naive", price.radios[0])
        self.assertAlmostEqual(sent, 150.0)
        squares = [r * r for r in (1, 2, 3, 4)] + [r * r for r in (2, 3, 4, 5)]
        later = [sum(squares) / 8 / (1.0 + t) ** 2 for t in T_S[1:]]
        self.assertAlmostEqual(error, math.sqrt(sum(later) / len(later)), places=12)
        self.assertTrue(low < error < high)
        self.assertGreater(claimed, 0.0)
        self.assertTrue(math.isnan(price.of("never", "naive", price.radios[0])[0]))

    def test_the_figure_says_what_is_in_it(self):
        self.make_study()
        drawn = self.draw("policies.py", "policies.svg").decode()
        for text in ("4 paired repetitions", "says: my-rule", "on news", "bytes an agent sent"):
            self.assertIn(text, drawn)

    def test_another_study_is_refused(self):
        make_database(self.file).close()
        self.assertIn("choose one topology", self.refused("policies.py", self.file, self.path("policies.svg")))


if __name__ == "__main__":
    unittest.main()
