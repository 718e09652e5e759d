"""A small study of vehicles with certainty grids, with values that can be worked out by hand."""

import sqlite3

from small_study import WithDatabase  # first: it makes the scripts known

import data

STUDY = """scenario = "area.toml"
[set]
"world.targets[1].position_m" = [100.0, 0.5]
[axes]
rule = { key = "agents.grid.fusion", values = ["none", "naive"] }
talk = { points = [{ label = 5, set = {} }, { label = 20, set = { "world.area.cell_m" = 2.0 } }] }
"""
# The second target lies outside of the area.
SCENARIO = """[world]
area = { columns = 4, rows = 3, cell_m = 2.0, origin_m = [10.0, 0.0] }
targets = [{ name = "fire", position_m = [13.0, 3.5] }, { name = "smoke", position_m = [11.0, 0.5] }]
"""
TARGET = (1, 1)  # column, row
THRESHOLDS = ("0.5", "0.8", "0.95")


def probability(rule, column, row):
    """Of agents; the central grid has what `none` has."""
    if (column, row) == TARGET:
        return 0.9
    if (column, row) == (0, 0) and rule == "naive":
        return 0.85  # a corner away from the target
    return 0.6 if (column, row) == (3, 2) else 0.1


def rows_of(run, rule, talk, repetition, t_s):
    for agent in (-1, 0, 1):
        told = rule if agent >= 0 else "none"
        if agent >= 0:
            yield run, t_s, agent, "", "kl_to_central_nats", t_s * (repetition + agent)
            yield run, t_s, agent, "", "place_x_m", 11.0 + 0.1 * t_s
            yield run, t_s, agent, "", "place_y_m", 1.0 + agent
        else:
            yield run, t_s, agent, "", "disagreement_probability", 0.01 * t_s
        cells = [(c, r) for r in range(3) for c in range(4)]
        for threshold in THRESHOLDS:
            over = [cell for cell in cells if probability(told, *cell) > float(threshold)]
            yield run, t_s, agent, threshold, "cells_detected_share", float(TARGET in over)
            false = len([cell for cell in over if cell != TARGET])
            # With rare talk the third repetition has no false alarms.
            yield run, t_s, agent, threshold, "cells_false_share", false / 11.0 * (talk == 5 or repetition < 3)
        if t_s == 10.0:
            for column, row in cells:
                p = probability(told, column, row)
                values = {"cell_probability": p, "cell_alpha": 40.0 * p, "cell_beta": 40.0 - 40.0 * p}
                for name, value in values.items():
                    yield run, t_s, agent, f"{column},{row}", name, value


def scalars_of(run, rule, repetition):
    """In the second repetition one vehicle never finds all, in the third none does."""
    never = float("inf")
    yield run, -1, "alarms_found_s", 2.0
    yield run, 0, "alarms_found_s", (4.0, 8.0, never)[repetition - 1]
    yield run, 1, "alarms_found_s", 6.0 if repetition == 1 else never
    for agent in (0, 1):
        yield run, agent, "bytes_sent", 100.0 * (1 + agent) * repetition * (rule != "none")


class WithGrids(WithDatabase):
    def make_grids(self, study=STUDY, talks=(5,), leave_out=(), skip=()):
        """2 rules × talks × 3 repetitions, two vehicles and the central grid."""
        for name, text in (("grids.study.toml", study), ("area.toml", SCENARIO)):
            with open(self.path(name), "w", encoding="utf-8") as stream:
                stream.write(text)
        connection = sqlite3.connect(self.file)
        connection.executescript(
            f"""PRAGMA application_id = {data.APPLICATION_ID};
            PRAGMA user_version = {data.SCHEMA_VERSION};
            CREATE TABLE study(id INTEGER PRIMARY KEY, name, file, config);
            CREATE TABLE run(id INTEGER PRIMARY KEY, study, repetition, seed, status);
            CREATE TABLE axis(run, name, value);
            CREATE TABLE agent(run, id, name, kind);
            CREATE TABLE scalar(run, agent, name, value);
            CREATE TABLE series(run, t_s, agent, subject, name, value);
            INSERT INTO study VALUES (1, 'grids', 'elsewhere/grids.study.toml', '');"""
        )
        run = 0
        for rule in ("none", "naive"):
            for talk in talks:
                for repetition in (1, 2, 3):
                    run += 1
                    if (rule, talk) in skip:
                        continue
                    row = (run, repetition, -repetition)
                    connection.execute("INSERT INTO run VALUES (?, 'grids', ?, ?, 'ok')", row)
                    axes = [(run, "rule", rule), (run, "talk", talk)]
                    connection.executemany("INSERT INTO axis VALUES (?, ?, ?)", axes)
                    agents = [(run, -1, "central", "central")]
                    agents += [(run, a, f"uav{a + 1}", "explorer") for a in (0, 1)]
                    connection.executemany("INSERT INTO agent VALUES (?, ?, ?, ?)", agents)
                    scalars = scalars_of(run, rule, repetition)
                    connection.executemany("INSERT INTO scalar VALUES (?, ?, ?, ?)", scalars)
                    for t_s in (0.0, 10.0):
                        connection.executemany(
                            "INSERT INTO series VALUES (?, ?, ?, ?, ?, ?)",
                            [r for r in rows_of(run, rule, talk, repetition, t_s) if r[4] not in leave_out],
                        )
        connection.commit()
        connection.close()
