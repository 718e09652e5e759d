"""Bad input ends with exit code 2, one line that says what is wrong and where, and nothing written."""
import sqlite3
import unittest

from bed import RING, STUDY, Bed


class BadScenario(Bed):
    def ring_with(self, old, new):
        self.assertIn(old, RING)
        return self.write("bad.toml", RING.replace(old, new))

    def test_unknown_key_offers_the_nearest(self):
        file = self.ring_with("topology =", "topolgy =")
        self.bad("bad.toml:9: unknown key 'topolgy' in [radio]; did you mean 'topology'?", "run", file)

    def test_wrong_type(self):
        file = self.ring_with("250_000", '"fast"')
        self.bad('bad.toml:10: radio.rate_bps = "fast": expected a number, found a string', "run", file)

    def test_negative_rate(self):
        file = self.ring_with("250_000", "-1")
        self.bad("bad.toml:10: radio.rate_bps = -1", "run", file)

    def test_probability_above_one(self):
        file = self.ring_with("0.1", "1.5")
        self.bad("bad.toml:11: radio.loss.probability = 1.5", "run", file, "--out", "x.db")

    def test_zero_agents(self):
        file = self.ring_with("count = 4", "count = 0")
        self.bad("bad.toml:14: agents[0].count = 0", "run", file)
        nobody = self.write("nobody.toml", RING.split("[[agents]]")[0])
        self.bad("at least one agent", "run", nobody)

    def test_an_edge_to_an_agent_that_is_not_there(self):
        file = self.ring_with('topology = "ring"', 'topology = "edges"\nedges = [[0, 1], [1, 7]]')
        self.bad("bad.toml:10: ", "run", file)
        self.bad("7", "run", file)

    def test_not_toml(self):
        file = self.write("bad.toml", "duration_s = = 3\n")
        self.bad("bad.toml:1: ", "run", file)

    def test_no_such_file(self):
        self.bad("nowhere.toml: ", "run", "nowhere.toml")
        self.bad("nowhere.toml: ", "check", "nowhere.toml")

    def test_nothing_to_estimate(self):
        text = RING.replace('targets = [{ name = "alarm", position_m = [40.0, 25.0] }]', "")
        text = text.replace('kind = "position", period_s = 1.0, sigma_m = 5.0', 'kind = "none"')
        self.bad("nothing to estimate", "run", self.write("bad.toml", text))

    def test_an_explorer_that_no_run_could_bear(self):
        text = ("duration_s = 9\nworld = { area = { cell_m = 5 } }\n[[agents]]\nkind = \"explorer\"\n"
                "position_m = [1, 1]\nmotion = { kind = \"steered\", altitude_m = 10 }\n"
                "exploration = { choice = \"random-walk\", speed_m_per_s = SPEED }\n")
        self.good("run", self.write("good.toml", text.replace("SPEED", "5")))
        file = self.write("bad.toml", text.replace("SPEED", "1e10"))
        self.bad("bad.toml:7: agents[0].exploration.speed_m_per_s: a cell (5.0 m) must take", "run", file)

    def test_a_plan_that_is_wrong_or_not_there(self):
        text = ("duration_s = 9\nworld = { plan = { file = \"floor.txt\" } }\n[[agents]]\nkind = \"forager\"\n"
                "robot = { start = \"A\" }\ntask = { events = [\"A\", \"B\"] }\ntrails = {}\n")
        file = self.write("scenario.toml", text)
        self.bad('scenario.toml:2: world.plan.file: there is no file "', "check", file)
        self.write("floor.txt", "#####\n#A.A#\n#####\n")
        self.bad("floor.txt:2: column 4: place A is also in line 2; each letter is allowed once", "check", file)
        self.write("floor.txt", "#####\n#A.C#\n#####\n")
        self.bad('scenario.toml:6: agents[0].task.events[1] = "B": unknown place of the plan; allowed: A, C',
                 "check", file)
        self.write("floor.txt", "#####\n#A.B#\n#####\n")
        self.good("check", file)

    def test_set_without_equals(self):
        self.bad("--set", "run", "ring.toml", "--set", "radio.rate_bps")
        self.bad("key=value", "run", "ring.toml", "--set", "radio.rate_bps")

    def test_set_of_an_unknown_key_names_set_in_place_of_a_line(self):
        self.bad("--set radio.rate_bbs=1: unknown key 'radio.rate_bbs'; did you mean 'radio.rate_bps'?", "run",
                 "ring.toml", "--set", "radio.rate_bbs=1")

    def test_set_out_of_range(self):
        self.bad("--set radio.rate_bps=-1", "run", "ring.toml", "--set", "radio.rate_bps=-1")


class BadStudy(Bed):
    def study_with(self, old, new):
        self.assertIn(old, STUDY)
        return self.write("bad.study.toml", STUDY.replace(old, new))

    def test_an_empty_axis(self):
        file = self.study_with("[0.0, 0.3]", "[]")
        self.bad("bad.study.toml:6: axis 'loss' has no values", "sweep", file)

    def test_an_axis_whose_key_does_not_exist(self):
        file = self.study_with("radio.loss.probability", "radio.loss.probabilty")
        self.bad("bad.study.toml:6: ", "sweep", file)
        self.bad("did you mean 'radio.loss.probability'?", "sweep", file)

    def test_a_claim_on_an_unknown_metric(self):
        file = self.study_with('"ledger_anees"', '"ledger_anes"')
        self.bad("bad.study.toml:11: ", "sweep", file)
        self.bad("did you mean 'ledger_anees'?", "check", file)

    def test_a_scenario_is_no_study(self):
        self.bad("ring.toml: is a scenario, not a study", "sweep", "ring.toml")


class BadDatabase(Bed):
    def test_not_a_database(self):
        self.write("text.db", "hello " * 1000)
        self.bad("text.db: is not", "diff", "text.db", "text.db")
        self.bad("text.db: is not", "compare", "text.db", "--metric", "nees", "--by", "rule")
        self.bad("text.db: is not", "export", "text.db", "--csv", "out")
        self.bad("text.db: is not", "run", "ring.toml", "--out", "text.db")
        self.bad("text.db: is not", "sweep", "ring.study.toml", "--out", "text.db")

    def test_no_database(self):
        self.bad("none.db: ", "diff", "none.db", "none.db")

    def test_another_schema_version(self):
        self.good("run", "ring.toml", "--out", "old.db")
        with sqlite3.connect(self.dir / "old.db") as database:
            database.execute("PRAGMA user_version = 77")
        database.close()
        self.bad("old.db: has schema version 77", "diff", "old.db", "old.db")
        self.bad("old.db: has schema version 77", "run", "ring.toml", "--out", "old.db")

    def test_a_place_that_cannot_be_written(self):
        self.write("file", "")
        self.bad("file/x.db: cannot be", "run", "ring.toml", "--out", "file/x.db")
        self.bad("missing/x.db: cannot be", "sweep", "ring.study.toml", "--out", "missing/x.db")
        self.good("run", "ring.toml", "--out", "a.db")
        self.bad("file/csv: cannot be", "export", "a.db", "--csv", "file/csv")
        self.bad("file/results/rumour: cannot be", "reproduce", "rumour/trees", "--out", "file/results")

    def test_a_study_that_has_changed_does_not_mix_with_old_runs(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        self.write("ring.toml", RING.replace("sigma_m = 5.0", "sigma_m = 6.0"))
        self.bad("made from other settings", "sweep", "ring.study.toml", "--out", "a.db")
        self.write("ring.study.toml", STUDY.replace("0.3]", "0.4]"))
        self.bad("a.db: ", "sweep", "ring.study.toml", "--out", "a.db")

    def test_compare_offers_the_nearest_names(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        self.bad("did you mean 'nees'?", "compare", "a.db", "--metric", "ness", "--by", "rule")
        self.bad("did you mean 'rule'?", "compare", "a.db", "--metric", "nees", "--by", "rul")


class BadCommandLine(Bed):
    def refused(self, *words):
        done = self.command(*words)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertNotEqual(done.stderr, "")

    def test_words_that_are_no_verb_or_option(self):
        self.refused()
        self.refused("rnu")
        self.refused("run")
        self.refused("run", "ring.toml", "--sed", "3")
        self.refused("run", "ring.toml", "--seed", "three")
        self.refused("sweep", "ring.study.toml", "--jobs", "0")
        self.refused("list", "rulez")

    def test_an_unknown_theme(self):
        self.bad("there are: lost, merino, mrclam, radio, rumour", "reproduce", "rumor")
        self.bad("'rumour/tree'; there are: rumour/dropouts-bitrate, rumour/dropouts-bursts", "reproduce",
                 "rumour/tree")

    def test_a_log_that_was_not_given(self):
        self.bad("--data DIR", "reproduce", "mrclam")
        self.bad("nowhere", "reproduce", "mrclam", "--data", "nowhere")


if __name__ == "__main__":
    unittest.main()
