"""The floor that robots drove on, from the plan that their scenario names, and how it is drawn: a database does
not hold it."""

import os
from dataclasses import dataclass, field

import matplotlib.image
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

import style
import world
from data import UserError

WALL, FREE = "#a3a3a3", "#ffffff"
# What these parameter sets say (filters/trails/parameters.cpp), as far as figures need it.
PARAMETERS = {
    "lost-2002": {"laying": "at-once", "distance": "time", "age_max_s": 240.0},
    "thesis-2019-text": {"laying": "completed", "distance": "time"},
    "thesis-2019-code": {"laying": "completed", "distance": "steps-without-turns", "life_arrivals": 11},
}
PARAMETERS_OF_NONE = "lost-2002"  # taken by scenarios that name no set


@dataclass
class Barrier:
    """Closed from `from_s` on, before `until_s`; corners in m."""

    low_m: np.ndarray
    high_m: np.ndarray
    from_s: float
    until_s: float


@dataclass
class Floor:
    """walls[row, column], rows from the bottom; places as {name: (x, y)} in m."""

    scenario: str
    walls: np.ndarray
    cell_m: float
    places: dict
    barriers: list = field(default_factory=list)
    starts: tuple = ()  # names of places
    moves: dict = field(default_factory=dict)  # event: [(since when, name of the place where it is)]
    trails: dict = field(default_factory=dict)  # as TrailsSpec of scenarios/forager_spec.hpp

    @property
    def size_m(self):
        """(width, height)"""
        rows, columns = self.walls.shape
        return columns * self.cell_m, rows * self.cell_m

    def place_of(self, event, t_s):
        """Where an event happens at an instant, or None."""
        at = [name for since, name in self.moves.get(event, [(0.0, event)]) if since <= t_s]
        return self.places.get(at[-1]) if at else None


def read_text(file, cell_m):
    """(walls, places) of a text drawing, as sim/world/plan.hpp has them."""
    try:
        with open(file, encoding="ascii") as stream:
            lines = stream.read().splitlines()
    except (OSError, ValueError) as error:
        raise UserError(f"{file}: cannot be read ({getattr(error, 'strerror', None) or 'not in ASCII'})") from error
    if not lines or len({len(line) for line in lines}) > 1:
        raise UserError(f"{file}: a plan has lines of one length")
    cells = np.array([list(line) for line in reversed(lines)])
    places = {
        cells[row, column]: (cell_m * (column + 0.5), cell_m * (row + 0.5))
        for row, column in np.argwhere(np.char.isalpha(cells))
    }
    return cells == "#", places


def read_bitmap(file, threshold):
    """Walls of a bitmap: dark pixels."""
    try:
        pixels = matplotlib.image.imread(file)
    except (OSError, SyntaxError) as error:
        raise UserError(f"{file}: cannot be read as a bitmap") from error
    pixels = pixels[..., None] if pixels.ndim == 2 else pixels
    opaque = pixels[..., -1:] if pixels.shape[2] in (2, 4) else 1.0
    colour = pixels[..., : pixels.shape[2] - (pixels.shape[2] in (2, 4))] * opaque + 1.0 - opaque
    light = colour @ [0.2126, 0.7152, 0.0722] if colour.shape[2] == 3 else colour[..., 0]
    return light[::-1] * 255.0 < threshold, {}


def _plan_file(named, *beside):
    """A plan is named from the scenario's folder, or from the study's."""
    places = [os.path.normpath(os.path.join(os.path.dirname(f), named)) for f in beside] + [named]
    for place in places:
        if os.path.isfile(place):
            return place
    raise UserError(f"{places[0]}: no such plan, which {beside[0]} names")


def _foragers(tree):
    agents = tree.get("agents", [])
    return [agent for agent in (agents if isinstance(agents, list) else [agents]) if agent.get("kind") == "forager"]


def read(chosen, cell, study_file=None):
    """The Floor of a cell. @raises UserError for files that are not there or say nothing of it."""
    scenario, tree = world.scenario_of(chosen, cell, study_file, ("world", "agents"))
    foragers = _foragers(tree)
    try:
        plan = tree["world"]["plan"]
        cell_m = float(plan.get("cell_m", 0.5))
        file = _plan_file(plan["file"], scenario, world.find_study(chosen, study_file))
        bitmap = file.endswith(".png")
        walls, places = read_bitmap(file, plan.get("wall_below", 128)) if bitmap else read_text(file, cell_m)
        places |= {place["name"]: tuple(place["position_m"]) for place in plan.get("places", [])}
        barriers = [
            Barrier(*np.sort([b["corner_m"], b["opposite_m"]], axis=0), b.get("from_s", 0.0), b.get("until_s", np.inf))
            for b in plan.get("barriers", [])
        ]
        moves = {event: [(0.0, event)] for f in foragers for event in f.get("task", {}).get("events", [])}
        for source in tree["world"].get("sources", []):
            moves[source["name"]] = [(0.0, source["name"])] + [
                (move["at_s"], move["place"]) for move in source.get("moves", [])
            ]
        starts = dict.fromkeys(f["robot"]["start"] for f in foragers if "robot" in f)
        trails = next((f["trails"] for f in foragers if "trails" in f), {})
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise UserError(f"{scenario}: it says nothing of a plan with foragers") from error
    said = PARAMETERS.get(trails.get("parameters", PARAMETERS_OF_NONE), {})
    return Floor(scenario, walls, cell_m, places, barriers, tuple(s for s in starts if s in places), moves,
                 {**said, **trails})


def shades(count=256):
    """Old to new, or far to near: from purple to yellow in even steps."""
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 1.0, count)))


def draw(axes, floor, from_s, until_s):
    """Walls, what was closed at some time of the span, and the places that robots start from and go to."""
    width, height = floor.size_m
    axes.imshow(floor.walls, origin="lower", extent=(0.0, width, 0.0, height), zorder=0, vmin=0, vmax=1,
                cmap=ListedColormap([FREE, WALL]), interpolation="nearest")
    for barrier in floor.barriers:
        if barrier.from_s <= until_s and barrier.until_s > from_s:
            axes.add_patch(Rectangle(barrier.low_m, *(barrier.high_m - barrier.low_m), fc="white", ec=style.VERMILLION,
                                     hatch="/////", lw=0.8, zorder=4))
    for name, at in places_at(floor, until_s).items():
        axes.annotate(name, at, ha="center", va="center", fontsize=9.0, fontweight="bold", zorder=8,
                      color=style.BLACK, path_effects=[withStroke(linewidth=3.0, foreground="white")])
    axes.set_xlim(0.0, width)
    axes.set_ylim(0.0, height)
    axes.set_aspect("equal")
    axes.grid(False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)


def places_at(floor, t_s):
    """{what is written there: (x, y)} of the starts and of the events at an instant."""
    found = {}
    for name in (*floor.starts, *floor.moves):
        at = floor.places.get(name) if name in floor.starts else floor.place_of(name, t_s)
        if at is not None:
            found[name] = at
    return found
