"""Tests of the figures of certainty grids: their numbers against those worked out by hand, what they
say, and what they refuse."""

import math
import unittest

import numpy as np

from grid_study import STUDY, WithGrids  # first: it makes the scripts known

import data
import grid_choice
import grid_levels
import grid_time
import panels
import regions
import roc
import stats
import style
import world


class Places(WithGrids):
    def test_threefry_gives_the_published_answers(self):
        ones = 2**64 - 1
        self.assertEqual(world.threefry((0, 0), (0, 0)), (0xF167B032C3B480BD, 0xE91F9FEE4B7A6FB5))
        self.assertEqual(world.threefry((ones, ones), (ones, ones)), (0xCCDEC5C917A874B1, 0x4DF53ABCA26CEB01))
        self.assertEqual(
            world.threefry((0x243F6A8885A308D3, 0x13198A2E03707344), (0xA4093822299F31D0, 0x082EFA98EC4E6C89)),
            (0xC3AAC71561042993, 0x3FE7AE8801AFF316),
        )
        self.assertEqual(world.purpose("foobar"), 0x85944171F73967E8)

    def test_a_target_without_a_position_is_drawn_in_the_area_by_seed_and_number(self):
        def place(seed, number):
            return world.drawn_place(seed, number, 40, 20, 5.0, np.array([100.0, 0.0]))

        places = np.array([place(seed, number) for seed in range(1, 41) for number in range(5)])
        self.assertTrue((places >= [100.0, 0.0]).all() and (places < [300.0, 100.0]).all())
        self.assertEqual(len(np.unique(places[:, 0])), 200)
        np.testing.assert_allclose(places.mean(axis=0), [200.0, 50.0], atol=15.0)

    def test_drawn_places_are_those_of_the_simulator(self):
        """The cells that the central grid of a run of seed 1 ended sure of, of 40 × 40 of 5 m."""
        places = [world.drawn_place(1, number, 40, 40, 5.0, np.zeros(2)) for number in range(5)]
        cells = sorted((int(x // 5.0), int(y // 5.0)) for x, y in places)
        self.assertEqual(cells, [(1, 12), (4, 26), (21, 32), (28, 5), (35, 21)])

    def test_what_a_study_sets_is_laid_over_the_scenario(self):
        tree = {"world": {"targets": [{"name": "a"}, {"name": "b"}]}}
        world.lay(tree, "world.targets[1].position_m", [1.0, 2.0])
        world.lay(tree, "world.targets.kind", "fire")
        world.lay(tree, "world.area.cell_m", 3.0)
        a, b = tree["world"]["targets"]
        self.assertEqual((a, b["position_m"], b["kind"]), ({"name": "a", "kind": "fire"}, [1.0, 2.0], "fire"))
        self.assertEqual(tree["world"]["area"], {"cell_m": 3.0})

    def test_the_world_of_a_run_is_that_of_its_cell(self):
        self.make_grids(study=STUDY.replace("2.0 } }] }", "1.0 } }] }"), talks=(5, 20))
        chosen = self.chosen()
        sizes = {}
        for talk in ("5", "20"):
            cell = chosen.cell(rule="none", talk=talk)
            found = world.read(chosen, cell, chosen.run(cell, 1))
            sizes[talk] = found.cell_m
        self.assertEqual(sizes, {"5": 2.0, "20": 1.0})
        self.assertEqual(found.targets_m.tolist(), [[13.0, 3.5], [100.0, 0.5]])
        self.assertEqual(world.seed_of(chosen, 1), 2**64 - 1)  # stored as -1

    def test_a_cell_has_its_lower_sides_and_nothing_outside_counts(self):
        targets = np.array([[10.0, 0.0], [12.0, 2.0], [17.999, 5.999], [18.0, 1.0], [9.999, 1.0]])
        truth = world.World("", 4, 3, 2.0, np.array([10.0, 0.0]), targets).truth()
        self.assertEqual(np.argwhere(truth).tolist(), [[0, 0], [1, 1], [2, 3]])


class Alarms(unittest.TestCase):
    centres = np.arange(5) + 0.5, np.arange(4) + 0.5

    def test_corners_hang_together_and_means_are_weighed(self):
        p = np.zeros((4, 5))
        p[0, 0], p[1, 1], p[3, 4] = 0.9, 0.6, 0.8
        first, second = regions.find(p, 0.5, self.centres)
        self.assertEqual(sorted(first.cells), [(0, 0), (1, 1)])
        np.testing.assert_allclose(first.position_m, [0.5 + 0.4, 0.5 + 0.4])
        np.testing.assert_allclose(first.covariance_m2, np.full((2, 2), 0.24))  # 0.6 · 0.4
        np.testing.assert_allclose(first.with_extent(1.0), np.full((2, 2), 0.24) + np.eye(2) / 12.0)
        np.testing.assert_allclose(second.position_m, [4.5, 3.5])
        np.testing.assert_allclose(second.covariance_m2, np.zeros((2, 2)), atol=1e-12)

    def test_a_cell_at_the_threshold_or_without_a_value_raises_no_alarm(self):
        self.assertEqual(regions.find(np.array([[0.5, np.nan]]), 0.5, self.centres), [])

    def test_the_ellipse_lies_along_the_region(self):
        found = regions.find(np.array([[0.9, 0.9, 0.9]]), 0.5, self.centres)[0]
        drawn = regions.ellipse(found, 1.0)
        sides = sorted([drawn.width, drawn.height])
        np.testing.assert_allclose(sides, [4.0 * math.sqrt(1 / 12), 4.0 * math.sqrt(2 / 3 + 1 / 12)])


class Maps(WithGrids):
    def test_the_figure_says_whose_grid_it_is_and_how_many_alarms_it_has(self):
        self.make_grids()
        said = self.said("grid_map.py")
        for text in ("none", "naive", "uav2", "Grid of uav1", "4 × 3 cells of 2 m"):
            self.assertIn(text, said)
        self.assertEqual(said.count("1 alarm "), 2)  # corner cells touch: one region
        low = self.draw("grid_map.py", "low.svg", "--threshold", "0.5", "--agent", "central").decode()
        self.assertEqual(low.count(">2 alarms<"), 2)

    def test_beta_grids_have_three_panels(self):
        self.make_grids()
        said = self.said("grid_map.py", "--layers", "beta", "--rules", "naive")
        for text in ("α: looks that saw one", "β: looks that saw none", "mean α/(α+β)"):
            self.assertIn(text, said)

    def test_targets_of_another_study_are_refused(self):
        self.make_grids(study=STUDY.replace("[100.0, 0.5]", "[11.0, 0.5]"))
        self.assertEqual(
            self.refused("grid_map.py", self.file, "x.png"),
            f"{self.path('area.toml')}: the targets are not those of the runs, by their cells_detected_share",
        )

    def test_an_area_of_another_size_is_refused(self):
        self.make_grids(study=STUDY.replace("[set]", '[set]\n"world.area.rows" = 4'))
        self.assertIn("an area of 4 × 4 cells, the run had 4 × 3", self.refused("grid_map.py", self.file, "x.png"))

    def test_runs_without_grids_files_and_repetitions_that_are_not_there_are_named(self):
        self.make_grids(leave_out=("cell_alpha",))
        self.assertIn("no cell_alpha (of Beta grids alone)",
                      self.refused("grid_map.py", self.file, "x.png", "--layers", "beta"))
        self.assertIn("no finished repetition 7; there are: 1 … 3",
                      self.refused("grid_map.py", self.file, "x.png", "--repetition", "7"))
        self.assertEqual(
            self.refused("grid_map.py", self.file, "x.png", "--study-file", "no.study.toml"),
            "no.study.toml: no such study file; name it with --study-file FILE",
        )
        self.assertIn("no agent 'uav9'", self.refused("grid_map.py", self.file, "x.png", "--agent", "uav9"))
        self.assertIn("axis rule has no 'odd'; it has: none, naive",
                      self.refused("grid_map.py", self.file, "x.png", "--rules", "odd"))


class OverTime(WithGrids):
    def test_a_line_is_the_mean_of_a_vehicle_and_the_band_that_of_all(self):
        self.make_grids()
        metrics = ["kl_to_central_nats", "disagreement_probability"]
        found = grid_time.Developments(self.chosen(), "rule", ["none", "naive"], metrics, "0.8")
        np.testing.assert_allclose(found.of_vehicle("kl_to_central_nats", "naive", 1), [0.0, 30.0])
        of_all = found.of_all("kl_to_central_nats", "naive")
        np.testing.assert_allclose(of_all.value, [0.0, 25.0])
        self.assertTrue(15.0 <= of_all.low[1] < 25.0 < of_all.high[1] <= 35.0)
        np.testing.assert_allclose(found.of_all("disagreement_probability", "none").value, [0.0, 0.1])

    def test_the_figure_names_axes_and_says_which_are_logarithmic(self):
        self.make_grids()
        said = self.said("grid_time.py")
        for text in ("naive", "uav2", "of the fleet", "3 paired repetitions", "Axes are linear"):
            self.assertIn(text, said)

    def test_values_over_decades_are_logarithmic_unless_some_are_negative(self):
        self.assertTrue(panels.wants_log(np.array([0.0, 0.01, 0.1, 9.0])))
        self.assertFalse(panels.wants_log(np.array([-0.01, 0.01, 0.1, 9.0])))
        self.assertFalse(panels.wants_log(np.array([1.0, 2.0, 9.0])))
        self.assertFalse(panels.wants_log(np.array([0.0])))

    def test_a_threshold_that_was_not_recorded_is_named(self):
        self.make_grids()
        self.assertEqual(
            self.refused("grid_time.py", self.file, "x.png", "--metrics", "cells_false_share", "--threshold", "0.7"),
            "cells_false_share was not recorded for threshold 0.7, but for 0.5, 0.8, 0.95",
        )


class OperatingCurves(WithGrids):
    def test_shares_are_means_over_vehicles_and_repetitions(self):
        self.make_grids(talks=(20,))
        curves = roc.Curves(self.chosen(), "rule", ["none", "naive"])
        self.assertEqual(curves.thresholds, ["0.5", "0.8", "0.95"])
        np.testing.assert_allclose(curves.of(roc.DETECTED, "naive")[0], [1.0, 1.0, 0.0])
        value, low, high = curves.of(roc.FALSE, "naive")
        np.testing.assert_allclose(value, np.array([2.0, 1.0, 0.0]) / 11.0 * 2.0 / 3.0)
        np.testing.assert_allclose(low, 0.0)
        np.testing.assert_allclose(high, np.array([2.0, 1.0, 0.0]) / 11.0)
        np.testing.assert_allclose(curves.central(roc.FALSE), np.array([1.0, 0.0, 0.0]) / 11.0 * 2.0 / 3.0)

    def test_zero_has_a_place_of_its_own_on_a_logarithmic_axis(self):
        axis = roc.Axis(np.array([0.0, 1e-4, 0.1]))
        self.assertTrue(axis.log and axis.has_zero)
        placed = axis.at(np.array([0.0, 1e-4, 0.1]))
        np.testing.assert_allclose(placed[1:], [1e-4, 0.1])
        self.assertTrue(axis.low < placed[0] < 1e-4 / 2.0)
        linear = roc.Axis(np.array([0.0, 0.1, 0.2]))
        self.assertFalse(linear.log)
        np.testing.assert_allclose(linear.at(np.array([0.0, 0.1])), [0.0, 0.1])

    def test_the_figure_draws_all_rules_and_is_the_same_twice(self):
        self.make_grids()
        said = self.said("roc.py")
        for text in ("naive", "central grid", "False alarms at each threshold", "from 0.5 to 0.95"):
            self.assertIn(text, said)

    def test_one_threshold_makes_no_curve(self):
        self.make_grids()
        connection = data.sqlite3.connect(self.file)
        connection.execute("DELETE FROM series WHERE name LIKE 'cells_%' AND subject <> '0.8'")
        connection.commit()
        connection.close()
        self.assertIn("needs several record.alarms.thresholds, found ['0.8']",
                      self.refused("roc.py", self.file, "x.png"))


class Levels(WithGrids):
    def levels(self, metric, **options):
        self.make_grids(talks=(20, 5), **options)
        chosen = self.chosen()
        return grid_levels.Levels(chosen, "talk", None, "rule", ["none", "naive"],
                                  [grid_levels.Metric(chosen, metric, "0.5")])

    def test_numbers_stand_in_their_order_and_values_are_means(self):
        levels = self.levels("cells_false_share")
        self.assertEqual(levels.levels, ["5", "20"])
        metric = levels.metrics[0]
        value, low, high = levels.curve(metric, None, "naive")
        np.testing.assert_allclose(value, np.array([2.0, 4.0 / 3.0]) / 11.0)
        np.testing.assert_allclose((low[0], high[0], low[1], high[1]), np.array([2.0, 2.0, 0.0, 2.0]) / 11.0)
        np.testing.assert_allclose(levels.central(metric, None), np.array([1.0, 2.0 / 3.0]) / 11.0)

    def test_who_hears_nobody_is_run_once_for_all_levels(self):
        levels = self.levels("bytes_sent", skip=(("none", 20),))
        np.testing.assert_allclose(levels.curve(levels.metrics[0], None, "none")[0], [0.0, 0.0])  # kB
        np.testing.assert_allclose(levels.curve(levels.metrics[0], None, "naive")[0], [0.3, 0.3])

    def test_times_are_medians_that_count_who_never_gets_there(self):
        levels = self.levels("alarms_found_s")  # 4 and 6, 8 and never, never twice
        value, low, high = levels.curve(levels.metrics[0], None, "naive")
        self.assertEqual((value[0], low[0], high[0]), (8.0, 4.0, np.inf))
        axis = grid_levels.ValueAxis(np.array([4.0, 8.0, np.inf]))
        self.assertTrue(axis.ceiling < axis.at(np.array([np.inf]))[0] < axis.high)

    def test_the_median_of_infinite_and_missing_values(self):
        self.assertEqual(stats.median_interval(np.array([[1.0], [np.inf], [3.0]]))[0], 3.0)
        self.assertEqual(stats.median_interval(np.array([[np.inf], [np.inf], [3.0]]))[0], np.inf)
        self.assertEqual(stats.median_interval(np.array([[1.0, np.nan], [2.0, 5.0]]))[0], 2.0)
        self.assertTrue(math.isnan(stats.median_interval(np.array([[np.nan]]))[0]))

    def test_the_figure_has_a_row_a_metric_and_is_the_same_twice(self):
        self.make_grids(talks=(5, 20))
        options = ("--over", "talk", "--metrics", "cells_false_share;bytes_sent;alarms_found_s", "--threshold", "0.5")
        said = self.said("grid_levels.py", *options)
        for text in ("naive", "central grid", "kB a", "all targets", "never", "medians", "3 paired repetitions"):
            self.assertIn(text, said)

    def test_mistakes_are_named(self):
        self.make_grids(talks=(5, 20))
        self.assertEqual(
            self.refused("grid_levels.py", self.file, "x.png", "--over", "talk", "--metrics", "odd"),
            "no series or scalar 'odd' in these runs of 'grids'",
        )
        self.assertIn("one axis twice", self.refused("grid_levels.py", self.file, "x.png", "--over", "rule"))
        self.assertIn("choose one talk", self.refused("roc.py", self.file, "x.png"))


class Choices(WithGrids):
    def lines(self, limit, talks=(5,)):
        self.make_grids(talks=talks)
        chosen = self.chosen()
        return grid_choice.lines_of(chosen, "rule", ["none", "naive"], ["talk"], limit)

    def test_of_each_rule_the_threshold_that_detects_most_within_the_limit(self):
        # Beside the target one empty cell of eleven has 0.6 under none, a second one 0.85 under naive.
        [(place, choices)] = self.lines(0.05)
        self.assertEqual(place, ("5",))
        self.assertEqual((choices["none"].value, choices["none"].threshold, choices["none"].false), (1.0, "0.8", 0.0))
        self.assertEqual((choices["naive"].value, choices["naive"].threshold), (0.0, "0.95"))

    def test_a_looser_limit_lets_more_through(self):
        [(_, choices)] = self.lines(0.1)
        self.assertEqual((choices["naive"].value, choices["naive"].threshold), (1.0, "0.8"))
        self.assertAlmostEqual(choices["naive"].false, 1 / 11)

    def test_a_limit_that_no_threshold_keeps_leaves_a_dash(self):
        [(_, choices)] = self.lines(-1.0)
        self.assertEqual(choices["none"].text(False), "–")

    def test_the_table_and_its_numbers(self):
        self.make_grids(talks=(5, 20))
        self.draw("grid_choice.py", "t.md", "--false", "0.05", "--rows", "talk")
        with open(self.path("t.md"), encoding="utf-8") as stream:
            text = stream.read()
        self.assertIn("| talk | none | naive |", text)
        self.assertIn("| 5 | **1.00** (1.00…1.00) at 0.8 | 0.00 (0.00…0.00) at 0.95 |", text)
        with open(self.path("t.csv"), encoding="utf-8") as stream:
            rows = stream.read().splitlines()
        self.assertEqual(rows[0], "talk,rule,p_detect,low,high,p_false,threshold")
        self.assertEqual(len(rows), 5)

    def test_mistakes_are_named(self):
        self.make_grids()
        self.assertIn("a table ends with .md or .csv", self.refused("grid_choice.py", self.file, "t.png"))
        self.assertIn("colour", self.refused("grid_choice.py", self.file, "t.md", "--rows", "colour"))


class Looks(unittest.TestCase):
    def test_no_two_rules_of_grids_look_the_same(self):
        rules = ["none", "naive", "channel", "channel-robust", "maximum", "strongest", "dictatorship",
                 "geometric-mean", "linear-pool", "elementwise-maximum", "averaged-parameters"]
        self.assertEqual(len({style.rule_style(rule, rules) for rule in rules}), len(rules))
        for kind in (rules[:9], rules[:4] + ["dictatorship"] + rules[9:]):
            looks = {(style.rule_style(rule, rules)[0], style.rule_dash(rule)) for rule in kind}
            self.assertEqual(len(looks), len(kind))


if __name__ == "__main__":
    unittest.main()
