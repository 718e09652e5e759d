"""What a user of tools/figures sees after a mistake: a line, exit code 2, nothing half-written."""

import os
import subprocess
import sys
import unittest

from small_study import SCRIPTS, WithDatabase, make_database  # first: it makes the scripts known

import data


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
            f"small.db: its schema has version 7, these scripts read {data.SCHEMA_VERSION}",
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
        self.assertEqual(
            self.refused("mrclam.py", "small.db", "x.png"), "small.db: it holds no runs"
        )

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
