"""Real logs: a small generated data set everywhere, the real one where it is at hand."""
import json
import math
import unittest

from bed import SOURCE, Bed

REAL = SOURCE.parent / "shared" / "data" / "mrclam6"
START = 1248444175


class Generated(Bed):
    """Five robots stand still and see three landmarks perfectly."""

    def data_set(self, spoil=None):
        folder = self.dir / "small"
        folder.mkdir(exist_ok=True)
        marks = {6: (1.0, 2.0), 7: (-2.0, 0.5), 8: (3.0, -1.0)}
        subjects = range(1, 9)
        (folder / "Barcodes.dat").write_text("# s b\n" + "".join(f"{s}\t{s + 50}\n" for s in subjects))
        (folder / "Landmark_Groundtruth.dat").write_text(
            "".join(f"{s}\t{x}\t{y}\t0.0001\t0.0001\n" for s, (x, y) in marks.items()))
        for robot in range(1, 6):
            pose = (0.3 * robot, -0.2 * robot, 0.5 * robot)
            truth = "".join(f"{START + t / 4:.3f}\t{pose[0]}\t{pose[1]}\t{pose[2]}\n" for t in range(240))
            (folder / f"Robot{robot}_Groundtruth.dat").write_text(truth)
            lines = []
            for t in range(1, 55):
                subject = 6 + (t + robot) % 3
                dx, dy = marks[subject][0] - pose[0], marks[subject][1] - pose[1]
                bearing = math.atan2(dy, dx) - pose[2]
                lines.append(f"{START + t}.100\t{subject + 50}\t{math.hypot(dx, dy):.6f}\t{bearing:.6f}\n")
            lines.append(f"{START + 55}.000\t99\t1.0\t0.0\n")
            lines.append(f"{START + 55}.000\t51\t1.0\t0.0\n")
            (folder / f"Robot{robot}_Measurement.dat").write_text("".join(lines))
        if spoil:
            file, line, text = spoil
            content = (folder / file).read_text().split("\n")
            content[line - 1] = text
            (folder / file).write_text("\n".join(content))

    def words(self, *more):
        return [SOURCE / "scenarios/mrclam/mrclam.toml", "--set", "world.log.directory=small", *more]

    def test_perfect_sightings_lead_to_the_landmarks_and_skips_are_counted(self):
        self.data_set()
        shown = json.loads(self.good("run", *self.words("--json")))
        self.assertEqual(len(shown["agents"]), 6)
        for agent in shown["agents"]:
            self.assertLess(agent["scalars"]["distance_error_m"], 1e-5)
            if agent["id"] >= 0:
                self.assertEqual(agent["scalars"]["measurements"], 54)
                self.assertEqual(agent["scalars"]["log_skipped_unknown_barcode"], 1)
                self.assertEqual(agent["scalars"]["log_skipped_robot_sighting"], 1)
        self.assertAlmostEqual(shown["end_s"], 53.9)

    def test_bad_logs_are_named_with_file_and_line(self):
        for spoil, message in [
                (("Robot2_Measurement.dat", 3, f"{START + 2}.100\t57"), "Robot2_Measurement.dat:3: "),
                (("Robot2_Measurement.dat", 4, f"{START + 1}.100\t57\t1.0\t0.0"), "time goes backwards"),
                (("Robot3_Groundtruth.dat", 9, "1248444170.0\t0\t0\t0"), "Robot3_Groundtruth.dat:9: ")]:
            self.data_set(spoil)
            self.bad(message, "run", *self.words())

    def test_missing_files_and_folders_are_named(self):
        self.bad("small", "run", *self.words())
        self.data_set()
        (self.dir / "small/Robot4_Measurement.dat").unlink()
        self.bad("Robot4_Measurement.dat", "run", *self.words())


@unittest.skipUnless(REAL.is_dir(), f"the real logs are not at {REAL}")
class Real(Bed):
    def error(self, rule, topology):
        words = ["--set", f"world.log.directory={REAL}", "--set", f"agents.estimator.fusion={rule}",
                 "--set", f"radio.topology={topology}", "--set", "record.ledger=off", "--json"]
        shown = json.loads(self.good("run", SOURCE / "scenarios/mrclam/mrclam.toml", *words))
        agents = [a["scalars"] for a in shown["agents"] if a["id"] >= 0]
        return (sum(a["distance_error_m"] for a in agents) / 5,
                max(a["final_claimed_sigma_m"] for a in agents))

    def test_errors_are_within_a_fifth_of_the_published_ones(self):
        for rule, topology, wanted in [("none", "ring", 0.072), ("ci-det", "ring", 0.039),
                                       ("naive", "ring", 0.15), ("channel", "line", 0.049)]:
            distance, sigma = self.error(rule, topology)
            self.assertLess(abs(distance - wanted), 0.2 * wanted, f"{rule} {topology}: {distance}")
            if rule == "naive":
                self.assertLess(sigma, 1e-30)


if __name__ == "__main__":
    unittest.main()
