"""What each verb prints and leaves behind."""
import csv
import json
import os
import sqlite3
import subprocess
import unittest

from bed import RING, SOURCE, Bed


class Verbs(Bed):
    def test_every_verb_has_help_with_examples(self):
        overview = self.good("--help")
        for verb in ["run", "sweep", "compare", "reproduce", "check", "list", "diff", "export"]:
            self.assertIn(verb, overview)
            help_text = self.good(verb, "--help")
            self.assertIn("Examples:", help_text)
            self.assertIn(f"hearsay {verb} ", help_text)

    def test_run_prints_a_table_and_a_digest(self):
        text = self.good("run", "ring.toml")
        self.assertIn("estimator3", text)
        self.assertIn("central", text)
        self.assertIn("time reached at 30 s", text)
        digest = self.good("run", "ring.toml", "--digest").strip()
        self.assertRegex(digest, r"^xxh3-128/1:[0-9a-f]{32}\+[0-9a-f]{32}$")
        self.assertIn(digest, text)

    def test_seeds_and_settings_change_the_digest_and_the_ledger_does_not(self):
        digest = self.good("run", "ring.toml", "--digest").strip()
        self.assertNotEqual(digest, self.good("run", "ring.toml", "--digest", "--seed", "2").strip())
        naive = self.good("run", "ring.toml", "--digest", "--set", "agents.estimator.fusion=naive")
        self.assertNotEqual(digest, naive.strip())
        off = self.good("run", "ring.toml", "--digest", "--set", "record.ledger=off").strip()
        self.assertEqual(off, digest.split("+")[0])

    def test_run_as_json_and_in_a_database_say_the_same(self):
        shown = json.loads(self.good("run", "ring.toml", "--json", "--out", "a.db"))
        database = sqlite3.connect(self.dir / "a.db")
        (digest, reason, seed) = database.execute("SELECT digest, reason, seed FROM run").fetchone()
        self.assertEqual((shown["digest"], shown["reason"], shown["seed"]), (digest, reason, seed))
        for agent in shown["agents"]:
            for name, value in agent["scalars"].items():
                row = database.execute("SELECT value FROM scalar WHERE agent = ? AND name = ?",
                                       (agent["id"], name)).fetchone()
                self.assertEqual(row[0], value)
        database.close()

    def test_runs_append_and_diff_names_the_first_row_that_differs(self):
        self.good("run", "ring.toml", "--out", "a.db")
        self.good("run", "ring.toml", "--out", "a.db", "--seed", "2")
        self.good("run", "ring.toml", "--out", "b.db")
        self.assertEqual(self.good("diff", "a.db", "b.db", "--run-a", "1", "--run-b", "1"), "the same\n")
        other = self.command("diff", "a.db", "b.db")
        self.assertEqual(other.returncode, 1)
        self.assertIn("run 2", other.stdout)
        differ = self.command("diff", "a.db", "a.db", "--run-a", "1", "--run-b", "2")
        self.assertEqual(differ.returncode, 1)
        self.assertIn(" | ", differ.stdout)

    def test_figure_scripts_read_what_a_sweep_wrote(self):
        self.good("sweep", "ring.study.toml", "--out", "ring.db")
        script = SOURCE / "tools" / "figures" / "table.py"
        drawn = subprocess.run(["/usr/bin/python3", "-B", script, "ring.db", "table.md"], cwd=self.dir,
                               capture_output=True, text=True, timeout=300)
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        table = (self.dir / "table.md").read_text()
        for rule in ["none", "naive", "ci-det"]:
            self.assertIn(rule, table)

    def test_messages_are_kept_on_request(self):
        self.good("run", "ring.toml", "--out", "a.db", "--set", "record.messages=all")
        database = sqlite3.connect(self.dir / "a.db")
        fates = dict(database.execute("SELECT fate, count(*) FROM message GROUP BY fate"))
        for fate, count in fates.items():
            total = database.execute("SELECT sum(value) FROM scalar WHERE name = ?",
                                     (f"packets_{fate}",)).fetchone()[0]
            self.assertEqual(total, count)
        self.assertGreater(fates["delivered"], 20)
        sent, arrived = database.execute("SELECT sent_s, arrived_s FROM message LIMIT 1").fetchone()
        self.assertGreater(arrived, sent)
        database.close()

    def test_export_writes_each_table(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        self.good("export", "a.db", "--csv", "csv")
        with open(self.dir / "csv" / "series.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["run", "t_s", "agent", "subject", "name", "value"])
        database = sqlite3.connect(self.dir / "a.db")
        self.assertEqual(len(rows), database.execute("SELECT count(*) FROM series").fetchone()[0])
        value = database.execute("SELECT value FROM series WHERE run = 1 AND t_s = 30 AND agent = 0 "
                                 "AND name = 'nees'").fetchone()[0]
        exported = [r["value"] for r in rows
                    if (r["run"], float(r["t_s"]), r["agent"], r["name"]) == ("1", 30.0, "0", "nees")]
        self.assertEqual(float(exported[0]), value)
        database.close()

    def test_compare_pairs_repetitions(self):
        self.good("sweep", "ring.study.toml", "--out", "a.db")
        rows = json.loads(self.good("compare", "a.db", "--metric", "fusions", "--by", "rule",
                                    "--baseline", "none", "--json"))
        naive = [row for row in rows if row["rule"] == "naive"]
        self.assertEqual(len(naive), 2)
        for row in naive:
            self.assertEqual((row["verdict"], row["pairs"]), ("higher", 6))
        text = self.good("compare", "a.db", "--metric", "rms_error_m", "--by", "loss")
        self.assertIn("baseline", text)

    def test_list_shows_what_there_is(self):
        rules = json.loads(self.good("list", "rules", "--json"))["rules"]
        gaussian = [rule for rule in rules if not rule["goes with"].startswith("explorer")]
        names = [rule["name"] for rule in gaussian]
        self.assertEqual(names, ["none", "naive", "local-update", "channel", "channel-robust", "ci-det",
                                 "ci-trace", "ci-half", "ci-fixed", "ci-niehsen", "ci-franken-huepper",
                                 "most-certain", "inverse-ci", "ellipsoidal", "ci-batch", "split-ci",
                                 "consensus-information", "hybrid-consensus"])
        for rule in gaussian:
            self.assertIn("static-gaussian", rule["goes with"])
        of_grids = {rule["name"]: rule["goes with"] for rule in rules if rule not in gaussian}
        self.assertEqual(of_grids, {
            **dict.fromkeys(["none", "naive", "channel", "channel-robust", "dictatorship"], "explorer: bernoulli, beta"),
            **dict.fromkeys(["maximum", "strongest", "geometric-mean", "linear-pool"], "explorer: bernoulli"),
            **dict.fromkeys(["elementwise-maximum", "averaged-parameters"], "explorer: beta")})
        for rule in rules:
            self.assertTrue(rule["sends"] and rule["assumes"] and rule["conservative"] and rule["source"])
            self.assertTrue(rule["cost"] and rule["ledger"])
        self.assertIn("rumour/rumour.study.toml", self.good("list", "scenarios"))
        radios = self.good("list", "radios")
        self.assertIn("radio.rate_bps: number, bit/s, > 0, default 1e+06: bits a second", radios)
        self.assertIn('radio.loss.model = "gilbert-elliott"', radios)
        models = json.loads(self.good("list", "radios", "--json"))["radios"]
        bursts = next(m for m in models if m["name"] == "gilbert-elliott")
        self.assertIn("Gilbert", bursts["source"])
        units = {p["name"]: p["unit"] for p in bursts["parameters"]}
        self.assertEqual(units["radio.loss.mean_burst"], "packets")
        self.assertIn("sigma_along_m", self.good("list", "sensors"))
        kinds = [kind["name"] for kind in json.loads(self.good("list", "agents", "--json"))["agents"]]
        self.assertEqual(kinds, ["estimator", "tracker", "localizer", "explorer", "forager", "source"])
        recorded = {name for (name,) in self.scalars()}
        listed = {m["name"] for m in json.loads(self.good("list", "metrics", "--json"))["metrics"]}
        self.assertLessEqual(recorded, listed)

    def scalars(self):
        self.good("run", "ring.toml", "--out", "s.db")
        database = sqlite3.connect(self.dir / "s.db")
        rows = database.execute("SELECT DISTINCT name FROM scalar UNION SELECT name FROM series").fetchall()
        database.close()
        return rows

    def test_reproduce_redoes_a_study_and_goes_on_where_it_stopped(self):
        text = self.good("reproduce", "rumour/trees", "--out", "results", "--strict")
        self.assertIn("1080 runs, 1080 new", text)
        self.assertEqual(text.count("  reproduced  "), 3, text)
        self.assertIn("1080 runs, 0 new", self.good("reproduce", "rumour/trees", "--out", "results"))
        report = json.loads((self.dir / "results/rumour/trees-claims.json").read_text())
        claims = report["claims"] if isinstance(report, dict) else report
        self.assertEqual([c["verdict"] for c in claims], ["reproduced"] * 3)

    def test_a_family_of_studies_is_reproduced_by_its_common_name(self):
        theme = self.dir / "share/scenarios/rings"
        theme.mkdir(parents=True)
        (theme / "ring.toml").write_text(RING)
        for name in ["cuts-one", "cuts-two", "cutsthree", "exact", "exact-more"]:
            (theme / f"{name}.study.toml").write_text('scenario = "ring.toml"\nrepetitions = 2\n')

        def reproduced(what):
            text = self.good("reproduce", what, "--out", "results",
                             env={**os.environ, "HEARSAY_SHARE": str(self.dir / "share")})
            return [line.split(":")[0] for line in text.splitlines() if " runs, " in line]

        self.assertEqual(reproduced("rings/cuts"), ["cuts-one", "cuts-two"])
        self.assertEqual(reproduced("rings/cuts-two"), ["cuts-two"])
        self.assertEqual(reproduced("rings/exact"), ["exact"])
        self.assertEqual(len(reproduced("rings")), 5)

    def test_shipped_files_are_in_order(self):
        files = sorted(str(f) for f in (SOURCE / "scenarios").rglob("*.toml"))
        self.assertGreaterEqual(len(files), 5)
        self.good("check", *files)


if __name__ == "__main__":
    unittest.main()
