#!/usr/bin/python3
"""How many trips a team of foragers makes in an hour, against the number of robots: a line a label of an axis, and
published points beside.

    throughput.py DATABASE OUTPUT [--over robots] [--by method] [--labels A;B;…] [--published so-lost|none]
                  [--study-file FILE] [--study S]

From the scalar trips of the team and the duration that the scenario says: the study file is looked for beside the
database and among the scenarios. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen by an
option of its name.
"""

import argparse
import math

import numpy as np

import data
import panels
import stats
import style
import world

# Sadat & Vaughan, "SO-LOST: an ant-trail algorithm for multi-robot navigation with active interference reduction",
# ALife XII, 2010: trips in 60 min, mean of 10 trials, in an empty square of 20 × 20 m; read off a plot, ± 5 %.
SO_LOST = {
    "robots": (10, 20, 30, 40, 50, 60, 70, 80, 90, 100),
    "LOST": (520, 590, 640, 640, 710, 780, 760, 640, 590, 450),
    "SO-LOST": (370, 840, 1150, 1270, 1320, 1350, 1270, 1000, 850, 700),
}
READ_OFF = 0.05
PUBLISHED_NAMES = {"LOST": ("lost", "none"), "SO-LOST": ("so-lost",)}  # labels that mean the same
PUBLISHED_MARKERS = {"LOST": "o", "SO-LOST": "s"}


class Throughput:
    """The numbers behind the figure."""

    def __init__(self, chosen, over, by, labels, study_file):
        self.chosen, self.over, self.by, self.labels = chosen, over, by, labels
        try:
            self.levels = sorted(chosen.labels(over), key=float)
            self.robots = np.array([float(level) for level in self.levels])
        except ValueError as error:
            raise data.UserError(f"axis {over} has labels that are no numbers of robots") from error
        trips = chosen.scalar_of("trips", data.CENTRAL)
        self.an_hour = [
            cell * 3600.0 / duration_s(chosen, i, study_file) for i, cell in enumerate(trips)
        ]

    def curve(self, label):
        """(mean, half width of its t interval), an entry a number of robots; NaN where there is no run."""
        where = {self.by: label} if self.by else {}
        cells = [self.chosen.cell(**where, **{self.over: level}) for level in self.levels]
        return np.array([
            (math.nan, math.nan) if cell is None else stats.mean_interval(self.an_hour[cell]) for cell in cells
        ]).T


def duration_s(chosen, cell, study_file):
    scenario, tree = world.scenario_of(chosen, cell, study_file, ("duration_s",))
    try:
        found = float(tree["duration_s"])
    except (KeyError, TypeError, ValueError) as error:
        raise data.UserError(f"{scenario}: it does not say duration_s") from error
    if not found > 0.0:
        raise data.UserError(f"{scenario}: duration_s is not above 0")
    return found


def published_color(name, labels):
    """That of the label that means the same, or grey."""
    for label in labels:
        if label is not None and label.lower() in PUBLISHED_NAMES[name]:
            return style.label_style(label, labels)[0]
    return style.GREY


def draw(found, published, sentences):
    width, labels = 6.6, found.labels
    entries = []
    left, lines = 0.72 / width, math.ceil((len(labels) * bool(found.by) + 2 * bool(published)) / 3)
    room = panels.caption_room(width, left, sentences)
    below = 1.06 + 0.2 * lines + room
    height = 3.7 + below
    figure = style.new_figure(width, height)
    axes = figure.add_axes((left, below / height, 0.985 - left, 1 - (0.15 + below) / height))
    x_max, y_max = found.robots.max(), 0.0
    for label in labels:
        color, marker = style.label_style(label, labels) if label is not None else (style.BLUE, "o")
        mean, half = found.curve(label)
        axes.errorbar(found.robots, mean, yerr=np.nan_to_num(half), fmt="-", marker=marker, color=color, ms=4.4, lw=1.6,
                      elinewidth=1.0, capsize=2.2, zorder=4)
        y_max = max(y_max, np.nanmax(mean + np.nan_to_num(half), initial=0.0))
        if found.by:
            entries.append(panels.line_entry("-", color, panels.label_name(found.by, label), marker))
    for name in PUBLISHED_NAMES if published else ():
        values = np.array(SO_LOST[name], dtype=float)
        look = {"color": published_color(name, labels), "marker": PUBLISHED_MARKERS[name], "mfc": "white", "mew": 1.1}
        axes.errorbar(SO_LOST["robots"], values, yerr=READ_OFF * values, ls="", ms=5.2, elinewidth=0.7, zorder=3, **look)
        entries.append(panels.line_entry("", label=f"{name}, published", **look))
        x_max, y_max = max(x_max, SO_LOST["robots"][-1]), max(y_max, (1.0 + READ_OFF) * values.max())
    if y_max == 0.0:
        panels.note(axes, "nobody ever arrived", color=style.VERMILLION)
    axes.set_xlim(0.0, 1.04 * x_max)
    axes.set_ylim(0.0, 1.06 * (y_max or 1.0))
    axes.set_xlabel(found.over.replace("_", " "))
    axes.set_ylabel("trips of the team in an hour")
    if entries:
        panels.legend(figure, (left, (0.56 + room) / height), entries, min(3, len(entries)))
    panels.write_caption(figure, left, sentences, room)
    return figure


def caption(chosen, published, drawn):
    others = chosen.described(*drawn)
    sentences = [
        f"Means over {chosen.repetitions} repetitions with 95 % t intervals; a trip ends with each arrival at an event"
        f"{'; ' + others if others else ''}."
    ]
    if published:
        sentences.append(
            "Hollow: Sadat & Vaughan 2010 (SO-LOST), 60 min in an empty square of 20 × 20 m, mean of 10 trials, read off"
            " a plot: strokes are ± 5 %."
        )
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--over", default="robots", help="axis with the number of robots")
    parser.add_argument("--by", default="method", help="axis with a line a label")
    parser.add_argument("--labels", default="", help="labels of that axis, with ; between")
    parser.add_argument("--published", choices=("so-lost", "none"), default="so-lost", help="points to draw beside")
    parser.add_argument("--study-file", help="whose scenario says how long runs are")
    arguments, chosen = data.parse(parser)
    by = arguments.by if arguments.by != "method" or "method" in chosen.axes else None
    drawn = [axis for axis in (arguments.over, by) if axis]
    if len(set(drawn)) < len(drawn):
        raise data.UserError(f"--over and --by name one axis twice: {arguments.over}")
    chosen.require_axes(*drawn)
    labels = panels.chosen_labels(chosen, by, arguments.labels) if by else [None]
    published = arguments.published != "none"
    found = Throughput(chosen, arguments.over, by, labels, arguments.study_file)
    style.write(draw(found, published, caption(chosen, published, drawn)), arguments.output)


if __name__ == "__main__":
    data.main(main)
