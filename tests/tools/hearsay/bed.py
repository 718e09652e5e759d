"""What the program's tests share: a scratch folder, the program, small files."""
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

HEARSAY = os.environ["HEARSAY"]
SOURCE = Path(os.environ["HEARSAY_SOURCE_DIR"])

RING = """\
# Four agents on a ring.
duration_s = 30
seed = 1

[world]
targets = [{ name = "alarm", position_m = [40.0, 25.0] }]

[radio]
topology = "ring"
rate_bps = 250_000
loss = { model = "bernoulli", probability = 0.1 }

[[agents]]
count = 4
sensor = { kind = "position", period_s = 1.0, sigma_m = 5.0 }
estimator = { kind = "static-gaussian", fusion = "ci-det" }
talk = { policy = "periodic", period_s = 5.0 }

[record]
series = ["rms_error_m", "nees", "ledger_anees"]
series_period_s = 10.0
"""

STUDY = """\
scenario = "ring.toml"
repetitions = 6

[axes]
rule = { key = "agents.estimator.fusion", values = ["none", "naive", "ci-det"] }
loss = { key = "radio.loss.probability", values = [0.0, 0.3] }

[[claims]]
text = "naive is overconfident"
source = "by construction"
expect = { metric = "ledger_anees", where = { rule = "naive" }, at_least = 1.0 }
"""


class Bed(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.dir = Path(scratch.name)
        self.write("ring.toml", RING)
        self.write("ring.study.toml", STUDY)

    def write(self, name, text):
        (self.dir / name).write_text(text)
        return name

    def command(self, *words, **options):
        return subprocess.run([HEARSAY, *map(str, words)], cwd=self.dir, capture_output=True,
                              text=True, timeout=300, **options)

    def good(self, *words, **options):
        done = self.command(*words, **options)
        self.assertEqual(done.returncode, 0, f"{words}: {done.stdout}{done.stderr}")
        return done.stdout

    def bad(self, message, *words):
        """The command is refused with this message, exit code 2, nothing on standard output."""
        before = sorted(p.name for p in self.dir.iterdir())
        done = self.command(*words)
        self.assertEqual(done.returncode, 2, f"{words}: {done.stdout}{done.stderr}")
        self.assertIn(message, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertNotIn("terminate called", done.stderr)
        self.assertEqual(len(done.stderr.strip().split("\n")), 1, done.stderr)
        self.assertEqual(before, sorted(p.name for p in self.dir.iterdir()), "something was written")
