"""A sweep ends with the same content whatever the number of jobs and however it was interrupted."""
import os
import random
import signal
import sqlite3
import subprocess
import time
import unittest

from bed import HEARSAY, SOURCE, STUDY, Bed


def content(file):
    """Every row of every view, but for wall times."""
    database = sqlite3.connect(file)
    views = [name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'view'")]
    assert {"run", "axis", "agent", "scalar", "series"} <= set(views), views
    rows = {}
    for view in sorted(views) + ["study"]:
        cursor = database.execute(f"SELECT * FROM {view}")
        columns = [c[0] for c in cursor.description]
        rows[view] = [tuple(v for c, v in zip(columns, row) if c != "wall_s") for row in cursor]
    database.close()
    return rows


class Sweep(Bed):
    def test_jobs_change_nothing(self):
        self.good("sweep", "ring.study.toml", "--out", "one.db", "--jobs", "1")
        self.good("sweep", "ring.study.toml", "--out", "eight.db", "--jobs", "8")
        self.assertEqual(self.good("diff", "one.db", "eight.db"), "the same\n")
        self.assertEqual(content(self.dir / "one.db"), content(self.dir / "eight.db"))

    def test_run_ids_follow_the_axes_and_repetitions_have_their_seeds(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        rows = content(self.dir / "a.db")["run"]
        self.assertEqual([row[0] for row in rows], list(range(1, 37)))
        self.assertEqual([row[5] for row in rows], [1, 2, 3, 4, 5, 6] * 6)
        self.assertIn('"rule":"none","loss":0.3', rows[6][3])

    def test_a_second_call_does_nothing(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        before = content(self.dir / "a.db")
        self.assertIn(" 0 new ", self.good("sweep", "ring.study.toml", "--out", "a.db"))
        self.assertEqual(before, content(self.dir / "a.db"))

    def test_killed_at_any_moment_it_goes_on_and_ends_the_same(self):
        self.write("ring.study.toml", STUDY.replace("repetitions = 6", "repetitions = 400"))
        begin = time.monotonic()
        self.good("sweep", "ring.study.toml", "--out", "whole.db", "--jobs", "2")
        whole_s = time.monotonic() - begin  # only to kill well before the end
        wanted = content(self.dir / "whole.db")
        moments = random.Random(5)
        for trial in range(3):
            out = f"killed{trial}.db"
            kills = 0
            for attempt in range(50):
                child = subprocess.Popen(
                    [HEARSAY, "sweep", "ring.study.toml", "--out", out, "--jobs", str(1 + attempt % 3)],
                    cwd=self.dir, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(moments.uniform(0.05, 0.5) * whole_s)
                child.send_signal(signal.SIGKILL)
                kills += child.wait() == -signal.SIGKILL
                if child.returncode == 0:
                    break
            self.good("sweep", "ring.study.toml", "--out", out)
            self.assertGreater(kills, 0)
            self.assertEqual(self.good("diff", "whole.db", out), "the same\n")
            self.assertEqual(content(self.dir / out), wanted)

    def test_interrupted_by_ctrl_c_it_keeps_what_was_done(self):
        self.write("ring.study.toml", STUDY.replace("repetitions = 6", "repetitions = 4000"))
        child = subprocess.Popen([HEARSAY, "sweep", "ring.study.toml", "--out", "a.db"], cwd=self.dir,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(0.8)
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 1)
        self.assertIn("goes on where it stopped", errors)
        self.assertEqual([p.name for p in self.dir.glob("a.db*")], ["a.db"])
        self.assertGreater(len(content(self.dir / "a.db")["run"]), 0)

    def test_a_failed_run_is_stored_with_its_reason_and_retried_only_on_request(self):
        text = (self.dir / "ring.toml").read_text().replace("seed = 1", "seed = 1\nevents_max = 150")
        self.write("ring.toml", text)
        done = self.command("sweep", "ring.study.toml", "--out", "a.db")
        self.assertEqual(done.returncode, 1)
        self.assertIn("event budget", done.stderr)
        rows = content(self.dir / "a.db")["run"]
        self.assertEqual(len(rows), 36)
        failed = [row for row in rows if row[6] == "failed"]
        self.assertGreater(len(failed), 0)
        self.assertIn(" 0 new ", self.good("sweep", "ring.study.toml", "--out", "a.db"))
        again = self.command("sweep", "ring.study.toml", "--out", "a.db", "--retry")
        self.assertIn(f" {len(failed)} new ", again.stdout)
        self.assertEqual(content(self.dir / "a.db")["run"], rows)


class Size(Bed):
    def test_the_rumour_study_stays_below_200_megabytes_for_20000_runs(self):
        study = (SOURCE / "scenarios/rumour/rumour.study.toml").read_text()
        scenario = (SOURCE / "scenarios/rumour/rumour.toml").read_text()
        self.write("rumour.toml", scenario)
        self.write("few.study.toml", study.replace("repetitions = 100", "repetitions = 3"))
        self.good("sweep", "few.study.toml", "--out", "few.db")
        runs = len(content(self.dir / "few.db")["run"])
        self.assertEqual(runs, 648)
        self.assertLess(os.path.getsize(self.dir / "few.db") / runs * 20_000, 200e6)


if __name__ == "__main__":
    unittest.main()
