"""Tests of tools/figures: the statistics against published values, the numbers against ones worked
out by hand, and what a user sees after a mistake."""

import contextlib
import csv
import importlib
import io
import math
import os
import sqlite3
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../tools/figures")
sys.path.insert(0, SCRIPTS)

import numpy as np  # noqa: E402

import data  # noqa: E402
import panels  # noqa: E402
import stats  # noqa: E402
import style  # noqa: E402

RULES = ("none", "naive", "my-rule")
T_S = (0.0, 10.0, 20.0)


def make_database(file, losses=("0.0", "0.3"), subjects=("target",), series=None, change=None):
    """A study of the documented names: 2 topologies × 3 rules × losses × 4 repetitions, 2 agents and
    the central filter. `change(values)` may alter or drop (None → NULL) single values."""
    connection = sqlite3.connect(file)
    connection.executescript(
        f"""PRAGMA application_id = {data.APPLICATION_ID};
        PRAGMA user_version = {data.SCHEMA_VERSION};
        CREATE TABLE run(id INTEGER PRIMARY KEY, study, repetition, status);
        CREATE TABLE axis(run, name, value);
        CREATE TABLE scalar(run, agent, name, value);
        CREATE TABLE series(run, t_s, agent, subject, name, value);"""
    )
    run = 0
    for topology in ("line", "ring"):
        for rule in RULES:
            for loss in losses:
                for repetition in range(1, 5):
                    run += 1
                    connection.execute("INSERT INTO run VALUES (?, 'small', ?, 'ok')", (run, repetition))
                    for name, label in (("topology", topology), ("rule", rule), ("loss", loss)):
                        connection.execute("INSERT INTO axis VALUES (?, ?, ?)", (run, name, label))
                    scalars = [(run, -1, "state_dimension", 2.0)]
                    scalars += [(run, a, "distance_error_m", 0.1 * (a + 2)) for a in (-1, 0, 1)]
                    connection.executemany("INSERT INTO scalar VALUES (?, ?, ?, ?)", scalars)
                    connection.executemany(
                        "INSERT INTO series VALUES (?, ?, ?, ?, ?, ?)",
                        rows_of(run, rule, repetition, subjects, series, change),
                    )
    connection.commit()
    return connection


def rows_of(run, rule, repetition, subjects, series, change):
    for t in T_S:
        for agent in (-1, 0, 1):
            for subject in subjects:
                values = {
                    "rms_error_m": (repetition + agent) / (1.0 + t),
                    "claimed_sigma_m": 10.0 ** -t if rule == "naive" else 2.0 / (1.0 + t),
                    "true_sigma_m": 2.5 / (1.0 + t),
                    "nees": 2.0 + 0.5 * agent,
                    "multiplicity_mean": 2.0**t if rule == "naive" else 1.0,
                }
                for name, value in values.items():
                    if series is None or name in series:
                        if change is not None:
                            value = change(rule, repetition, t, agent, name, value)
                        yield run, t, agent, subject, name, value


class WithDatabase(unittest.TestCase):
    def setUp(self):
        self._directory = tempfile.TemporaryDirectory()
        self.directory = self._directory.name
        self.file = self.path("small.db")
        self._before = os.getcwd()
        os.chdir(self.directory)

    def tearDown(self):
        os.chdir(self._before)
        self._directory.cleanup()

    def path(self, name):
        return os.path.join(self.directory, name)

    def make(self, **options):
        make_database(self.file, **options).close()

    def run_script(self, script, *arguments):
        """Exit code, stdout, stderr of a script. In this process: starting one takes a second."""
        out, err = io.StringIO(), io.StringIO()
        code, argv = 0, sys.argv
        module = importlib.import_module(script.removesuffix(".py"))
        try:
            sys.argv = [script, *arguments]
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                data.main(module.main)
        except SystemExit as end:
            code = end.code
        finally:
            sys.argv = argv
        return code, out.getvalue(), err.getvalue()

    def draw(self, script, output, *arguments):
        self.assertEqual(self.run_script(script, self.file, output, *arguments), (0, "", ""))
        with open(self.path(output), "rb") as stream:
            return stream.read()

    def refused(self, script, *arguments):
        """What a script says on stderr when it refuses, without its name."""
        before = sorted(os.listdir(self.directory))
        code, out, err = self.run_script(script, *arguments)
        self.assertEqual((code, out), (2, ""), err)
        self.assertEqual(sorted(os.listdir(self.directory)), before, "something half-written")
        return err.strip().removeprefix(script + ": ")


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
    def chosen(self, **where):
        database = data.Database(self.file)
        return database.select(database.study(None), where)

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
        nees = chosen.series(["nees"])["nees"]
        curve = panels.anees(nees, 0, chosen.state_dimension())
        self.assertAlmostEqual(curve.value[0], 1.125)
        self.assertAlmostEqual(curve.low[0], 1.0)
        self.assertAlmostEqual(curve.high[0], 1.25)

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
        self.assertEqual(len(rows), 2 * 3 * 2 + 2)  # naive's multiplicity is another for central, too
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
        self.assertTrue(lines[4].startswith("| line     | none    | 0.250 "), lines[4])
        self.assertTrue(os.path.exists(self.path("t.csv")))

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
        self.make(subjects=("6", "7"), series=("rms_error_m", "claimed_sigma_m", "multiplicity_mean"))
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
        for said in ("100 % of beliefs", "indefinite at the end", "2 agents", "4 paired repetitions"):
            self.assertIn(said, text)

    def test_the_caption_says_what_was_chosen(self):
        self.make()
        text = self.draw("rumour.py", "a.svg", "--loss", "0.3").decode()
        self.assertIn("30 % loss", text)


class Mistakes(WithDatabase):
    def test_a_missing_database_is_named(self):
        self.assertEqual(self.refused("rumour.py", "no.db", "x.png"), "no.db: no such database")

    def test_the_shell_sees_exit_code_2_and_one_line(self):
        done = subprocess.run(
            [sys.executable, "-B", os.path.join(SCRIPTS, "rumour.py"), "no.db", "x.png"],
            capture_output=True, text=True, check=False,
        )
        self.assertEqual(
            (done.returncode, done.stdout, done.stderr),
            (2, "", "rumour.py: no.db: no such database\n"),
        )

    def test_a_file_that_is_no_database_is_named(self):
        with open(self.path("text.db"), "w", encoding="utf-8") as stream:
            stream.write("not a database, but long enough to be looked at\n" * 100)
        self.assertEqual(
            self.refused("table.py", "text.db", "x.md"),
            "text.db: not a database that can be read (file is not a database)",
        )

    def test_a_database_of_something_else_or_another_version_is_refused(self):
        connection = make_database(self.file)
        connection.execute("PRAGMA user_version = 7")
        connection.commit()
        self.assertEqual(
            self.refused("mrclam.py", "small.db", "x.png"),
            "small.db: its schema has version 7, these scripts read 1",
        )
        connection.execute("PRAGMA application_id = 0")
        connection.commit()
        self.assertEqual(
            self.refused("rumour.py", "small.db", "x.png"),
            "small.db: a database, but not one of hearsay",
        )

    def test_an_empty_selection_says_what_there_is(self):
        self.make()
        self.assertEqual(
            self.refused("rumour.py", "small.db", "x.png", "--loss", "0.7"),
            "small.db: axis loss has no '0.7'; it has: 0, 0.3",
        )
        self.assertEqual(
            self.refused("rumour.py", "small.db", "x.png", "--los", "0.3"),
            "small.db: study 'small' has no axis 'los'; it has: topology, rule, loss",
        )
        self.assertEqual(
            self.refused("table.py", "small.db", "x.md", "--study", "big"),
            "small.db: no study 'big'; there are: small",
        )

    def test_a_database_without_runs_or_with_failed_ones_alone_is_refused(self):
        connection = make_database(self.file)
        connection.execute("UPDATE run SET status = 'failed'")
        connection.commit()
        self.assertEqual(
            self.refused("mrclam.py", "small.db", "x.png"),
            "small.db: study 'small' has no finished run with these labels",
        )
        connection.execute("DELETE FROM run")
        connection.commit()
        self.assertEqual(self.refused("mrclam.py", "small.db", "x.png"), "small.db: it holds no runs")

    def test_an_axis_that_the_figure_does_not_draw_must_be_chosen(self):
        connection = make_database(self.file)
        connection.execute("INSERT INTO axis SELECT id, 'speed', id % 2 FROM run")
        connection.commit()
        self.assertEqual(
            self.refused("mrclam.py", "small.db", "x.png"),
            "small.db: choose one speed with --speed: 1, 0",
        )

    def test_a_series_that_was_not_recorded_is_named(self):
        self.make(series=("rms_error_m", "claimed_sigma_m"))
        self.assertEqual(
            self.refused("mrclam.py", "small.db", "x.png"),
            "small.db: no series 'multiplicity_mean' in these runs of 'small';"
            " name it under [record] in the scenario",
        )

    def test_nothing_but_undefined_values_is_refused(self):
        self.make(change=lambda *rest: None)
        self.assertEqual(
            self.refused("rumour.py", "small.db", "x.png", "--loss", "0"),
            "no error is defined in these runs; nothing to draw",
        )

    def test_outputs_that_cannot_be_written_are_named(self):
        self.make()
        self.assertEqual(
            self.refused("rumour.py", "small.db", "nowhere/x.png", "--loss", "0"),
            "nowhere/x.png: cannot be written (No such file or directory)",
        )
        self.assertEqual(
            self.refused("rumour.py", "small.db", "x.jpg", "--loss", "0"),
            "x.jpg: a figure ends with .png, .svg or .pdf",
        )
        self.assertEqual(
            self.refused("table.py", "small.db", "x.txt"), "x.txt: a table ends with .md or .csv"
        )

    def test_arguments_that_are_none_are_refused(self):
        self.make()
        self.assertIn("expected --AXIS LABEL", self.refused("table.py", "small.db", "x.md", "odd"))


if __name__ == "__main__":
    unittest.main()
