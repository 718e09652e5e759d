"""A small study of foragers on a floor, with values that can be worked out by hand."""

import sqlite3

from small_study import WithDatabase  # first: it makes the scripts known

import data

STUDY = """scenario = "floor.toml"
[axes]
method = { points = [
  { label = "plain", set = {} },
  { label = "search", set = { "agents.trails.laying" = "completed", "world.plan.barriers" = [] } },
] }
robots = { key = "agents.count", values = [1, 2] }
"""
SCENARIO = """duration_s = 90
[world.plan]
file = "floor.txt"
cell_m = 2.0
places = [{ name = "dock", position_m = [3.0, 1.0] }]
barriers = [{ corner_m = [6.0, 4.0], opposite_m = [4.0, 2.0], from_s = 50.0 }]
[[world.sources]]
name = "B"
moves = [{ at_s = 70.0, place = "dock" }]
[[agents]]
kind = "forager"
count = 2
robot = { start = "A" }
task = { events = ["A", "B"] }
"""
# 12 × 6 m; the upper line is y = 4 … 6 m.
FLOOR = "######\n#A  B#\n# ####\n"
END_S = 90.0
TRIP_S = 20.0


def arrivals(method, repetition, agent):
    """[(instant, length)]: everybody needs 20 s a trip and sets off again at once, the second robot 5 s later. Under
    plain the third repetition's robots never get to a third trip."""
    count = 2 if method == "plain" and repetition == 3 else 4
    base = 12.0 if method == "plain" else 24.0
    return [(TRIP_S * n + 5.0 * agent, base / n + repetition + 10.0 * agent) for n in range(1, count + 1)]


def events_of(run, method, repetition, agents):
    for agent in range(agents):
        for n, (t_s, length_m) in enumerate(arrivals(method, repetition, agent), 1):
            yield run, t_s, agent, "arrived", f"B {n} {length_m:f} {TRIP_S:f}"
    # Crumbs laid on the way east at 10, 30, 50 and 70 s, by the first robot, told then or at the end of its trip.
    for n in range(1, 5):
        laid_s = TRIP_S * n - 10.0
        told_s, event, d = (laid_s, "A", 10.0) if method == "plain" else (laid_s + 10.0, "B", 10.0)
        yield run, told_s, 0, "crumb", f"{event} {6.0 + n:f} 5.000000 0.000000 {d:f}"


def series_of(run, method, repetition, agents):
    """Each drives from A to B at constant speed in a trip; whoever has no more trips stands still in the middle."""
    for agent in range(agents):
        ends = [t_s for t_s, _ in arrivals(method, repetition, agent)]
        for t_s in (2.5 * k for k in range(37)):
            into = t_s - max([0.0 + 5.0 * agent, *[end for end in ends if end <= t_s]])
            share = min(max(into / TRIP_S, 0.0), 1.0 if t_s < ends[-1] else 0.5)
            yield run, t_s, agent, "", "robot_x_m", 3.0 + 6.0 * share
            yield run, t_s, agent, "", "robot_y_m", 5.0


class WithForagers(WithDatabase):
    def make_foragers(self, study=STUDY, scenario=SCENARIO, floor=FLOOR, methods=("plain", "search"), robots=(1, 2),
                      series=True):
        """Methods × numbers of robots × 3 repetitions."""
        for name, text in (("lost.study.toml", study), ("floor.toml", scenario), ("floor.txt", floor)):
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
            CREATE TABLE event(run, t_s, agent, kind, detail);
            CREATE TABLE series(run, t_s, agent, subject, name, value);
            INSERT INTO study VALUES (1, 'lost', 'elsewhere/lost.study.toml', '');"""
        )
        run = 0
        for method in methods:
            for count in robots:
                for repetition in (1, 2, 3):
                    run += 1
                    connection.execute("INSERT INTO run VALUES (?, 'lost', ?, 1, 'ok')", (run, repetition))
                    axes = [(run, "method", method), (run, "robots", count)]
                    connection.executemany("INSERT INTO axis VALUES (?, ?, ?)", axes)
                    agents = [(run, a, f"forager{a}", "forager") for a in range(count)]
                    agents.append((run, -1, "central", "central"))
                    connection.executemany("INSERT INTO agent VALUES (?, ?, ?, ?)", agents)
                    connection.executemany("INSERT INTO event VALUES (?, ?, ?, ?, ?)",
                                           events_of(run, method, repetition, count))
                    connection.executemany("INSERT INTO scalar VALUES (?, ?, ?, ?)",
                                           scalars_of(run, method, repetition, count))
                    if series:
                        connection.executemany("INSERT INTO series VALUES (?, ?, ?, ?, ?, ?)",
                                               series_of(run, method, repetition, count))
        connection.commit()
        connection.close()


def scalars_of(run, method, repetition, agents):
    """Of each robot and of the team; under plain nobody ever gets over what happened but in the first repetition."""
    trips = [float(len(arrivals(method, repetition, agent))) for agent in range(agents)]
    never = float("inf")
    for agent, count in enumerate(trips):
        yield run, agent, "trips", count
    yield run, -1, "trips", sum(trips)
    yield run, -1, "recovery_s", 30.0 if repetition == 1 else never if method == "plain" else 50.0
