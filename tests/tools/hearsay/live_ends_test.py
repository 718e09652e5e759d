"""However `hearsay live` ends, its children end."""
import os
import signal
import subprocess
import unittest

from bed import HEARSAY
from live_bed import WAIT_S, LiveBed

# Children need a moment to see that their parent is gone, on a busy machine some more.
GONE_S = 30.0
ENDLESS = ["ring.toml", "--set", "duration_s=1000000"]


class Ends(LiveBed):
    def begun(self, *words):
        """A fleet in the midst of its run."""
        fleet = self.start("live", *ENDLESS, *words, terminal=True)
        self.until(lambda: fleet.now_s() > 0, "the run begins")
        self.assertEqual(len(self.members()), 6)
        return fleet

    def expect_end(self, fleet):
        self.ends(fleet, 1)
        self.assertEqual(self.members(), {}, "children outlived their parent")

    def test_by_an_interrupt_of_itself_alone(self):
        for pace in [["--lockstep"], ["--speed", 10]]:
            fleet = self.begun(*pace, "--out", "live.db")
            fleet.kill(signal.SIGINT)
            self.expect_end(fleet)

    def test_by_an_interrupt_of_all_of_its_group(self):
        fleet = self.begun("--lockstep")
        os.killpg(fleet.pid, signal.SIGINT)
        self.expect_end(fleet)

    def test_by_a_request_to_end(self):
        fleet = self.begun("--lockstep")
        fleet.kill(signal.SIGTERM)
        self.expect_end(fleet)

    def test_before_it_began(self):
        fleet = self.start("live", *ENDLESS)
        self.until(lambda: len(self.members()) > 1, "there are children")
        fleet.kill(signal.SIGINT)
        self.expect_end(fleet)

    def test_by_a_kill(self):
        for pace in [["--lockstep"], ["--speed", 10]]:
            fleet = self.begun(*pace)
            fleet.kill(signal.SIGKILL)
            fleet.wait()
            self.until(lambda: self.members() == {}, "children end without their parent", GONE_S)

    def test_by_a_child_that_fails(self):
        taken = self.dir / "live.db"
        taken.write_text("no database")
        fleet = self.start("live", "ring.toml", "--lockstep", "--out", "live.db")
        code = fleet.wait()
        self.assertNotEqual(code, 0, fleet.text())
        self.assertIn("live.db", fleet.trouble())
        self.assertEqual(taken.read_text(), "no database")

    def test_while_nobody_reads_what_it_prints(self):
        command = [HEARSAY, "live", "ring.toml", "--lockstep", "--fleet", self.fleet]
        with subprocess.Popen(command, cwd=self.dir, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as fleet:
            head = subprocess.run(["head", "-1"], stdin=fleet.stdout, capture_output=True, text=True, timeout=WAIT_S)
            fleet.stdout.close()
            self.assertIn(fleet.wait(timeout=WAIT_S), [0, -signal.SIGPIPE])
            self.assertNotIn(b"terminate called", fleet.stderr.read())
        self.assertTrue(head.stdout.startswith("agent "), head.stdout)

    def test_while_nobody_listens_at_all(self):
        command = [HEARSAY, "live", "ring.toml", "--lockstep", "--fleet", self.fleet]
        with subprocess.Popen(command, cwd=self.dir, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as fleet:
            fleet.stdout.close()
            fleet.stderr.close()
            fleet.wait(timeout=WAIT_S)
        self.until(lambda: self.members() == {}, "children end without their parent", GONE_S)


if __name__ == "__main__":
    unittest.main()
