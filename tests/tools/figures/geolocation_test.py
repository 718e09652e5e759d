"""Tests of the figure of merino/ch3-geolocation: its numbers against those worked out by hand."""

import math
import unittest

from radio_study import make_radio_database  # first: it makes the scripts known
from small_study import WithDatabase

import data
import geolocation

ANGLES = (80, 0, 60)  # not in order: the figure sorts


class Geolocation(WithDatabase):
    def make_study(self, ways=("unscented", "linearised", "monte-carlo")):
        cells = [
            (
                {"angle_deg": angle, "propagation": way},
                {
                    (0, "look_sigma_along_m"): (1.0 + angle) * factor,
                    (0, "look_sigma_across_m"): 1.0,
                    (0, "look_kl_nats"): 1e-3 * factor,
                },
            )
            for angle in ANGLES
            for way, factor in zip(ways, (1.0, 0.9, 1.1))
        ]
        make_radio_database(self.file, "geolocation", cells, ("camera",))

    def test_values_stand_at_their_angle_and_propagation(self):
        self.make_study()
        database = data.Database(self.file)
        chosen = database.select(database.study(None), {})
        values = geolocation.Scalars(chosen, ["0", "60"]).of("look_sigma_along_m", "linearised")
        self.assertEqual(values.shape, (2, 3))
        for row, sigma in zip(values, (1.0, 61.0)):
            for value, factor in zip(row, (0.99, 1.0, 1.01)):
                self.assertTrue(math.isclose(value, 0.9 * sigma * factor))

    def test_the_figure_says_what_was_measured(self):
        self.make_study()
        text = self.draw("geolocation.py", "a.svg").decode()
        for said in ("along the view", "linearised", "unscented, κ = −5", "3\u00a0repetitions"):
            self.assertIn(said, text)

    def test_without_monte_carlo_there_is_nothing_to_compare_with(self):
        self.make_study(ways=("unscented", "linearised"))
        self.assertEqual(
            self.refused("geolocation.py", "small.db", "x.png"),
            "small.db: no runs with propagation 'monte-carlo'",
        )


if __name__ == "__main__":
    unittest.main()
