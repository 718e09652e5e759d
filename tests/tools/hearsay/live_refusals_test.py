"""Who does not belong to a fleet is refused, and is told why; two fleets do not mix."""
import signal
import unittest

from bed import RING
from live_bed import LiveBed


class Refused(LiveBed):
    def expect_refusal(self, reason, agent, *words):
        """A world goes on waiting, and says whom it sent away."""
        world = self.start("world", "ring.toml", "--lockstep", "--digest")
        stranger = self.start("agent", *words, "--id", agent)
        self.ends(stranger, 1)
        self.assertIn(f"hearsay agent {agent}: the world refused it: {reason}", stranger.trouble())
        self.assertEqual(stranger.text(), "")
        agents = [self.start("agent", "ring.toml", "--id", i) for i in range(4)]
        self.ends(world)
        self.assertEqual(world.text(), self.good("run", "ring.toml", "--digest"))
        self.assertIn(f"hearsay world: refused agent {agent}: {reason}", world.trouble())
        for member in agents:
            self.ends(member)

    def test_an_agent_with_another_setting(self):
        self.expect_refusal("it has another scenario, or other settings of it", 2, "ring.toml", "--set",
                            "radio.loss.probability=0.2")

    def test_an_agent_that_the_world_does_not_have(self):
        self.expect_refusal("there is no agent 4: the scenario has 4", 4, "ring.toml", "--set", "agents.count=5")

    def test_an_agent_that_is_there_already(self):
        world, agents = self.world_and_agents("ring.toml", "--set", "duration_s=100000", world=["--speed", 20])
        self.until(lambda: world.now_s() > 0, "the run begins")
        double = self.start("agent", "ring.toml", "--set", "duration_s=100000", "--id", 2)
        self.ends(double, 1)
        self.assertIn("the world refused it: agent 2 is there already", double.trouble())
        world.kill(signal.SIGTERM)
        self.ends(world, 1)
        self.assertIn("hearsay world: it was asked to stop", world.trouble())
        for agent in agents:
            self.ends(agent)

    def test_a_world_without_its_agents_says_who_is_missing(self):
        world = self.start("world", "ring.toml", "--patience", 1.5)
        agents = [self.start("agent", "ring.toml", "--id", i) for i in [0, 2]]
        self.ends(world, 1)
        self.assertRegex(world.trouble(), "after 1.5 s these agents have not come: (0, )?1, (2, )?3")
        for agent in agents:
            agent.wait()  # dismissed, or nobody is there any more


class BadInput(LiveBed):
    def test_a_name_that_could_match_others(self):
        for verb in ["world", "live"]:
            self.bad("fleet: 'a*' is no name of a fleet; allowed are 1 to 64 letters", verb, "ring.toml",
                     "--fleet", "a*")
        self.bad("fleet: '' is no name of a fleet", "agent", "ring.toml", "--id", "0", "--fleet", "")

    def test_an_interface_that_is_not_there(self):
        for words in [["world", "ring.toml"], ["agent", "ring.toml", "--id", "0"]]:
            done = self.command(*words, "--fleet", self.fleet, "--interface", "nowhere0")
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn("the network interface 'nowhere0' cannot be used", done.stderr)
        done = self.start("live", "ring.toml", "--interface", "nowhere0")
        self.ends(done, 2)
        self.assertIn("the network interface 'nowhere0' cannot be used", done.trouble())

    def test_a_typo(self):
        file = self.write("bad.toml", RING.replace("topology =", "topolgy ="))
        for words in [["world"], ["live"], ["agent", "--id", "0"]]:
            self.bad("bad.toml:9: unknown key 'topolgy' in [radio]; did you mean 'topology'?", words[0], file,
                     *words[1:])
            self.bad("nowhere.toml: ", words[0], "nowhere.toml", *words[1:])

    def test_numbers_out_of_range(self):
        self.bad("there is no agent 4: the scenario has 4, from 0 on", "agent", "ring.toml", "--id", "4", "--fleet",
                 self.fleet)
        for words in [["--speed", "0"], ["--speed", "-1"], ["--domain", "231"], ["--radio", "smoke"],
                      ["--lockstep", "--speed", "2"]]:
            done = self.command("live", "ring.toml", *words, "--fleet", self.fleet)
            self.assertEqual((done.returncode, done.stdout), (2, ""), f"{words}: {done.stderr}")
            self.assertIn(words[0], done.stderr)


class TwoFleets(LiveBed):
    def test_do_not_mix(self):
        other = self.fleet + "-b"  # one name is the beginning of the other
        mine = self.start("live", "ring.toml", "--lockstep", "--digest")
        theirs = self.start("live", "ring.toml", "--lockstep", "--digest", "--seed", 2, fleet=other)
        self.ends(mine)
        self.ends(theirs)
        self.assertEqual(mine.text(), self.good("run", "ring.toml", "--digest"))
        self.assertEqual(theirs.text(), self.good("run", "ring.toml", "--digest", "--seed", "2"))

    def test_an_agent_of_another_fleet_or_domain_is_not_heard(self):
        words = ["ring.toml", "--patience", 1.0]
        world = self.start("world", *words)
        strangers = [self.start("agent", *words, "--id", 0, fleet=self.fleet + "-b"),
                     self.start("agent", *words, "--id", 0, "--domain", 78)]
        for stranger in strangers:
            self.ends(stranger, 1)
            self.assertIn("no world of fleet", stranger.trouble())
        self.ends(world, 1)
        self.assertIn("these agents have not come: 0, 1, 2, 3", world.trouble())


if __name__ == "__main__":
    unittest.main()
