"""Small databases of the studies of scenarios/radio, with values that can be worked out by hand."""

import sqlite3

from small_study import WithDatabase  # first: it makes the scripts known

import data


def make_radio_database(file, study, cells, agents, repetitions=3, links=()):
    """`cells`: (axis → label, (agent, name) → value) of each; repetition r adds r − 2 percent to a
    value. `links`: (sender, receiver, fate, packets) of every run."""
    connection = sqlite3.connect(file)
    connection.executescript(
        f"""PRAGMA application_id = {data.APPLICATION_ID};
        PRAGMA user_version = {data.SCHEMA_VERSION};
        CREATE TABLE run(id INTEGER PRIMARY KEY, study, repetition, status);
        CREATE TABLE axis(run, name, value);
        CREATE TABLE agent(run, id, name, kind);
        CREATE TABLE scalar(run, agent, name, value);
        CREATE TABLE link(run, sender, receiver, fate, packets);
        CREATE TABLE series(run, t_s, agent, subject, name, value);"""
    )
    run = 0
    for labels, values in cells:
        for repetition in range(1, repetitions + 1):
            run += 1
            connection.execute("INSERT INTO run VALUES (?, ?, ?, 'ok')", (run, study, repetition))
            connection.executemany(
                "INSERT INTO axis VALUES (?, ?, ?)", [(run, *label) for label in labels.items()]
            )
            connection.executemany(
                "INSERT INTO agent VALUES (?, ?, ?, 'source')",
                [(run, i, name) for i, name in enumerate(agents)],
            )
            factor = 1.0 + 0.01 * (repetition - 2)
            connection.executemany(
                "INSERT INTO scalar VALUES (?, ?, ?, ?)",
                [
                    (run, agent, name, None if value is None else factor * value)
                    for (agent, name), value in values.items()
                ],
            )
            connection.executemany(
                "INSERT INTO link VALUES (?, ?, ?, ?, ?)", [(run, *link) for link in links]
            )
    connection.commit()
    connection.close()


class WithRadioDatabase(WithDatabase):
    def distance(self, **options):
        """Two models at two distances; at 80 m nobody is in reach of the disk."""
        cells = [
            ({"model": model, "distance_m": distance}, {(0, "delivery_ratio"): ratio})
            for model, ratios in (("disk", (1.0, None)), ("shadowed", (0.9, 0.1)))
            for distance, ratio in zip((30.0, 80.0), ratios)
        ]
        links = [(0, 1, "delivered", 30), (0, 1, "lost", 10), (0, 2, "lost", 7)]
        make_radio_database(self.file, "distance", cells, ("sender", "listener0"), links=links)

    def delay(self):
        cells = [
            (
                {"sizes": sizes, "queue": queue, "load": load},
                {(0, "queue_delay_mean_s"): load * 1e-3, (0, "delivery_ratio"): 0.95},
            )
            for sizes in ("fixed", "exponential")
            for queue in ("unbounded", "8 packets")
            for load in (0.5, 0.9, 1.2)
            if queue != "unbounded" or load < 1.0
        ]
        make_radio_database(self.file, "delay", cells, ("sender", "sink"))

    def aloha(self):
        cells = [
            ({"stations": n, "probability": p}, {(0, "goodput_bps"): 0.25 * 8184 / 8.584e-3})
            for n, p in ((2, 0.5), (2, 0.9), (50, 0.02))
        ]
        make_radio_database(self.file, "aloha", cells, ("sink", "station0"))

    def carrier_sense(self):
        values = {
            (0, "goodput_bps"): 8e5, (0, "frames"): 0.0, (1, "frames"): 50.0,
            (0, "packets_delivered"): 0.0, (1, "packets_delivered"): 40.0,
        }
        cells = [({"window": w, "stations": n}, values) for w in (16, 32) for n in (1, 5)]
        make_radio_database(self.file, "carrier-sense", cells, ("sink", "station0"))

    def sharing(self):
        cells = [
            (
                {"model": model, "load": load},
                {(0, "goodput_bps"): 3e5, (0, "delay_mean_s"): 0.02},
            )
            for model in ("none", "slotted-aloha", "carrier-sense")
            for load in (0.5, 2.0)
        ]
        make_radio_database(self.file, "sharing", cells, ("sink", "station0"))
