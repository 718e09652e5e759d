"""Tests of the figures of foragers: their numbers against those worked out by hand, what they say, and what they
refuse."""

import math
import os
import types
import unittest

import matplotlib.image
import numpy as np

from lost_study import SCENARIO, WithForagers  # first: it makes the scripts known

import crumbs_map
import data
import floors
import grid_levels
import style
import throughput
import trail_lengths
import trails_map
import trips


class Floors(WithForagers):
    def floor(self, **where):
        chosen = self.chosen(**where)
        return floors.read(chosen, 0)

    def test_the_first_line_of_a_drawing_is_at_the_top_and_places_are_in_the_middle_of_their_cells(self):
        self.make_foragers()
        floor = self.floor(method="plain", robots="1")
        self.assertEqual(floor.size_m, (12.0, 6.0))
        self.assertEqual(floor.walls.astype(int).tolist(), [[1, 0, 1, 1, 1, 1], [1, 0, 0, 0, 0, 1], [1] * 6])
        self.assertEqual(floor.places, {"A": (3.0, 3.0), "B": (9.0, 3.0), "dock": (3.0, 1.0)})

    def test_the_scenario_says_what_is_closed_and_where_an_event_moves(self):
        self.make_foragers()
        floor = self.floor(method="plain", robots="1")
        [barrier] = floor.barriers
        self.assertEqual((*barrier.low_m, *barrier.high_m), (4.0, 2.0, 6.0, 4.0))
        self.assertEqual((barrier.from_s, barrier.until_s), (50.0, math.inf))
        self.assertEqual((floor.place_of("B", 69.0), floor.place_of("B", 70.0)), ((9.0, 3.0), (3.0, 1.0)))
        self.assertEqual(floor.starts, ("A",))

    def test_parameter_sets_fill_what_the_scenario_leaves_open_and_the_study_lies_over_both(self):
        self.make_foragers()
        plain, search = (self.floor(method=m, robots="1").trails for m in ("plain", "search"))
        self.assertEqual(plain, {"laying": "at-once", "distance": "time", "age_max_s": 240.0})
        self.assertEqual(search["laying"], "completed")
        self.assertEqual(self.floor(method="search", robots="1").barriers, [])

    def test_dark_pixels_of_a_bitmap_are_walls(self):
        pixels = np.ones((2, 3, 4))
        pixels[0, 0, :3] = 0.0  # black, upper left
        pixels[1, 2] = [0.0, 0.0, 0.0, 0.0]  # black, but transparent
        pixels[1, 1, :3] = [1.0, 0.0, 0.0]  # red is dark
        matplotlib.image.imsave(self.path("floor.png"), pixels)
        walls, places = floors.read_bitmap(self.path("floor.png"), 128)
        self.assertEqual((walls.astype(int).tolist(), places), ([[0, 1, 0], [1, 0, 0]], {}))

    def test_files_that_are_not_there_or_say_nothing_of_a_plan_are_named(self):
        self.make_foragers(scenario=SCENARIO.replace("floor.txt", "hall.txt"))
        self.assertEqual(self.refused("trails_map.py", self.file, "x.png", "--by", "method", "--robots", "2"),
                         f"{self.path('hall.txt')}: no such plan, which {self.path('floor.toml')} names")

    def test_a_scenario_without_a_plan_or_with_lines_of_two_lengths_is_refused(self):
        self.make_foragers(scenario="duration_s = 5\n", floor="###\n#\n")
        where = ("--method", "plain", "--robots", "2")
        self.assertIn("says nothing of a plan", self.refused("trails_map.py", self.file, "x.png", *where))
        with open(self.path("floor.toml"), "w", encoding="utf-8") as stream:
            stream.write(SCENARIO)
        self.assertIn("a plan has lines of one length", self.refused("trails_map.py", self.file, "x.png", *where))


class Trips(WithForagers):
    def run_of(self, repetition=1, **where):
        self.make_foragers()
        chosen = self.chosen(**where)
        return trails_map.Run(chosen, 0, repetition, None)

    def test_a_way_lies_between_its_instants_and_is_cut_where_a_robot_was_carried(self):
        run = self.run_of(method="search", robots="1")
        t, x, _ = run.ways.between(0, 20.0, 40.0)
        self.assertEqual((t[0], t[-1], x[0], x[-1]), (20.0, 37.5, 3.0, 3.0 + 6.0 * 17.5 / 20.0))
        self.assertFalse(np.isnan(x).any())

    def test_robots_count_for_themselves_and_the_cut_off_trip_stands_for_what_never_came(self):
        run = self.run_of(3, method="plain", robots="2")  # nobody has a third trip

        def shown(number, last, count):
            return [(t.agent, t.number, age) for t, age in trails_map.of_iteration(run, number, last, count)]

        self.assertEqual(shown(2, 5, "robot"), [(0, 1, 1), (0, 2, 0), (1, 1, 1), (1, 2, 0)])
        self.assertEqual(shown(2, 1, "robot"), [(0, 2, 0), (1, 2, 0)])
        self.assertEqual(shown(9, 2, "robot"), [(0, 2, 1), (0, 3, 0), (1, 2, 1), (1, 3, 0)])
        self.assertEqual(shown(3, 2, "team"), [(1, 1, 1), (0, 2, 0)])
        self.assertEqual(shown(9, 2, "team"), [(1, 2, 1), (0, 3, 0), (1, 3, 0)])

    def test_lengths_stand_above_the_panels(self):
        run = self.run_of(3, method="plain", robots="2")
        self.assertEqual(trails_map.length_title(run, 2, "robot"), "9, 19 m")
        self.assertEqual(trails_map.length_title(run, 3, "team"), "9 m")
        self.assertEqual(trails_map.length_title(run, 3, "robot"), "not reached in 4 trips of all")
        self.assertEqual(trails_map.instant_title(run, 45.0, 20.0), "2 trips, median 14 m")

    def test_the_figure_has_a_panel_an_iteration_or_an_instant(self):
        self.make_foragers()
        said = self.said("trails_map.py", "--by", "method", "--robots", "2", "--iterations", "1;4")
        for text in ("iteration 1", "iteration 4", "search", "7, 17 m", "2 robots", "Hatched"):
            self.assertIn(text, said)
        said = self.said("trails_map.py", "--method", "search", "--robots", "2", "--times", "30;80", "--window", "20")
        for text in ("80 s", "in the 20 s before", "on their way then"):
            self.assertIn(text, said)

    def test_mistakes_are_named(self):
        self.make_foragers(series=False)
        where = ("--method", "search", "--robots", "2")
        self.assertIn("no series 'robot_x_m' and 'robot_y_m'", self.refused("trails_map.py", self.file, "x.png", *where))
        for more, text in (
            (("--iterations", "1;x"), "--iterations: 'x' is no number"),
            (("--times", "0"), "--times: 0 is not above 0"),
            (("--times", "5", "--iterations", "1"), "give one of them"),
            (("--last", "0"), "--last and --window are above 0"),
        ):
            self.assertIn(text, self.refused("trails_map.py", self.file, "x.png", *where, *more))
        self.assertIn("choose one method", self.refused("trails_map.py", self.file, "x.png", "--robots", "1"))


class CrumbsOfATeam(WithForagers):
    def crumbs(self, at_s, method, event, **more):
        """The one kind of crumbs there is: laid by the first robot at 10, 30, 50 and 70 s, heading east."""
        self.make_foragers(**more.pop("study", {}))
        options = {"at": at_s, "age": None, "laying": None, "study_file": None, **more}
        run = crumbs_map.Run(self.chosen(method=method, robots="1"), 0, 1, types.SimpleNamespace(**options))
        return run.crumbs[event]

    def test_crumbs_told_at_once_lead_back_and_go_by_their_age(self):
        found = self.crumbs(60.0, "plain", "A", age=30.0)
        self.assertEqual(found.laid_s.tolist(), [30.0, 50.0])
        self.assertEqual(found.x.tolist(), [8.0, 9.0])
        np.testing.assert_allclose(np.cos(found.way), -1.0)

    def test_crumbs_of_completed_trails_lead_on_and_were_laid_d_before_they_were_told(self):
        found = self.crumbs(75.0, "search", "B", age=30.0)
        self.assertEqual((found.told_s.tolist(), found.laid_s.tolist()), ([60.0], [50.0]))
        np.testing.assert_allclose(np.cos(found.way), 1.0)

    def test_crumbs_live_for_so_many_arrivals_that_of_their_own_robot_included(self):
        # Arrivals at 20, 40 and 60 s: two since 30 s, one since 50 s.
        lives = SCENARIO + "trails = { life_arrivals = 2, parameters = \"thesis-2019-text\" }\n"
        self.assertEqual(self.crumbs(75.0, "search", "B", study={"scenario": lives}).laid_s.tolist(), [50.0])

    def test_of_the_crumbs_in_a_square_that_of_least_d_is_drawn(self):
        rows = [(1.0, 0.1, 0.1, 0.0, 5.0), (2.0, 0.9, 0.9, 0.0, 3.0), (3.0, 1.1, 0.1, 0.0, 4.0), (4.0, -0.1, 0.1, 0.0, 9.0)]
        found = crumbs_map.Crumbs(rows, "at-once")
        self.assertEqual(crumbs_map.thinned(found, 1.0).tolist(), [3, 2, 1])
        self.assertEqual(crumbs_map.thinned(found, 0.0).tolist(), [3, 0, 2, 1])

    def test_a_few_crumbs_of_lost_robots_do_not_take_all_shades(self):
        norm, beyond = crumbs_map.scale_of([np.linspace(0.0, 100.0, 200), np.array([900.0])])
        self.assertTrue(beyond and 90.0 < norm.vmax < 110.0)
        norm, beyond = crumbs_map.scale_of([np.linspace(0.0, 100.0, 200)])
        self.assertEqual((beyond, norm.vmax), (False, 100.0))
        self.assertEqual(crumbs_map.scale_of([])[0].vmax, 1.0)

    def test_the_figure_has_a_panel_an_event_and_says_how_they_are_read(self):
        self.make_foragers()
        said = self.said("crumbs_map.py", "--at", "60", "--method", "plain", "--robots", "1")
        for text in ("trail to A", "3 crumbs", "no older than 240 s", "against that of the robot", "d: still to go [s]",
                     "Hatched: closed then"):
            self.assertIn(text, said)
        said = self.said("crumbs_map.py", "--at", "80", "--by", "method", "--robots", "2", "--events", "B", "--age", "35")
        for text in ("search: trail to B", "plain: trail to B", "2 crumbs", "none",
                     "where trails are completed"):
            self.assertIn(text, said)

    def test_mistakes_are_named(self):
        self.make_foragers()
        where = ("--method", "plain", "--robots", "2")
        self.assertIn("no crumb was told by 5 s; it takes record.crumbs",
                      self.refused("crumbs_map.py", self.file, "x.png", "--at", "5", *where))
        self.assertIn("no crumb of 'Q' was told; there are: A",
                      self.refused("crumbs_map.py", self.file, "x.png", "--at", "50", "--events", "Q", *where))


class LengthsOfTrips(WithForagers):
    def lengths(self, method, count, robots="2"):
        if not os.path.exists(self.file):
            self.make_foragers()
        chosen = self.chosen(method=method, robots=robots)
        return trail_lengths.Lengths(chosen, trail_lengths.runs_of(chosen, 0), trips.of_runs(chosen), count)

    def test_quartiles_are_over_robots_and_runs_of_those_who_got_there(self):
        # Trip n of robot a in repetition r: 12 / n + r + 10 a; in the third repetition there are two trips.
        low, middle, high, there = self.lengths("plain", "robot").quartiles()
        np.testing.assert_allclose(middle[0], 12.0 + 0.5 * (3.0 + 11.0))
        np.testing.assert_allclose([low[2], middle[2], high[2]], np.quantile([5.0, 6.0, 15.0, 16.0], [0.25, 0.5, 0.75]))
        np.testing.assert_allclose(there, [1.0, 1.0, 2.0 / 3.0, 2.0 / 3.0])

    def test_the_line_ends_where_less_than_half_got_there(self):
        found = self.lengths("plain", "robot")
        found.values[1] = found.values[1][:, :2]
        self.assertEqual(np.isfinite(found.quartiles()[1]).tolist(), [True, True, False, False])

    def test_a_run_has_the_median_of_its_robots_or_the_trip_of_the_team(self):
        found = self.lengths("plain", "robot")
        np.testing.assert_allclose(found.of_runs()[0], 12.0 / np.arange(1, 5) + 1.0 + 5.0)
        np.testing.assert_allclose(found.final(3), [10.0, 11.0])
        self.assertEqual(len(found.final(5)), 0)
        team = self.lengths("plain", "team")
        np.testing.assert_allclose(team.final(3), [7.0, 8.0, 9.0])  # the second trip of the first robot
        self.assertEqual(team.iterations, 8)

    def test_bins_are_round_and_hold_all(self):
        edges = trail_lengths.bins_of(np.array([71.3, 80.0, 96.0]))
        np.testing.assert_allclose(edges, [70.0, 75.0, 80.0, 85.0, 90.0, 95.0, 100.0])
        self.assertEqual(len(trail_lengths.bins_of(np.array([5.0]))), 2)

    def test_the_figure_says_what_the_fits_are_and_who_is_missing(self):
        self.make_foragers()
        said = self.said("trail_lengths.py", "--robots", "1", "--final", "3", "--shortest", "4.5")
        for text in ("plain: 5.5 ± 0.7 m, 2 of 3 runs", "search: 10.0 ± 1.0 m, 3 of 3 runs", "4.5 m", "Dotted",
                     "Iteration 3"):
            self.assertIn(text, said)
        self.assertIn("no run got so far", self.said("trail_lengths.py", "--robots", "1", "--method", "plain"))

    def test_mistakes_are_named(self):
        self.make_foragers()
        for more, text in (
            (("--final", "0"), "--final and --until are above 0"),
            (("--shortest", "-1"), "--shortest: -1 is not above 0"),
            (("--shortest", "5", "--highest", "4"), "--highest: it is not above --shortest"),
        ):
            self.assertIn(text, self.refused("trail_lengths.py", self.file, "x.png", "--robots", "1", *more))
        connection = data.sqlite3.connect(self.file)
        connection.execute("DELETE FROM event")
        connection.commit()
        connection.close()
        self.assertIn("no forager of 'lost' ever arrived",
                      self.refused("trail_lengths.py", self.file, "x.png", "--robots", "1"))


class ThroughputOfTeams(WithForagers):
    def test_trips_of_the_team_are_counted_by_the_hour_of_the_scenario(self):
        self.make_foragers()
        found = throughput.Throughput(self.chosen(), "robots", "method", ["plain", "search"], None)
        # Of 90 s: each robot has 4, 4 and 2 trips under plain, 4 each under search.
        mean, half = found.curve("plain")
        np.testing.assert_allclose(mean, [40.0 * 10.0 / 3.0, 40.0 * 20.0 / 3.0])
        t_of_two = 4.302653  # 97.5 % of Student's t with two degrees of freedom
        np.testing.assert_allclose(half[0], 40.0 * t_of_two * math.sqrt(4.0 / 3.0) / math.sqrt(3.0), rtol=1e-6)
        np.testing.assert_allclose(found.curve("search"), [[160.0, 320.0], [0.0, 0.0]])

    def test_published_points_have_the_colour_of_the_label_that_means_the_same(self):
        labels = ["none", "so-lost", "highway"]
        looks = [style.label_style(label, labels)[0] for label in labels]
        self.assertEqual(len(set(looks)), 3)
        self.assertEqual([throughput.published_color(n, labels) for n in ("LOST", "SO-LOST")], looks[:2])
        self.assertEqual(throughput.published_color("LOST", ["plain"]), style.GREY)
        self.assertEqual({len(values) for values in throughput.SO_LOST.values()}, {10})

    def test_the_figure_names_lines_and_where_points_are_from(self):
        self.make_foragers()
        said = self.said("throughput.py")
        for text in ("plain", "SO-LOST, published", "Sadat", "± 5 %", "3 repetitions"):
            self.assertIn(text, said)
        self.assertNotIn("published", self.said("throughput.py", "--published", "none"))

    def test_mistakes_are_named(self):
        self.make_foragers(scenario=SCENARIO.replace("duration_s = 90", ""))
        self.assertEqual(self.refused("throughput.py", self.file, "x.png"),
                         f"{self.path('floor.toml')}: it does not say duration_s")
        self.assertIn("axis method has labels that are no numbers",
                      self.refused("throughput.py", self.file, "x.png", "--over", "method", "--by", "robots"))
        self.assertIn("one axis twice", self.refused("throughput.py", self.file, "x.png", "--over", "method"))


class LevelsOfForagers(WithForagers):
    def curve(self, metric, team, method):
        if not os.path.exists(self.file):
            self.make_foragers()
        chosen = self.chosen()
        found = grid_levels.Metric(chosen, metric, "0.8", team)
        levels = grid_levels.Levels(chosen, "robots", None, "method", ["plain", "search"], [found])
        self.assertFalse(found.has_central)  # agent -1 is the team
        return levels.curve(found, None, method)

    def test_a_metric_is_of_each_robot_or_of_the_team(self):
        np.testing.assert_allclose(self.curve("trips", False, "plain")[0], [10.0 / 3.0, 10.0 / 3.0])
        np.testing.assert_allclose(self.curve("trips", True, "plain")[0], [10.0 / 3.0, 20.0 / 3.0])

    def test_recovery_is_a_median_that_counts_who_never_gets_over_it(self):
        self.assertEqual(self.curve("recovery_s", True, "plain")[0].tolist(), [math.inf, math.inf])
        self.assertEqual(self.curve("recovery_s", True, "search")[0].tolist(), [50.0, 50.0])

    def test_the_figure_says_who_is_meant_and_what_never_comes(self):
        self.make_foragers()
        options = ("--over", "robots", "--by", "method", "--metrics", "trips;recovery_s", "--team")
        said = self.said("grid_levels.py", *options)
        for text in ("search", "of all together", "never", "Arrows above a dotted line",
                     "Of first arrival after the change: medians over repetitions"):
            self.assertIn(text, said)
        alone = self.said("grid_levels.py", "--over", "robots", "--method", "plain", "--metrics", "recovery_s")
        self.assertIn("never", alone)
        self.assertNotIn("0.2", alone)  # an axis on which nothing stands has no numbers
        self.assertNotIn("central grid", said + alone)


if __name__ == "__main__":
    unittest.main()
