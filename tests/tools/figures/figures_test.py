"""Tests of tools/figures: the statistics against published values, the curves and tables against
numbers worked out by hand, the figures for what they say."""

import csv
import math
import os
import unittest

import numpy as np

from small_study import T_S, WithDatabase, make_database  # first: it makes the scripts known

import data
import panels
import stats
import style


class Statistics(unittest.TestCase):
    def test_chi2_quantiles_are_those_of_the_tables(self):
        for p, degrees, x in (
            (0.95, 1, 3.841458820694124),
            (0.95, 2, -2.0 * math.log(0.05)),
            (0.025, 10, 3.2469727802368413),
            (0.975, 100, 129.56119718583660),
            (0.5, 2, 2.0 * math.log(2.0)),
        ):
            self.assertAlmostEqual(stats.chi2_quantile(p, degrees), x, delta=1e-9 * x)

    def test_the_band_of_anees_is_the_published_one(self):
        for n, runs, low, high in (
            (2, 50, 0.7422, 1.2956),
            (4, 50, 0.8136, 1.2053),
            (4, 100, 0.8662, 1.1433),
        ):
            band = stats.anees_band(n, runs)
            self.assertAlmostEqual(band[0], low, delta=5e-5)
            self.assertAlmostEqual(band[1], high, delta=5e-5)
        self.assertAlmostEqual(stats.anees_band(2, 100)[1], 1.205, delta=5e-4)
        self.assertAlmostEqual(stats.anees_band(2, 100, 120)[1], 1.4, delta=0.02)

    def test_the_bootstrap_of_equal_values_has_no_width(self):
        low, high = stats.ratio_interval(np.full((10, 2), 3.0), np.full((10, 2), 2.0))
        np.testing.assert_allclose([low, high], 1.5, rtol=1e-14)

    def test_the_bootstrap_of_many_values_is_near_the_normal_interval(self):
        values = np.random.Generator(np.random.PCG64(5)).normal(3.0, 1.0, (400, 1))
        low, high = stats.ratio_interval(values, np.ones((400, 1)))
        half = 1.96 * values.std() / 20.0
        self.assertAlmostEqual(low[0], values.mean() - half, delta=0.12 * half)
        self.assertAlmostEqual(high[0], values.mean() + half, delta=0.12 * half)

    def test_one_repetition_gives_no_interval(self):
        low, high = stats.ratio_interval(np.ones((1, 3)), np.ones((1, 3)))
        self.assertTrue(np.isnan(low).all() and np.isnan(high).all())


class Numbers(unittest.TestCase):
    def test_numbers_are_written_for_readers(self):
        self.assertEqual(style.number(1.64e-11), "1.6×10⁻¹¹")
        self.assertEqual(style.number(0.224), "0.22")
        self.assertEqual(style.number(2861.0), "2861")
        self.assertEqual(style.number(float("nan")), "–")
        self.assertEqual(style.plain_number(0.2204), "0.220")
        self.assertEqual(style.plain_number(31.42), "31.4")
        self.assertEqual(style.plain_number(1.6e-11), "1.60e-11")
        self.assertEqual(data.label_text("0.0"), data.label_text("0"))
        self.assertEqual(data.label_text('"ring"'), "ring")


class Curves(WithDatabase):
    def test_error_is_the_root_of_the_mean_square_over_repetitions_and_agents(self):
        self.make()
        chosen = self.chosen(loss="0")
        error = chosen.series(["rms_error_m"])["rms_error_m"]
        self.assertEqual(list(error.t_s), list(T_S))
        cell = chosen.cell(topology="ring", rule="none")
        curve = panels.rms(error, cell, interval=True)
        squares = [r * r for r in (1, 2, 3, 4)] + [r * r for r in (2, 3, 4, 5)]
        self.assertAlmostEqual(curve.value[0], math.sqrt(sum(squares) / 8), places=12)
        self.assertAlmostEqual(curve.value[1], math.sqrt(sum(squares) / 8) / 11.0, places=12)
        self.assertTrue((curve.low < curve.value).all() and (curve.value < curve.high).all())
        central = panels.rms(error, cell, "central")
        self.assertAlmostEqual(central.value[0], math.sqrt((0 + 1 + 4 + 9) / 4), places=12)

    def test_anees_is_a_mean_an_agent_and_spans_them(self):
        self.make()
        chosen = self.chosen(loss="0")
        series = chosen.series(["nees", "claimed_sigma_m"])
        curve = panels.anees(
            series["nees"], series["claimed_sigma_m"], 0, chosen.state_dimension()
        )
        self.assertAlmostEqual(curve.value[0], 1.125)
        self.assertAlmostEqual(curve.low[0], 1.0)
        self.assertAlmostEqual(curve.high[0], 1.25)

    def test_the_nees_of_a_belief_without_claim_is_left_out_of_anees(self):
        def change(rule, repetition, t, agent, name, value):
            if agent == 1 and repetition < 3 and t == 10.0:
                return {"nees": -1e9, "claimed_sigma_m": None}.get(name, value)
            return value

        self.make(change=change)
        chosen = self.chosen(loss="0")
        series = chosen.series(["nees", "claimed_sigma_m"])
        curve = panels.anees(series["nees"], series["claimed_sigma_m"], 0, 2)
        np.testing.assert_allclose(curve.value, 1.125)
        np.testing.assert_allclose(curve.high, 1.25)
        self.assertEqual(list(curve.thinned), [False, True, False])

    def test_undefined_beliefs_are_left_out_and_marked_and_more_than_half_break_the_curve(self):
        def change(rule, repetition, t, agent, name, value):
            lost = {10.0: agent == 0, 20.0: agent == 0 or repetition == 1}.get(t, False)
            return None if lost and agent >= 0 and name == "rms_error_m" else value

        self.make(change=change)
        curve = panels.rms(self.chosen(loss="0").series(["rms_error_m"])["rms_error_m"], 0)
        self.assertEqual(list(curve.thinned), [False, True, False])
        self.assertAlmostEqual(curve.value[1], math.sqrt((4 + 9 + 16 + 25) / 4) / 11.0, places=12)
        self.assertTrue(math.isnan(curve.value[2]))

    def test_many_subjects_count_like_as_many_repetitions(self):
        self.make(subjects=("a", "b", "c"))
        error = self.chosen(loss="0").series(["rms_error_m"])["rms_error_m"]
        self.assertEqual(error.asked.max(), 3.0)
        squares = [r * r for r in (1, 2, 3, 4)] + [r * r for r in (2, 3, 4, 5)]
        self.assertAlmostEqual(panels.rms(error, 0).value[0], math.sqrt(sum(squares) / 8))

    def test_failed_runs_are_left_out_and_counted(self):
        connection = make_database(self.file)
        connection.execute("UPDATE run SET status = 'failed' WHERE id IN (1, 2)")
        connection.commit()
        chosen = self.chosen(loss="0")
        self.assertEqual(chosen.failed, 2)
        error = chosen.series(["rms_error_m"])["rms_error_m"]
        self.assertAlmostEqual(panels.rms(error, 0).value[0], math.sqrt((9 + 16 + 16 + 25) / 4))


class Table(WithDatabase):
    def rows(self, *arguments):
        self.draw("table.py", "t.csv", *arguments)
        with open(self.path("t.csv"), encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def test_each_cell_has_a_line_and_the_central_filter_one_where_it_is_the_same(self):
        self.make()
        rows = self.rows()
        self.assertEqual(len(rows), 2 * 3 * 2 + 2)  # here the central filter depends on the rule
        first = rows[0]
        self.assertEqual([first[a] for a in ("topology", "rule", "loss")], ["line", "none", "0"])
        self.assertAlmostEqual(float(first["rms_error_m"]), math.sqrt(84 / 8) / 21.0, places=8)
        self.assertAlmostEqual(float(first["claimed_sigma_m"]), 2.0 / 21.0, places=8)
        self.assertAlmostEqual(float(first["ledger_sigma_m"]), 2.5 / 21.0, places=8)
        self.assertAlmostEqual(float(first["anees"]), 1.125)
        self.assertAlmostEqual(float(first["multiplicity"]), 1.0)
        self.assertAlmostEqual(float(first["distance_m"]), 0.25)
        self.assertEqual(rows[-2]["rule"], "central")
        self.assertEqual(rows[-2]["topology"], "all")

    def test_markdown_says_once_what_is_the_same_in_all_lines(self):
        self.make()
        text = self.draw("table.py", "t.md", "--loss", "0.3").decode()
        lines = text.splitlines()
        self.assertEqual(lines[0], "**small** at the end of the runs, 4 repetitions, loss 0.3")
        self.assertIn("| topology | rule    |", lines[2])
        self.assertNotIn("loss", lines[2])
        self.assertTrue(lines[4].startswith("| line     | none    | 0.154 (0."), lines[4])
        self.assertTrue(os.path.exists(self.path("t.csv")))

    def test_without_anees_the_distance_stands_for_the_error(self):
        self.make(series=("rms_error_m", "claimed_sigma_m"))
        text = self.draw("table.py", "t.md", "--loss", "0.3").decode()
        self.assertIn("distance to truth [m]", text)
        self.assertNotIn("true error", text)
        self.assertIn("| line     | none    | 0.250 ", text)

    def test_undefined_beliefs_are_told(self):
        def change(rule, repetition, t, agent, name, value):
            return None if rule == "my-rule" and agent == 0 and name != "nees" else value

        self.make(change=change)
        by_rule = {row["rule"]: row for row in self.rows("--loss", "0.3", "--topology", "ring")}
        self.assertEqual(float(by_rule["my-rule"]["undefined_share"]), 0.5)
        self.assertEqual(float(by_rule["none"]["undefined_share"]), 0.0)


class Figures(WithDatabase):
    def test_the_same_database_gives_the_same_bytes_in_every_format(self):
        self.make()
        for ending, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
            first = self.draw("rumour.py", "a." + ending, "--loss", "0.3")
            self.assertTrue(first.startswith(start))
            self.assertEqual(first, self.draw("rumour.py", "b." + ending, "--loss", "0.3"))
        self.assertEqual([f for f in os.listdir(self.directory) if "partial" in f], [])

    def test_the_figure_of_the_logs_takes_all_rates_of_loss(self):
        recorded = ("rms_error_m", "claimed_sigma_m", "multiplicity_mean")
        self.make(subjects=("6", "7"), series=recorded)
        text = self.draw("mrclam.py", "a.svg").decode()
        for said in ("2 robots, 2 landmarks", "30 % loss", "correlated in time", "my-rule"):
            self.assertIn(said, text)
        self.assertNotIn("ANEES", text)

    def test_a_figure_with_gaps_indefinite_beliefs_and_absurd_errors_is_drawn(self):
        def change(rule, repetition, t, agent, name, value):
            if rule == "my-rule" and t > 0 and agent >= 0:
                return None
            return value * 1e9 if rule == "naive" and name == "rms_error_m" and t > 10 else value

        self.make(change=change)
        text = self.draw("rumour.py", "a.svg", "--loss", "0.3").decode()
        for said in ("100 % of beliefs", "indefinite at the end", "4 paired repetitions"):
            self.assertIn(said, text)

    def mule(self):
        """The small study as one over services, of agents b0 and c0."""
        connection = make_database(self.file)
        connection.execute("UPDATE axis SET name = 'service' WHERE name = 'topology'")
        connection.execute("CREATE TABLE agent(run, id, name)")
        for row in ((-1, "central"), (0, "c0"), (1, "b0")):
            connection.execute("INSERT INTO agent SELECT id, ?, ? FROM run", row)
        connection.commit()
        connection.close()

    def test_the_figure_of_the_mule_shows_one_group(self):
        self.mule()
        arguments = ("--loss", "0.3", "--visits", "3-5,12-13", "--measured", "20")
        text = self.draw("mule.py", "a.svg", *arguments).decode()
        for said in ("my-rule, ring", "the mule is there", "1 agent and 4 paired repetitions"):
            self.assertIn(said, text)
        # √((2² + 3² + 4² + 5²)/4)/21 of agent 1, whose error is (repetition + 1)/(1 + t).
        self.assertIn(f"error {math.sqrt(54 / 4) / 21:.2g} m", text)

    def test_the_figure_of_the_mule_refuses_what_is_not_there(self):
        self.mule()
        where = (self.file, "a.svg", "--loss", "0.3")
        self.assertIn("no agent's name begins with 'x'; there are: c0, b0",
                      self.refused("mule.py", *where, "--group", "x"))
        self.assertIn("expected spans in seconds", self.refused("mule.py", *where, "--visits", "9"))

    def test_the_caption_says_what_was_chosen(self):
        self.make()
        text = self.draw("rumour.py", "a.svg", "--loss", "0.3").decode()
        self.assertIn("30 % loss", text)


if __name__ == "__main__":
    unittest.main()
