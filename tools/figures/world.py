"""The area of a study with certainty grids and where its targets were, from the study file and the
scenario that it names: a database does not hold them."""

import os
import re
import tomllib
from dataclasses import dataclass

import numpy as np

from data import UserError, label_text

SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scenarios")
WORD = 2**64 - 1


@dataclass
class World:
    """Cells of `cell_m` from the corner `origin_m` of least x and y; targets [n, 2] in m."""

    file: str
    columns: int
    rows: int
    cell_m: float
    origin_m: np.ndarray
    targets_m: np.ndarray

    @property
    def extent(self):
        """(x from, x to, y from, y to) in m."""
        x, y = self.origin_m
        return x, x + self.columns * self.cell_m, y, y + self.rows * self.cell_m

    def centres(self):
        """(x of each column, y of each row) in m."""
        return tuple(
            start + self.cell_m * (np.arange(n) + 0.5)
            for start, n in zip(self.origin_m, (self.columns, self.rows))
        )

    def truth(self):
        """[row, column]: whether there is a target. As filters/grid/area.hpp: a cell has its lower
        sides, and what lies outside the area is in no cell."""
        found = np.zeros((self.rows, self.columns), dtype=bool)
        if len(self.targets_m):
            column, row = np.floor((self.targets_m - self.origin_m) / self.cell_m).astype(int).T
            inside = (column >= 0) & (row >= 0) & (column < self.columns) & (row < self.rows)
            found[row[inside], column[inside]] = True
        return found


def threefry(counter, key):
    """Two words of Threefry2x64-13 (Salmon et al., SC 2011), as sim/kernel/random.hpp draws them."""
    schedule = (*key, 0x1BD11BDAA9FC1A22 ^ key[0] ^ key[1])
    a, b = counter[0] + schedule[0] & WORD, counter[1] + schedule[1] & WORD
    for i in range(13):
        turn = (16, 42, 12, 31, 16, 32, 24, 21)[i % 8]
        a = a + b & WORD
        b = ((b << turn | b >> 64 - turn) & WORD) ^ a
        if i % 4 == 3:
            step = (i + 1) // 4
            a = a + schedule[step % 3] & WORD
            b = b + schedule[(step + 1) % 3] + step & WORD
    return a, b


def purpose(name):
    """64-bit FNV-1a of a text."""
    value = 0xCBF29CE484222325
    for byte in name.encode():
        value = (value ^ byte) * 0x100000001B3 & WORD
    return value


def drawn_place(seed, number, columns, rows, cell_m, origin_m):
    """Where target `number` is if the scenario does not say: as target_places_of() of
    scenarios/explorers.cpp."""
    words = threefry((0, number), (seed, purpose("target place")))
    sides = np.array([columns * cell_m, rows * cell_m])
    return origin_m + sides * np.array([(word >> 11) * 2.0**-53 for word in words])


def seed_of(chosen, run):
    """From 0 to 2^64 − 1; it is stored as signed."""
    return chosen.rows("SELECT seed FROM run WHERE id = ?", (run,))[0][0] & WORD


def _toml(file):
    try:
        with open(file, "rb") as stream:
            return tomllib.load(stream)
    except OSError as error:
        raise UserError(f"{file}: cannot be read ({error.strerror})") from error
    except ValueError as error:
        raise UserError(f"{file}: {error}") from error


def find_study(chosen, given):
    """The study file: `given`, or as it was given to the sweep, or of that name beside the database or
    among the scenarios."""
    found = chosen.rows("SELECT file FROM study WHERE name = ?", (chosen.study,))
    named = found[0][0] if found else f"{chosen.study}.study.toml"
    folders = [os.path.dirname(os.path.abspath(chosen.file))]
    if os.path.isdir(SCENARIOS):
        folders += [os.path.join(SCENARIOS, f) for f in sorted(os.listdir(SCENARIOS))]
    places = [named, *(os.path.join(f, os.path.basename(named)) for f in folders)]
    for place in [given] if given else places:
        if os.path.isfile(place):
            return place
    raise UserError(f"{given or named}: no such study file; name it with --study-file FILE")


def _settings(study, labels):
    """(key, value) that a study lays over the scenario in the cell of these labels."""
    yield from _leaves(study.get("set", {}))
    for name, axis in study.get("axes", {}).items():
        if "key" in axis:
            points = [(value, {axis["key"]: value}) for value in axis.get("values", [])]
        else:
            points = [(point["label"], point.get("set", {})) for point in axis.get("points", [])]
        for label, settings in points:
            if label_text(_text(label)) == labels.get(name):
                yield from _leaves(settings)


def _leaves(table, before=""):
    """(dotted key, value) of all that is no table."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{before}{key}.")
        else:
            yield before + key, value


def _text(value):
    return str(value).lower() if isinstance(value, bool) else value


def lay(root, key, value):
    """Sets "world.targets[1].position_m" or the like in a tree. A key without a number in brackets
    sets every element of a list of tables."""
    nodes = [root]
    *steps, last = key.split(".")
    for step in steps:
        name, index = re.fullmatch(r"([^\[]*)(?:\[(\d+)\])?", step).groups()
        below = [node.setdefault(name, {}) for node in nodes]
        nodes = []
        for child in below:
            tables = child if isinstance(child, list) else [child]
            nodes += tables if index is None else [tables[int(index)]]
    for node in nodes:
        node[last] = value


def scenario_of(chosen, cell, study_file=None, rooms=("world",)):
    """(file, tree) of the scenario of a cell, with what the study lays over these tables of it.
    @raises UserError for files that are not there."""
    file = find_study(chosen, study_file)
    study = _toml(file)
    if "scenario" not in study:
        raise UserError(f"{file}: it names no scenario")
    scenario = os.path.normpath(os.path.join(os.path.dirname(file), study["scenario"]))
    tree = _toml(scenario)
    try:
        for key, value in _settings(study, chosen.cells[cell]):
            if re.split(r"[.\[]", key)[0] in rooms:
                lay(tree, key, value)
    except (IndexError, TypeError, AttributeError) as error:
        raise UserError(f"{file}: {key} is nothing of {scenario}") from error
    return scenario, tree


def read(chosen, cell, run, study_file=None):
    """The World of a run. @raises UserError for files that are not there or say nothing of it."""
    scenario, tree = scenario_of(chosen, cell, study_file)
    try:
        world = tree["world"]
        area = world["area"]
        columns, rows, cell_m = (area.get(k, v) for k, v in (("columns", 20), ("rows", 20), ("cell_m", 1.0)))
        origin_m = np.array(area.get("origin_m", (0.0, 0.0)), dtype=float)
        places = [
            target["position_m"] if "position_m" in target
            else drawn_place(seed_of(chosen, run), i, columns, rows, cell_m, origin_m)
            for i, target in enumerate(world.get("targets", []))
        ]
    except (KeyError, IndexError, TypeError, AttributeError) as error:
        raise UserError(f"{scenario}: it says nothing of an area with targets") from error
    targets_m = np.array(places, dtype=float).reshape(-1, 2)
    return World(scenario, int(columns), int(rows), float(cell_m), origin_m, targets_m)
