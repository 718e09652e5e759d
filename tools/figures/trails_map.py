#!/usr/bin/python3
"""Where robots drove, on the plan: the ways of all robots in their last few trips, or in the last few minutes,
coloured by age. A panel an iteration or an instant, a row a label of an axis.

    trails_map.py DATABASE OUTPUT [--iterations "1;5;15;45" [--count robot|team] [--last 5]]
                  [--times "600;1800" [--window 600]] [--by AXIS [--labels A;B;…]] [--repetition 1]
                  [--study-file FILE] [--study S]

For runs of foragers with the series robot_x_m and robot_y_m, of a period of 1 or 2 s. Iteration 5 is the fifth
trip of each robot, or with --count team the fifth arrival of all. The plan is read from the study file and its
scenario, which are looked for beside the database and among the scenarios. OUTPUT ends with .png, .svg or .pdf. Any
other axis of the study is chosen by an option of its name.
"""

import argparse
import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, Normalize

import data
import floors
import panels
import style
import trips as trips_of

CASING = "#3a3a3a"


class Run:
    """What one run left: trips, ways and the floor."""

    def __init__(self, chosen, cell, repetition, study_file):
        number = chosen.run(cell, repetition)
        self.floor = floors.read(chosen, cell, study_file)
        self.ways = trips_of.Ways(chosen, number)
        self.trips = trips_of.of_run(chosen, number)
        self.cut_off = self.ways.under_way(self.trips)


def of_iteration(run, number, last, count):
    """[(trip, age)] to be drawn for an iteration: age 0 is the newest of each robot, or of the team. A robot that
    did not get so far shows the trip that it was on at the end of the run."""
    if count == "team":
        if number <= len(run.trips):
            chosen = run.trips[max(0, number - last) : number]
            return [(trip, len(chosen) - 1 - i) for i, trip in enumerate(chosen)]
        before = run.trips[len(run.trips) - min(last - 1, len(run.trips)) :]
        return [(t, len(before) - i) for i, t in enumerate(before)] + [(t, 0) for t in run.cut_off]
    found = []
    for cut_off in run.cut_off:
        own = [trip for trip in run.trips if trip.agent == cut_off.agent] + [cut_off]
        newest = min(number, len(own))
        found += [(own[i], newest - 1 - i) for i in range(max(0, newest - last), newest)]
    return found


def lengths(run, number, count):
    """Of the trips that an iteration is."""
    if count == "team":
        return np.array([t.length_m for t in run.trips[number - 1 : number]])
    return np.array([t.length_m for t in run.trips if t.number == number])


def length_title(run, number, count):
    """How long they were, and how many robots did not get so far."""
    values = lengths(run, number, count)
    robots = len(run.cut_off)
    if len(values) == 0:
        return f"not reached in {len(run.trips)} trips{'' if count == 'team' else ' of all'}"
    if len(values) == 1 and (count == "team" or robots == 1):
        return f"{values[0]:.0f} m"
    there = "" if len(values) == robots else f", {len(values)} of {robots} robots"
    if len(values) <= 3:
        return ", ".join(f"{v:.0f}" for v in values) + f" m{there}"
    return f"median {np.median(values):.0f} m ({values.min():.0f}–{values.max():.0f}){there}"


def instant_title(run, t_s, window_s):
    """How many came through in the window, and how long their trips were."""
    values = np.array([t.length_m for t in run.trips if t_s - window_s < t.to_s <= t_s])
    if len(values) == 0:
        return "nobody arrived"
    return f"{len(values)} trip{'' if len(values) == 1 else 's'}, median {np.median(values):.0f} m"


class Aged:
    """Ways with a colour for each age, the oldest below."""

    def __init__(self):
        self.ways, self.ends = [], []  # (points, age of each of its pieces), places of those who were under way

    def add(self, points, ages, on_its_way):
        if len(points) > 1:
            self.ways.append((points, ages))
        if len(points) and on_its_way:
            self.ends.append(points[-1])

    def draw(self, axes, norm, colors):
        for points, ages in sorted(self.ways, key=lambda way: -way[1][-1]):
            look = {"capstyle": "round", "joinstyle": "round", "zorder": 3}
            axes.add_collection(LineCollection([points], colors=CASING, linewidths=2.0, **look))
            same = (ages == ages[0]).all()
            pieces = [points] if same else np.stack([points[:-1], points[1:]], axis=1)
            axes.add_collection(LineCollection(pieces, colors=colors(norm(ages[:1] if same else ages)),
                                               linewidths=1.15, **look))
        for x, y in self.ends:
            axes.plot(x, y, "o", mfc="white", mec=style.VERMILLION, mew=1.3, ms=4.6, zorder=9, clip_on=False)


class Iterations:
    """Panels of --iterations."""

    def __init__(self, numbers, last, count):
        self.at, self.last, self.count = numbers, last, count
        self.norm = BoundaryNorm(np.arange(last + 1) - 0.5, last)
        self.colors = floors.shades(last).reversed()
        self.bar = "trips before" if count == "robot" else "arrivals before"

    def titles(self, run, number):
        return f"iteration {number}", length_title(run, number, self.count)

    def span_s(self, run, number):
        shown = [t for t, _ in of_iteration(run, number, self.last, self.count)]
        ends = [t.to_s if t.arrived else run.ways.end_s for t in shown]
        return (min(t.from_s for t in shown), max(ends)) if shown else (0.0, 0.0)

    def draw(self, axes, run, number):
        aged = Aged()
        for trip, age in of_iteration(run, number, self.last, self.count):
            _, x, y = run.ways.between(trip.agent, trip.from_s, trip.to_s)
            aged.add(np.column_stack([x, y]), np.full(max(len(x) - 1, 0), age), not trip.arrived)
        aged.draw(axes, self.norm, self.colors)
        return aged

    def sentences(self):
        whose = "each one's" if self.count == "robot" else "the team's"
        that = "trip" if self.count == "robot" else "arrival"
        return [f"Ways of all robots: {whose} last {self.last} trips up to the {that} of that number;"
                " above: how long the trips of that number were."]


class Instants:
    """Panels of --times."""

    def __init__(self, times_s, window_s):
        self.at, self.window_s = times_s, window_s
        self.norm = Normalize(0.0, window_s)
        self.colors = floors.shades().reversed()
        self.bar = "s before"

    def titles(self, run, t_s):
        return f"{t_s:g} s", instant_title(run, t_s, self.window_s)

    def span_s(self, run, t_s):
        return t_s - self.window_s, t_s

    def draw(self, axes, run, t_s):
        aged = Aged()
        for trip in run.trips + run.cut_off:
            if trip.to_s > t_s - self.window_s and trip.from_s <= t_s:
                t, x, y = run.ways.between(trip.agent, max(trip.from_s, t_s - self.window_s), min(trip.to_s, t_s))
                aged.add(np.column_stack([x, y]), t_s - t[1:], trip.to_s > t_s)
        aged.draw(axes, self.norm, self.colors)
        return aged

    def sentences(self):
        return [f"Ways of all robots in the {self.window_s:g} s before; above: trips that ended in that time."]


def draw(runs, by, moments):
    """(figure, left edge, whether a robot was on its way somewhere)"""
    width_m, height_m = next(iter(runs.values())).floor.size_m
    aspect = height_m / width_m
    wide = min(max(2.6 / math.sqrt(aspect), 2.4), 4.4)
    columns = min(len(moments.at), max(1, int(11.5 / wide)))
    if len(runs) == 1:  # rows of equal length
        columns = math.ceil(len(moments.at) / math.ceil(len(moments.at) / columns))
    lines = math.ceil(len(moments.at) / columns)
    rows, high = lines * len(runs), wide * aspect
    width, below = max(wide * columns + 0.12 * (columns - 1) + 0.62 + 0.9, 6.0), 0.98
    height = (high + 0.4) * rows + 0.25 * (len(runs) if by else 0) + below + 0.05
    figure = style.new_figure(width, height)
    left, on_their_way = 0.55 / width, False
    y = height - 0.05
    for label, run in runs.items():
        if by:
            y -= 0.25
            figure.text(left, (y - 0.06) / height, panels.label_name(by, label), fontsize=10.5, fontweight="bold")
        for i, at in enumerate(moments.at):
            if i % columns == 0:
                y -= high + 0.4
            box = (left + (i % columns) * (wide + 0.12) / width, (y + 0.08) / height, wide / width, high / height)
            axes = figure.add_axes(box)
            floors.draw(axes, run.floor, *moments.span_s(run, at))
            on_their_way |= bool(moments.draw(axes, run, at).ends)
            title, more = moments.titles(run, at)
            axes.set_title(title, loc="left", fontweight="bold", fontsize=9, pad=3)
            axes.set_title(more, loc="right", fontsize=8, pad=3)
            lowest = y < high + 0.4 + below and label == list(runs)[-1]
            axes.tick_params(labelleft=i % columns == 0, labelbottom=lowest and i + columns >= len(moments.at))
            panels.tick_ends(axes, nbins=5)
            if i % columns == 0:
                axes.set_ylabel("y [m]", labelpad=1)
            if lowest and i + columns >= len(moments.at):
                axes.set_xlabel("x [m]", labelpad=1)
    colour_bar(figure, moments, (left + (wide * columns + 0.12 * (columns - 1) + 0.14) / width, (y + 0.08) / height,
                                 0.13 / width, high / height))
    return figure, left, on_their_way


def colour_bar(figure, moments, place):
    bar = figure.colorbar(ScalarMappable(moments.norm, moments.colors), cax=figure.add_axes(place))
    bar.set_label(moments.bar, fontsize=8.5, labelpad=3)
    bar.outline.set_linewidth(0.6)
    bar.ax.invert_yaxis()  # the newest is at the top
    bar.ax.minorticks_off()
    if isinstance(moments.norm, BoundaryNorm):
        ticks = np.arange(len(moments.norm.boundaries) - 1)
        bar.set_ticks(ticks[:: max(1, len(ticks) // 8)])


def numbers(text, option, kind):
    """"1;5" as numbers. @raises UserError for others, and for what is not above 0."""
    found = []
    for part in panels.names_in(text, option):
        try:
            found.append(kind(part))
        except ValueError as error:
            raise data.UserError(f"{option}: {part!r} is no number of the wanted kind") from error
        if not found[-1] > 0 or found[-1] == math.inf:
            raise data.UserError(f"{option}: {part} is not above 0")
    return found


def moments_of(arguments):
    """The panels that the options ask for."""
    if arguments.times and arguments.iterations:
        raise data.UserError("--iterations and --times: give one of them")
    if arguments.last < 1 or not 0.0 < arguments.window < math.inf:
        raise data.UserError("--last and --window are above 0")
    if arguments.times:
        return Instants(numbers(arguments.times, "--times", float), arguments.window)
    return Iterations(numbers(arguments.iterations or "1;5;15;45", "--iterations", int), arguments.last,
                      arguments.count)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--iterations", help="with ; between; default: 1;5;15;45")
    parser.add_argument("--count", choices=("robot", "team"), default="robot", help="whose trips are counted")
    parser.add_argument("--last", type=int, default=5, help="so many trips of each, or of the team")
    parser.add_argument("--times", help="instants in s, with ; between, instead of iterations")
    parser.add_argument("--window", type=float, default=600.0, help="so many s before an instant")
    parser.add_argument("--by", help="axis with a row a label")
    parser.add_argument("--labels", default="", help="labels of that axis, with ; between")
    parser.add_argument("--repetition", type=int, default=1, help="from 1")
    parser.add_argument("--study-file", help="whose scenario names the plan")
    arguments, chosen = data.parse(parser)
    moments = moments_of(arguments)
    by = arguments.by
    chosen.require_axes(*([by] if by else []))
    labels = panels.chosen_labels(chosen, by, arguments.labels) if by else [None]
    runs = {
        label: Run(chosen, chosen.cell(**({by: label} if by else {})), arguments.repetition, arguments.study_file)
        for label in labels
    }
    figure, left, on_their_way = draw(runs, by, moments)
    others = chosen.described(*([by] if by else []))
    sentences = moments.sentences()
    if on_their_way:
        sentences.append("Circles: robots that were on their way " + ("then." if arguments.times else
                         "at the end of the run, in place of the iteration that they did not get to."))
    first = next(iter(runs.values()))
    if any(run.floor.barriers for run in runs.values()):
        sentences.append("Hatched: closed at some time of these ways.")
    sentences.append(f"{len(first.cut_off)} robots; repetition {arguments.repetition} of {chosen.repetitions}"
                     f"{'; ' + others if others else ''}.")
    panels.write_caption(figure, left, sentences)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
