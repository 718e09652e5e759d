"""examples/foreign_agent, built against the installed tree, in fleets with hearsay's own processes."""
import os
import re
import shutil
import sqlite3
import subprocess
import tempfile
import unittest
from pathlib import Path

CMAKE = os.environ["CMAKE"]
BUILD = Path(os.environ["HEARSAY_BUILD_DIR"])
EXAMPLE = Path(os.environ["HEARSAY_SOURCE_DIR"]) / "examples" / "foreign_agent"
FOREIGN, OWN = 1, (0, 2)  # on a line: all that the others hear, they hear from the foreign one


def environment():
    """Without settings of Cyclone DDS, so that everything stays on the loopback interface."""
    return {k: v for k, v in os.environ.items() if not k.startswith("CYCLONEDDS")}


class ForeignAgent(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.dir = Path(scratch.name)
        cls.prefix = cls.dir / "prefix"
        cls.run_all([CMAKE, "--install", BUILD, "--prefix", cls.prefix])
        cls.hearsay = cls.prefix / "bin" / "hearsay"
        cls.foreign = cls.built(EXAMPLE, cls.dir / "build")

    @classmethod
    def run_all(cls, *commands):
        for words in commands:
            done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=300)
            if done.returncode != 0:
                raise AssertionError(f"{words}: {done.stdout}{done.stderr}")

    @classmethod
    def built(cls, source, build):
        # No C++ compiler is needed, nor looked for.
        cls.run_all([CMAKE, "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={cls.prefix}",
                     "-DCMAKE_CXX_COMPILER=/no/compiler", "-DCMAKE_C_FLAGS=-Werror"],
                    [CMAKE, "--build", build])
        return build / "foreign_agent"

    def setUp(self):
        self.fleet = f"foreign-{os.getpid()}-{self._testMethodName.replace('_', '-')}"[:64]

    def start(self, *words):
        process = subprocess.Popen(list(map(str, words)), cwd=self.dir, env=environment(), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.see_off, process)
        return process

    def see_off(self, process):
        """All have ended by themselves, unless a test failed."""
        if process.poll() is None:
            process.kill()
            process.communicate()

    def start_hearsay(self, verb, *words):
        return self.start(self.hearsay, verb, EXAMPLE / "fleet.toml", "--fleet", self.fleet, *words)

    def ended(self, process, code, timeout=120):
        out, error = process.communicate(timeout=timeout)
        self.assertEqual(process.returncode, code, f"{process.args}: {out}{error}")
        return out, error

    def test_takes_an_agents_place(self):
        world = self.start_hearsay("world", "--speed", 10, "--out", "fleet.db")
        others = [self.start_hearsay("agent", "--id", i) for i in OWN]
        foreign = self.start(self.foreign, self.fleet, FOREIGN)
        self.ended(world, 0)
        for other in others:
            self.ended(other, 0, timeout=20)
        out, error = self.ended(foreign, 0, timeout=20)
        self.assertIn(f"welcome as agent {FOREIGN} of fleet '{self.fleet}'", out)
        self.assertEqual(error, "")
        self.check_record(sqlite3.connect(self.dir / "fleet.db"))

    def check_record(self, db):
        self.addCleanup(db.close)

        def series(name):
            return [v for (v,) in db.execute(
                "SELECT value FROM series WHERE agent = ? AND name = ? AND value IS NOT NULL "
                "ORDER BY t_s", (FOREIGN, name))]

        def scalar(agent, name):
            return db.execute("SELECT value FROM scalar WHERE agent = ? AND name = ?",
                              (agent, name)).fetchone()[0]

        # What it reports became series: of its belief as of anybody's, and one of its own.
        errors = series("rms_error_m")
        self.assertGreaterEqual(len(errors), 10, errors)
        self.assertLess(errors[-1], 0.7 * errors[0], errors)
        information = series("information_xx")
        self.assertGreater(len(information), 40)
        self.assertEqual(information, sorted(information))
        self.assertGreater(scalar(FOREIGN, "measurements"), 40)
        # Packets went both ways, over the world's radio, and were fused.
        delivered = {(s, r): n for s, r, n in db.execute(
            "SELECT sender, receiver, packets FROM link WHERE fate = 'delivered'")}
        self.assertNotIn(OWN, delivered)
        for own in OWN:
            self.assertGreater(delivered[FOREIGN, own], 5)
            self.assertGreater(scalar(own, "fusions"), 5)
            self.assertLessEqual(scalar(own, "fusions"), delivered[FOREIGN, own])
            self.assertEqual(scalar(own, "messages_refused"), 0)
        heard = sum(delivered[own, FOREIGN] for own in OWN)
        self.assertGreater(scalar(FOREIGN, "fusions"), 10)
        self.assertLessEqual(scalar(FOREIGN, "fusions"), heard)
        self.assertEqual(scalar(FOREIGN, "messages_refused"), 0)
        # Naive fusion: far surer than it is right. Sixty measurements of 5 m are good for 0.4 m.
        self.assertLess(scalar(FOREIGN, "final_claimed_sigma_m"), 0.1)
        self.assertEqual(db.execute("SELECT count(*) FROM event").fetchone()[0], 0)

    def test_is_refused_in_lockstep(self):
        world = self.start_hearsay("world", "--lockstep", "--patience", 120)
        foreign = self.start(self.foreign, self.fleet, FOREIGN)
        _, error = self.ended(foreign, 1)
        reason = "this world moves in lockstep, which only hearsay's own agents can"
        self.assertEqual(error, f"foreign_agent: the world refused it: {reason}\n")
        world.terminate()  # which is to ask
        _, error = self.ended(world, 1, timeout=20)
        self.assertIn(f"refused agent {FOREIGN}: {reason}", error)

    def test_is_refused_where_there_is_no_such_agent(self):
        world = self.start_hearsay("world", "--patience", 120)
        _, error = self.ended(self.start(self.foreign, self.fleet, 3), 1)
        self.assertIn("the world refused it: there is no agent 3: the scenario has 3", error)
        # One that waits for the others hears that they will not begin.
        waiting = self.start(self.foreign, self.fleet, FOREIGN)
        self.assertIn("welcome as agent 1", waiting.stdout.readline())
        world.terminate()
        self.ended(world, 1, timeout=20)
        _, error = self.ended(waiting, 1, timeout=20)
        self.assertEqual(error, "foreign_agent: the world ended: it was asked to stop\n")

    def test_nonsense_of_it_is_dropped(self):
        """A variant of it speaks to nobody, or at no time; the world goes on, and counts that."""
        source = self.dir / "nonsense"
        shutil.copytree(EXAMPLE, source)
        text = (source / "foreign_agent.c").read_text()
        for sound, nonsense in ((".receiver = UINT32_MAX", ".receiver = me.said % 2 ? 99 : UINT32_MAX"),
                                (".tick = -1", ".tick = me.said % 2 ? -1 : INT64_MAX"),
                                ("{.now_ns = now_ns, .name", "{.now_ns = -now_ns, .name")):
            self.assertEqual(text.count(sound), 1, sound)
            text = text.replace(sound, nonsense)
        (source / "foreign_agent.c").write_text(text)
        program = self.built(source, self.dir / "nonsense-build")
        world = self.start_hearsay("world", "--speed", 20, "--out", "nonsense.db")
        others = [self.start_hearsay("agent", "--id", i) for i in OWN]
        foreign = self.start(program, self.fleet, FOREIGN)
        out, _ = self.ended(world, 0)
        for process in (*others, foreign):
            self.ended(process, 0, timeout=20)
        self.assertGreater(int(re.search(r"(\d+) packets dropped", out)[1]), 5)
        db = sqlite3.connect(self.dir / "nonsense.db")
        self.addCleanup(db.close)
        self.assertEqual(db.execute("SELECT count(*) FROM link WHERE sender = ?",
                                    (FOREIGN,)).fetchone()[0], 0)
        self.assertEqual(db.execute("SELECT min(t_s) FROM series").fetchone()[0], 0)

    def test_says_how_it_is_used(self):
        for words in ([], [self.fleet], [self.fleet, 1, 2], ["-x", self.fleet, 1]):
            _, error = self.ended(self.start(self.foreign, *words), 2)
            self.assertIn("usage: foreign_agent", error)
        for words in ([self.fleet, "one"], [self.fleet, "1x"], ["-d", "231", self.fleet, 1]):
            _, error = self.ended(self.start(self.foreign, *words), 1)
            self.assertIn("is no number in range", error)

    def test_is_short_enough_to_read(self):
        self.assertLessEqual(len((EXAMPLE / "foreign_agent.c").read_text().splitlines()), 250)


if __name__ == "__main__":
    unittest.main()
