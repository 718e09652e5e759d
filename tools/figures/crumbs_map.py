#!/usr/bin/python3
"""The trails of a team at an instant, as crumbs on the plan: arrows point where a follower would go, and their
colour says how far it still is. A panel an event.

    crumbs_map.py DATABASE OUTPUT --at 1800 [--events A;B] [--age 240] [--laying at-once|completed] [--thin 0.75]
                  [--by AXIS [--labels A;B;…]] [--repetition 1] [--study-file FILE] [--study S]

For runs of foragers with record.crumbs = "on". Shown are all crumbs that the team has told and that are not too
old; a robot that did not hear some knows fewer. How long crumbs live, when they are told and the plan are read
from the study file and its scenario, which are looked for beside the database and among the scenarios. OUTPUT ends
with .png, .svg or .pdf. Any other axis of the study is chosen by an option of its name.
"""

import argparse
import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

import data
import floors
import panels
import style
import trips as trips_of

ARROW = 1.05  # length in squares of --thin
USUAL = 0.9  # the scale of d is made for such a share of the crumbs, if others are much farther
WAYS = {
    "at-once": "against that of the robot that laid them",
    "completed": "which is that of the robot that laid them",
    None: "which is that of the robot that laid them where trails are completed, and against it elsewhere",
}
UNITS = {"time": "s", "steps-without-turns": "s of driving straight on"}


class Crumbs:
    """Columns of the crumbs of one event: told, laid (both in s), x, y, heading, d."""

    def __init__(self, rows, laying):
        self.told_s, self.x, self.y, self.heading, self.d = (
            np.array(rows, dtype=float).reshape(-1, 5).T if rows else np.empty((5, 0))
        )
        # Of a completed trail d counts back from the event, at most as fast as time.
        self.laid_s = self.told_s - (self.d if laying == "completed" else 0.0)
        self.way = self.heading + (math.pi if laying == "at-once" else 0.0)

    def keep(self, mask):
        for name in ("told_s", "laid_s", "x", "y", "heading", "d", "way"):
            setattr(self, name, getattr(self, name)[mask])

    def __len__(self):
        return len(self.d)


class Run:
    """What one run left: crumbs by event, and the floor."""

    def __init__(self, chosen, cell, repetition, arguments):
        number = chosen.run(cell, repetition)
        self.floor = floors.read(chosen, cell, arguments.study_file)
        said = self.floor.trails
        self.laying = arguments.laying or said.get("laying", "at-once")
        self.unit = UNITS.get(said.get("distance", "time"), "")
        self.age_max_s = arguments.age if arguments.age is not None else said.get("age_max_s")
        self.life = said.get("life_arrivals") if arguments.age is None else None
        self.at_s = arguments.at
        rows = {}
        for t_s, detail in chosen.rows(
            "SELECT t_s, detail FROM event WHERE run = ? AND kind = 'crumb' AND t_s <= ? ORDER BY t_s",
            (number, self.at_s),
        ):
            event, *values = detail.split(" ")
            rows.setdefault(event, []).append((t_s, *values))
        if not rows:
            raise data.UserError(
                f"{chosen.file}: no crumb was told by {self.at_s:g} s; it takes record.crumbs = \"on\""
            )
        self.crumbs = {event: Crumbs(found, self.laying) for event, found in sorted(rows.items())}
        self._let_go(trips_of.of_run(chosen, number))

    def _let_go(self, trips):
        """Of what has outlived its life, as filters/trails/store.hpp has it."""
        for event, crumbs in self.crumbs.items():
            alive = np.full(len(crumbs), True)
            if self.age_max_s is not None:
                alive &= self.at_s - crumbs.laid_s <= self.age_max_s
            if self.life:
                came = np.array([t.to_s for t in trips if t.event == event and t.to_s <= self.at_s])
                since = len(came) - np.searchsorted(came, crumbs.laid_s, side="right")
                alive &= since < self.life
            crumbs.keep(alive)

    def life_text(self):
        if self.age_max_s is not None:
            return f"no older than {self.age_max_s:g} s"
        return f"laid since the {self.life}th last arrival" if self.life else "of any age"


def thinned(crumbs, side_m):
    """Numbers of the crumbs to draw: of those in one square the one that a follower would take, of least d."""
    if side_m <= 0.0:
        return np.argsort(-crumbs.d, kind="stable")
    order = np.lexsort((-crumbs.told_s, crumbs.d))
    squares = np.floor(np.stack([crumbs.x, crumbs.y], axis=1)[order] / side_m).astype(int)
    _, first = np.unique(squares, axis=0, return_index=True)
    kept = order[np.sort(first)]
    return kept[::-1]  # the nearest on top


def scale_of(distances):
    """(from distance to shade, whether some are beyond it): robots that are lost lay crumbs so far from the event
    that all others would look alike."""
    drawn = np.concatenate([np.array([0.0]), *distances])
    usual = 1.1 * float(np.quantile(drawn, USUAL))
    beyond = drawn.max() > 1.3 * usual > 0.0
    return Normalize(0.0, (usual if beyond else drawn.max()) or 1.0), beyond


def panel(axes, run, event, side_m, norm):
    floors.draw(axes, run.floor, run.at_s, run.at_s)
    crumbs = run.crumbs.get(event)
    if crumbs is None or len(crumbs) == 0:
        panels.note(axes, "none", color=style.VERMILLION)
        return 0
    shown = thinned(crumbs, side_m)
    length = ARROW * max(side_m, 0.6)
    dx, dy = length * np.cos(crumbs.way[shown]), length * np.sin(crumbs.way[shown])
    axes.quiver(
        crumbs.x[shown], crumbs.y[shown], dx, dy, crumbs.d[shown], cmap=floors.shades(), norm=norm, angles="xy",
        scale_units="xy", scale=1.0, pivot="mid", units="xy", width=0.2 * length, headwidth=3.6, headlength=3.2,
        headaxislength=2.8, edgecolor="#3a3a3a", linewidth=0.25, zorder=3,
    )
    return len(shown)


def draw(runs, by, events, side_m):
    """(figure, left edge)"""
    width_m, height_m = next(iter(runs.values())).floor.size_m
    aspect = height_m / width_m
    wide = min(max(4.2 / math.sqrt(aspect), 3.6), 6.6)
    places = [(label, event) for label in runs for event in events]
    columns = min(len(events) if len(events) > 1 else len(places), max(1, int(13.2 / wide)))
    rows, high = math.ceil(len(places) / columns), wide * aspect
    below, over = 0.98, 0.4
    width = max(wide * columns + 0.14 * (columns - 1) + 1.6, 6.0)
    height = (high + over) * rows + below + 0.05
    figure = style.new_figure(width, height)
    left = 0.55 / width
    norm, beyond = scale_of(
        [r.crumbs[e].d[thinned(r.crumbs[e], side_m)] for r in runs.values() for e in events if e in r.crumbs]
    )
    for i, (label, event) in enumerate(places):
        row, column = divmod(i, columns)
        y = height - 0.05 - (row + 1) * (high + over) + 0.08
        axes = figure.add_axes((left + column * (wide + 0.14) / width, y / height, wide / width, high / height))
        run = runs[label]
        shown = panel(axes, run, event, side_m, norm)
        count = len(run.crumbs.get(event, ()))
        name = panels.label_name(by, label) + ": " if by else ""
        axes.set_title(f"{name}trail to {event}", loc="left", fontweight="bold", fontsize=9.5, pad=3)
        drawn = f"{count} crumb{'' if count == 1 else 's'}" + ("" if shown == count else f", {shown} drawn")
        axes.set_title(drawn, loc="right", fontsize=8, pad=3)
        lowest = i + columns >= len(places)
        axes.tick_params(labelleft=column == 0, labelbottom=lowest)
        panels.tick_ends(axes, nbins=6)
        axes.set_ylabel("y [m]" if column == 0 else "", labelpad=1)
        axes.set_xlabel("x [m]" if lowest else "", labelpad=1)
    place = (left + (wide * columns + 0.14 * (columns - 1) + 0.14) / width, y / height, 0.13 / width, high / height)
    bar = figure.colorbar(ScalarMappable(norm, floors.shades()), cax=figure.add_axes(place), extendfrac=0.04,
                          extend="max" if beyond else "neither")
    bar.set_label(f"d: still to go [{next(iter(runs.values())).unit}]", fontsize=8.5, labelpad=3)
    bar.outline.set_linewidth(0.6)
    return figure, left


def caption(runs, chosen, arguments, by):
    run = next(iter(runs.values()))
    others = chosen.described(*([by] if by else []))
    layings = {run.laying for run in runs.values()}
    sentences = [
        f"Crumbs at {run.at_s:g} s that the team has told, {run.life_text()}, where they were truly laid.",
        "Arrows: the way of who follows them, " + WAYS[layings.pop() if len(layings) == 1 else None] + ".",
    ]
    if arguments.thin > 0.0:
        sentences.append(f"Of the crumbs in a square of {arguments.thin:g} m the one of least d is drawn.")
    if any(b.from_s <= run.at_s < b.until_s for r in runs.values() for b in r.floor.barriers):
        sentences.append("Hatched: closed then.")
    sentences.append(f"Repetition {arguments.repetition} of {chosen.repetitions}{'; ' + others if others else ''}.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--at", type=float, required=True, help="instant in s")
    parser.add_argument("--events", default="", help="a panel each, with ; between; default: all")
    parser.add_argument("--age", type=float, help="crumbs live so many s; default: as the scenario says")
    parser.add_argument("--laying", choices=("at-once", "completed"), help="default: as the scenario says")
    parser.add_argument("--thin", type=float, default=0.75, help="side of squares in m, 0: draw all")
    parser.add_argument("--by", help="axis with a row a label")
    parser.add_argument("--labels", default="", help="labels of that axis, with ; between")
    parser.add_argument("--repetition", type=int, default=1, help="from 1")
    parser.add_argument("--study-file", help="whose scenario names the plan")
    arguments, chosen = data.parse(parser)
    by = arguments.by
    chosen.require_axes(*([by] if by else []))
    labels = panels.chosen_labels(chosen, by, arguments.labels) if by else [None]
    runs = {
        label: Run(chosen, chosen.cell(**({by: label} if by else {})), arguments.repetition, arguments)
        for label in labels
    }
    known = list(dict.fromkeys(event for run in runs.values() for event in run.crumbs))
    events = panels.names_in(arguments.events, "--events") if arguments.events else sorted(known)
    for event in events:
        if event not in known:
            raise data.UserError(f"--events: no crumb of {event!r} was told; there are: {', '.join(sorted(known))}")
    figure, left = draw(runs, by, events, arguments.thin)
    panels.write_caption(figure, left, caption(runs, chosen, arguments, by))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
