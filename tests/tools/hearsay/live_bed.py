"""What tests of fleets share: names that no other test has, processes with hard limits of time, and proof that
none of them is left."""
import itertools
import os
import pty
import signal
import sqlite3
import subprocess
import threading
import time
from pathlib import Path

from bed import HEARSAY, Bed

# For what is sure to come: only a failing test waits so long.
WAIT_S = 90.0
NUMBERS = itertools.count()


def arguments_of(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return []


class Started:
    """A process of the program, in a session of its own; what it prints goes into files, by way of a terminal if
    it is to think that somebody looks on."""

    def __init__(self, folder, words, terminal=False):
        name = f"process{next(NUMBERS)}"
        self.out, self.err = folder / f"{name}.out", folder / f"{name}.err"
        with open(self.out, "wb") as out, open(self.err, "wb") as err:
            screen, stdout = pty.openpty() if terminal else (None, out)
            self.process = subprocess.Popen([HEARSAY, *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=stdout,
                                            stderr=err, start_new_session=True)
        self.pid = self.process.pid
        self.reader = threading.Thread(target=self.read, args=(screen,), daemon=True) if terminal else None
        if terminal:
            os.close(stdout)
            self.reader.start()

    def read(self, screen):
        with open(screen, "rb", buffering=0) as terminal, open(self.out, "wb", buffering=0) as out:
            try:
                while text := terminal.read(4096):
                    out.write(text)
            except OSError:
                pass  # so says Linux when the other end is closed

    def text(self):
        return self.out.read_text(errors="replace")

    def trouble(self):
        return self.err.read_text()

    def kill(self, number=signal.SIGKILL):
        self.process.send_signal(number)

    def wait(self, seconds=WAIT_S):
        """@return its exit code, −N if signal N ended it."""
        code = self.process.wait(timeout=seconds)
        if self.reader:
            self.reader.join(seconds)
        return code

    def over(self):
        return self.process.poll() is not None

    def now_s(self):
        """How far a world with --status is, in simulated seconds; −1 before it has begun."""
        words = [line.split() for line in self.text().splitlines() if " s of " in line]
        return float(words[-1][1]) if words else -1.0


class LiveBed(Bed):
    def setUp(self):
        super().setUp()
        self.fleet = f"test-{os.getpid()}-{next(NUMBERS)}"
        self.addCleanup(self.check_nobody_is_left)

    def members(self):
        """Processes of this test's fleets, by what they were told."""
        found = {}
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit() and any(self.fleet in word for word in arguments_of(folder.name)):
                found[int(folder.name)] = arguments_of(folder.name)
        return found

    def child(self, agent):
        """@return the process of an agent that `hearsay live` started."""
        mine = [pid for pid, words in self.members().items()
                if words[1] == "agent" and words[words.index("--id") + 1] == str(agent)]
        self.assertEqual(len(mine), 1, self.members())
        return mine[0]

    def world_of_live(self):
        (world,) = [pid for pid, words in self.members().items() if words[1] == "world"]
        return world

    def check_nobody_is_left(self):
        left = self.members()
        for pid in left:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.assertEqual(left, {}, "processes were left behind")

    def start(self, *words, fleet=None, terminal=False):
        verb, *others = map(str, words)
        return Started(self.dir, [verb, *others, "--fleet", fleet or self.fleet], terminal)

    def live(self, *words):
        """A whole fleet, from its start to its end. @return what it printed."""
        process = self.start("live", *words)
        self.assertEqual(process.wait(), 0, f"{words}: {process.text()}{process.trouble()}")
        self.assertEqual(self.members(), {}, "children outlived their parent")
        return process.text()

    def world_and_agents(self, *words, agents=4, world=()):
        """Started by hand. @return the world and its agents."""
        first = self.start("world", *words, *world, "--status")
        return first, [self.start("agent", *words, "--id", i) for i in range(agents)]

    def came(self, kind):
        """Events of that kind, in live.db."""
        return self.rows("live.db", "SELECT t_s, agent FROM event WHERE kind = ? ORDER BY t_s", kind)

    def joined_again(self, words, pace, memory=()):
        """Agent 1 of four is killed in the midst of a run, and another process takes its place.
        @return when that joined."""
        world = self.start("world", *words, *pace, "--status")
        agents = [self.start("agent", *words, "--id", i, *(memory if i == 1 else ())) for i in range(4)]
        self.until(lambda: world.now_s() > 0, "the run begins")
        agents[1].kill()
        self.ends(agents[1], -signal.SIGKILL)
        agents[1] = self.start("agent", *words, "--id", 1, *memory)
        # A world may not have seen yet that the one before is gone.
        tries = 1
        while agents[1].wait() != 0 and tries < 20:
            self.assertIn("agent 1 is there already", agents[1].trouble())
            agents[1] = self.start("agent", *words, "--id", 1, *memory)
            tries += 1
        self.ends(world)
        for agent in agents:
            self.ends(agent)
        ((silent_s, silent),), ((joined_s, joined),) = self.came("silent"), self.came("joined again")
        self.assertEqual((silent, joined), (1, 1))
        self.assertLessEqual(silent_s, joined_s)
        return joined_s

    def until(self, done, what, seconds=WAIT_S):
        limit = time.monotonic() + seconds
        while not done():
            self.assertLess(time.monotonic(), limit, f"never happened: {what}")
            time.sleep(0.02)

    def ends(self, process, code=0):
        self.assertEqual(process.wait(), code, process.text() + process.trouble())

    def rows(self, database, query, *values):
        connection = sqlite3.connect(self.dir / database)
        try:
            return connection.execute(query, values).fetchall()
        finally:
            connection.close()

    def value(self, database, agent, name):
        ((value,),) = self.rows(database, "SELECT value FROM scalar WHERE agent = ? AND name = ?", agent, name)
        return value
