"""Trips of foragers, from the events that a run records whenever one is where it wanted to be."""

from dataclasses import dataclass

import numpy as np

from data import UserError

# A way that leaps further than so many usual steps was not driven: the robot was carried.
LEAP = 20.0
ROUNDING_S = 1e-5  # of durations in events


@dataclass
class Trip:
    """Number `number` of a robot, from 1. The last one may be under way still: it has no event and no length."""

    agent: int
    number: int
    event: str
    from_s: float
    to_s: float
    length_m: float

    @property
    def arrived(self):
        return bool(self.event)


def _trip(agent, t_s, detail):
    event, number, length_m, duration_s = detail.split(" ")
    return Trip(agent, int(number), event, t_s - float(duration_s), t_s, float(length_m))


def of_runs(chosen):
    """{run: its trips in time} of all runs. @raises UserError if there are none at all."""
    found = {run: [] for (run,) in chosen.rows("SELECT run FROM temp.chosen ORDER BY run")}
    for run, t_s, agent, detail in chosen.rows(
        "SELECT c.run, e.t_s, e.agent, e.detail FROM temp.chosen c CROSS JOIN event e ON e.run = c.run"
        " WHERE e.kind = 'arrived' ORDER BY c.run, e.t_s, e.agent"
    ):
        found[run].append(_trip(agent, t_s, detail))
    if not any(found.values()):
        raise UserError(f"{chosen.file}: no forager of {chosen.study!r} ever arrived, by these runs' events")
    return found


def of_run(chosen, run):
    """Trips of one run in time; none if nobody arrived."""
    return [
        _trip(agent, t_s, detail)
        for t_s, agent, detail in chosen.rows(
            "SELECT t_s, agent, detail FROM event WHERE run = ? AND kind = 'arrived' ORDER BY t_s, agent", (run,)
        )
    ]


class Ways:
    """Where the robots of one run were: {agent: (t, x, y)}."""

    def __init__(self, chosen, run):
        columns = {}
        for name, t_s, agent, value in chosen.rows(
            "SELECT name, t_s, agent, value FROM series WHERE run = ? AND name IN ('robot_x_m', 'robot_y_m')"
            " ORDER BY t_s",
            (run,),
        ):
            columns.setdefault(agent, {"robot_x_m": [], "robot_y_m": []})[name].append((t_s, value))
        self.at = {}
        for agent, both in sorted(columns.items()):
            x, y = (np.array(both[name], dtype=float) for name in ("robot_x_m", "robot_y_m"))
            if x.shape == y.shape:
                self.at[agent] = x[:, 0], x[:, 1], y[:, 1]
        if not self.at:
            raise UserError(
                f"{chosen.file}: no series 'robot_x_m' and 'robot_y_m' in these runs of {chosen.study!r};"
                " name them under [record] in the scenario"
            )
        self.end_s = max(t[-1] for t, _, _ in self.at.values())

    def between(self, agent, from_s, to_s):
        """(t, x, y) from an instant to before another. Samples at the end of a trip may come after the robot was
        carried away; NaN lies where it leapt."""
        t, x, y = self.at[agent]
        inside = (t >= from_s - ROUNDING_S) & (t < to_s - ROUNDING_S)
        t, x, y = t[inside], x[inside], y[inside]
        step = np.hypot(np.diff(x), np.diff(y))
        moved = step[step > 0.0]
        leaps = np.nonzero(step > LEAP * np.median(moved))[0] + 1 if len(moved) else []
        return np.insert(t, leaps, t[leaps]), np.insert(x, leaps, np.nan), np.insert(y, leaps, np.nan)

    def under_way(self, trips):
        """For each robot the trip that the run's end cut off."""
        last = {trip.agent: trip for trip in trips}
        return [
            Trip(agent, last[agent].number + 1 if agent in last else 1, "",
                 last[agent].to_s if agent in last else 0.0, np.inf, np.nan)
            for agent in self.at
        ]
