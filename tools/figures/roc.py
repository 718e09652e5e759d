#!/usr/bin/python3
"""Operating curves of certainty grids at the end of the runs: which share of the cells with a target is over a
threshold (P_D), and which share of the empty ones (P_F); then P_F against the threshold. A curve a rule.

    roc.py DATABASE OUTPUT [--by rule] [--rules A;B;…] [--no-central] [--study S]

For runs of explorers with the series cells_detected_share and cells_false_share and several
record.alarms.thresholds. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen by an
option of its name.
"""

import argparse

import numpy as np
from matplotlib import ticker

import data
import panels
import style

SPAN = 30.0  # from so much on P_F is on a logarithmic axis
LABELLED = (0.5, 0.8, 0.1, 0.99)  # thresholds that are written beside a curve, the nearest of each
FEW = 4  # beside more curves the first two of them
DETECTED, FALSE = "cells_detected_share", "cells_false_share"


def ends_by_threshold(chosen, name):
    """{threshold: Series of the last instant alone}. @raises UserError if there is none."""
    chosen.note_ends()
    rows = chosen.rows(
        "SELECT s.subject, c.cell, c.repetition, s.agent, s.value FROM temp.chosen c"
        " CROSS JOIN series s ON s.run = c.run WHERE s.name = ? AND s.t_s = c.end_s",
        (name,),
    )
    found = {}
    for threshold, *row in rows:
        found.setdefault(threshold, []).append(row)
    if not found:
        raise data.UserError(
            f"{chosen.file}: no series {name!r} in these runs of {chosen.study!r};"
            " name it under [record] in the scenario"
        )
    series = {}
    for threshold, of_threshold in found.items():
        cell, repetition, agent, value = zip(*of_threshold)
        keys = [np.array(c) for c in (cell, repetition, np.zeros(len(value)), agent)]
        series[threshold] = data.Series(chosen, keys, [np.array(value, dtype=float)])
    return series


class Curves:
    """P_D and P_F with intervals, for each label and threshold."""

    def __init__(self, chosen, by, labels, with_central=True):
        self._with_central = with_central
        self.chosen, self.by, self.labels = chosen, by, labels
        series = {name: ends_by_threshold(chosen, name) for name in (DETECTED, FALSE)}
        both = [t for t in series[DETECTED] if t in series[FALSE]]
        self.thresholds = sorted(both, key=float)
        self.series = {name: [of_name[t] for t in self.thresholds] for name, of_name in series.items()}
        if len(self.thresholds) < 2:
            raise data.UserError(f"an operating curve needs several record.alarms.thresholds, found {both}")

    def of(self, name, label, agents="agents"):
        """(mean, low, high), an entry a threshold; NaN where nothing is known."""
        cell = self.chosen.cell(**{self.by: label})
        curves = [panels.mean(series, cell, agents, interval=True) for series in self.series[name]]
        return np.array([[c.value[0], c.low[0], c.high[0]] for c in curves]).T

    def central(self, name):
        """Means of the central grids over all labels, or None if they were not recorded or asked for."""
        if not self._with_central or not all((s.agents == data.CENTRAL).any() for s in self.series[name]):
            return None
        cells = [self.chosen.cell(**{self.by: label}) for label in self.labels]
        sums = [[s.of(a, "central")[cells].sum() for s in self.series[name]] for a in ("total", "count")]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.array(sums[0]) / np.array(sums[1])


class Axis:
    """Of P_F: linear, or logarithmic with a place for zero left of a line (or below it)."""

    def __init__(self, values):
        positive = values[values > 0.0]
        self.log = len(positive) > 0 and positive.max() > SPAN * positive.min()
        self.has_zero = self.log and (values <= 0.0).any()
        self.high = min(1.0, 1.5 * positive.max()) if self.log else 1.03 * values.max() or 1.0
        self.least = positive.min() if self.log else 0.0
        self.zero = self.least / 2.6 if self.log else 0.0
        self.low = (self.zero / 1.5 if self.has_zero else self.least / 1.5) if self.log else -0.02 * self.high

    def at(self, values):
        """Where values are drawn."""
        return np.where(values > 0.0, np.maximum(values, self.zero), self.zero) if self.log else values

    def apply(self, axes, which):
        """Makes it the x or the y axis."""
        line, limits = (axes.axvline, axes.set_xlim) if which == "x" else (axes.axhline, axes.set_ylim)
        if not self.log:
            limits(self.low, self.high)
            return
        (axes.set_xscale if which == "x" else axes.set_yscale)("log")
        limits(self.low, self.high)
        of_axes = axes.xaxis if which == "x" else axes.yaxis
        decades = np.arange(np.ceil(np.log10(self.least / 1.5)), np.floor(np.log10(self.high)) + 1)
        powers = [p for p in 10.0**decades if not self.has_zero or p > 1.6 * self.zero]
        places = ([self.zero] if self.has_zero else []) + powers
        names = [f"{p:g}" if p > 5e-4 else f"$10^{{{np.log10(p):.0f}}}$" for p in powers]
        names = (["0"] if self.has_zero else []) + names
        of_axes.set_major_locator(ticker.FixedLocator(places))
        of_axes.set_major_formatter(ticker.FixedFormatter(names))
        of_axes.set_minor_locator(ticker.NullLocator())
        if self.has_zero:
            line(self.zero * 1.6, color=style.GREY, lw=0.7, ls=(0, (2, 2)), zorder=1)


def points(axes, x, y, color, marker, hollow):
    """Points, hollow where the value has its place at zero."""
    for mask, face in ((~hollow, color), (hollow, "white")):
        axes.plot(x[mask], y[mask], marker, color=color, mfc=face, ms=4.6, mew=1.0, zorder=4, clip_on=False)


def curve_panel(axes, curves, axis):
    """P_D against P_F; returns all points, with what is to be written beside them."""
    axis.apply(axes, "x")
    axes.set_ylim(-0.02, 1.03)
    detected, false = curves.central(DETECTED), curves.central(FALSE)
    if detected is not None and false is not None:
        axes.plot(axis.at(false), detected, "-", color=style.BLACK, lw=1.4, zorder=2.5)
    remarks = []
    for label in curves.labels:
        color, marker = style.rule_style(label, curves.labels)
        d, d_low, d_high = curves.of(DETECTED, label)
        f, f_low, f_high = curves.of(FALSE, label)
        x = axis.at(f)
        axes.plot(x, d, ls=style.rule_dash(label), color=color, lw=1.3, zorder=3)
        axes.hlines(d, axis.at(f_low), axis.at(f_high), color=color, lw=0.8, alpha=0.6, zorder=2)
        axes.vlines(x, d_low, d_high, color=color, lw=0.8, alpha=0.6, zorder=2)
        points(axes, x, d, color, marker, axis.log & (f <= 0.0))
        thresholds = np.array([float(t) for t in curves.thresholds])
        wanted = LABELLED if len(curves.labels) <= FEW else LABELLED[:2]
        nearest = {int(np.argmin(np.abs(thresholds - t))) for t in wanted}
        for k, threshold in enumerate(curves.thresholds):
            remarks.append((x[k], d[k], threshold if k in nearest else "", color))
    axes.set_xlabel("$P_F$: share of empty cells over the threshold" + (" (log)" if axis.log else ""))
    axes.set_ylabel("$P_D$: share of cells with a target over it")
    axes.set_title("Operating curves", loc="left", fontweight="bold")
    return remarks


def write_thresholds(axes, remarks):
    """Thresholds beside their points, where there is room for them."""
    place = axes.transData.transform
    dots = np.array([place((x, y)) for x, y, _, _ in remarks if np.isfinite(y)])
    taken = []
    high, wide = 8.0, 5.0  # of text, in pixels at 100 dpi; a letter's width
    inside = axes.get_window_extent()
    for x, y, text, color in remarks:
        if not text or not np.isfinite(y):
            continue
        px, py = place((x, y))
        length = wide * len(text)
        for dx, dy in ((6, 3), (6, -11), (-6 - length, 3), (-6 - length, -11)):
            box = (px + dx, py + dy, px + dx + length, py + dy + high)
            crosses = any(
                box[0] < b[2] + 2 and b[0] < box[2] + 2 and box[1] < b[3] + 2 and b[1] < box[3] + 2 for b in taken
            )
            covers = ((dots[:, 0] > box[0] - 4) & (dots[:, 0] < box[2] + 4) & (dots[:, 1] > box[1] - 4)
                      & (dots[:, 1] < box[3] + 4)).any()
            out = box[0] < inside.x0 or box[2] > inside.x1 + 12 or box[1] < inside.y0 or box[3] > inside.y1 + 6
            if not crosses and not covers and not out:
                taken.append(box)
                axes.annotate(text, (x, y), (dx * 0.72, dy * 0.72), textcoords="offset points", fontsize=6.8,
                              color=color, va="bottom", ha="left", zorder=6, annotation_clip=False,
                              bbox=dict(boxstyle="square,pad=0.05", fc="white", ec="none", alpha=0.8))
                break


def logit(thresholds):
    values = np.array([float(t) for t in thresholds])
    return np.log(values / (1.0 - values))


def false_panel(axes, curves, axis):
    """P_F against the threshold, in log-odds."""
    axis.apply(axes, "y")
    x = logit(curves.thresholds)
    span = x[-1] - x[0]
    shift = min(0.006, 0.03 / len(curves.labels)) * span
    central = curves.central(FALSE)
    if central is not None:
        axes.plot(x, axis.at(central), "-", color=style.BLACK, lw=1.4, zorder=2.5)
    for k, label in enumerate(curves.labels):
        color, marker = style.rule_style(label, curves.labels)
        value, low, high = curves.of(FALSE, label)
        at = x + shift * (k - 0.5 * (len(curves.labels) - 1))
        axes.plot(at, axis.at(value), ls=style.rule_dash(label), color=color, lw=1.1, zorder=3)
        axes.vlines(at, axis.at(low), axis.at(high), color=color, lw=0.9, alpha=0.7, zorder=2)
        points(axes, at, axis.at(value), color, marker, axis.log & (value <= 0.0))
    axes.set_xlim(x[0] - 0.05 * span, x[-1] + 0.05 * span)
    shown, before = [], -np.inf
    for place, name in zip(x, curves.thresholds):
        shown.append(name if place - before > 0.075 * span else "")
        before = place if shown[-1] else before
    axes.set_xticks(x, shown)
    axes.set_xlabel("threshold (spaced by log-odds)")
    axes.set_ylabel("$P_F$" + (" (log)" if axis.log else ""))
    axes.set_title("False alarms at each threshold", loc="left", fontweight="bold")


def caption(curves, axis, central):
    chosen = curves.chosen
    others = chosen.described(curves.by)
    sentences = [
        f"Means over vehicles and {chosen.repetitions} paired repetitions at the end of the runs"
        f"{', ' + others if others else ''}; thin strokes: 95 % bootstrap interval over repetitions.",
        f"Points: thresholds from {curves.thresholds[0]} to {curves.thresholds[-1]}.",
    ]
    if axis.has_zero:
        sentences.append("Hollow, beyond the dotted line: no cell in any run; strokes that reach it include zero.")
    if central:
        sentences.append("Black: the central grid, which has every look once, mean over all curves' runs.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--by", default="rule", help="axis with a curve a label")
    parser.add_argument("--rules", "--labels", default="", dest="labels", help="labels of that axis, with ; between")
    parser.add_argument("--no-central", action="store_true", help="not the central grid: where it is not one for all")
    arguments, chosen = data.parse(parser)
    chosen.require_axes(arguments.by)
    labels = panels.chosen_labels(chosen, arguments.by, arguments.labels)
    curves = Curves(chosen, arguments.by, labels, not arguments.no_central)
    values = [curves.of(FALSE, label)[0] for label in labels]
    central = curves.central(FALSE)
    axis = Axis(panels.finite(values + ([central] if central is not None else []), "P_F"))
    entries = []
    for label in labels:
        color, marker = style.rule_style(label, labels)
        name = panels.label_name(arguments.by, label)
        entries.append(panels.line_entry(style.rule_dash(label), color, name, marker))
    if central is not None:
        entries.append(panels.line_entry("-", style.BLACK, "central grid"))
    lines = -(-len(entries) // 6)
    figure = style.new_figure(9.6, 4.5 + 0.2 * (lines - 1))
    height = figure.get_figheight()
    grid = figure.add_gridspec(1, 2, left=0.065, right=0.985, top=1 - 0.32 / height,
                               bottom=(1.18 + 0.2 * (lines - 1)) / height, wspace=0.2)
    left = figure.add_subplot(grid[0])
    remarks = curve_panel(left, curves, axis)
    false_panel(figure.add_subplot(grid[1]), curves, axis)
    write_thresholds(left, remarks)
    panels.legend(figure, (0.065, 0.56 / height), entries, min(6, len(entries)))
    panels.write_caption(figure, 0.065, caption(curves, axis, central is not None))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
