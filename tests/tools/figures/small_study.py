"""A small study of the names in sim/record/database.hpp, with values that can be worked out by
hand, and a test case that runs the scripts on it."""

import contextlib
import importlib
import io
import os
import re
import sqlite3
import sys
import tempfile
import unittest

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../tools/figures")
sys.path.insert(0, SCRIPTS)

import data  # noqa: E402

RULES = ("none", "naive", "my-rule")
T_S = (0.0, 10.0, 20.0)


def make_database(file, losses=("0.0", "0.3"), subjects=("target",), series=None, change=None):
    """2 topologies × 3 rules × losses × 4 repetitions, 2 agents and the central filter. `series`:
    names that are recorded (all). `change(rule, repetition, t, agent, name, value)` gives another
    value, None for NULL."""
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
                    row = (run, repetition)
                    connection.execute("INSERT INTO run VALUES (?, 'small', ?, 'ok')", row)
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

    def said(self, script, *arguments):
        """What a figure says, once it was drawn twice and alike."""
        drawn = self.draw(script, "a.svg", *arguments)
        self.assertTrue(drawn == self.draw(script, "b.svg", *arguments), "two drawings differ")
        return " ".join(re.findall(r">([^<>\n]+)<", drawn.decode()))

    def chosen(self, **where):
        database = data.Database(self.file)
        return database.select(database.study(None), where)

    def refused(self, script, *arguments):
        """What a script says on stderr when it refuses, without its name."""
        before = sorted(os.listdir(self.directory))
        code, out, err = self.run_script(script, *arguments)
        self.assertEqual((code, out), (2, ""), err)
        self.assertEqual(sorted(os.listdir(self.directory)), before, "something half-written")
        return err.strip().removeprefix(script + ": ")
