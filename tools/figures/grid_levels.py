#!/usr/bin/python3
"""What exploring vehicles or foraging robots end with against the labels of an axis, such as their number, the loss
of the radio, the time between talks: a row a metric, a column a label of another axis, a line a rule.

    grid_levels.py DATABASE OUTPUT --over AXIS [--panels AXIS] [--by rule] [--rules A;B;…]
                   [--metrics cells_false_share;bytes_sent] [--threshold 0.8] [--team] [--study S]

Metrics are series, at their end, or scalars, of each agent or with --team of all together. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is
chosen by an option of its name.
"""

import argparse
import math

import numpy as np

import data
import panels
import stats
import style

MEDIANS = ("alarms_found_s", "first_arrival_s", "recovery_s")  # infinite in runs that never get there
KILO = ("bytes_sent",)  # drawn in thousands
ALONE = "none"  # who hears nobody is the same whatever the radio does: studies may run it once
SPAN = 20.0  # numbers on an axis that span more are spaced by their logarithms
# Axis of the study: what stands below the panels.
TITLES = {"loss": "share of packets lost", "agents": "vehicles", "talk": "time between talks [s]"}


class Metric:
    """Values at the end of the runs, by cell."""

    def __init__(self, chosen, name, threshold, team=False):
        self.name = name
        self.subject, self._series, self._scalar = None, None, None
        self.median = name in MEDIANS
        if chosen.has_series(name):
            self.subject = panels.threshold_subject(chosen, name, threshold)
            self._series = chosen.series((name,), at_end=True, subject=self.subject)[name]
            agents = self._series.agents
        else:
            self._scalar = chosen.scalar(name)
            agents = np.array(sorted(self._scalar))
            if not self._scalar:
                raise data.UserError(f"no series or scalar {name!r} in these runs of {chosen.study!r}")
        if team and data.CENTRAL not in agents:
            raise data.UserError(f"--team: {name} was recorded of agents alone")
        self.of_fleet = team or not (agents >= 0).any()  # agent −1 speaks for all
        # Of foragers agent −1 is the team, no filter that has every look.
        self.has_central = (data.CENTRAL in agents and not self.of_fleet and name != "cells_seen_share"
                            and not forage(chosen))

    def of(self, cell, central=False):
        """(value, low, high) over vehicles and repetitions, or of agent −1; NaN where unknown."""
        if cell is None:
            return (math.nan,) * 3
        central = central or self.of_fleet
        if self._series is not None:
            curve = panels.mean(self._series, cell, "central" if central else "agents", interval=True)
            return curve.value[0], curve.low[0], curve.high[0]
        values = np.array([v[cell] for a, v in sorted(self._scalar.items()) if (a < 0) == central]).T
        values = values * (1e-3 if self.name in KILO else 1.0)
        if self.median:
            return stats.median_interval(values)
        known = np.isfinite(values)
        totals, counts = (a.sum(axis=1, keepdims=True).astype(float) for a in (np.where(known, values, 0.0), known))
        if counts.sum() == 0:
            return (math.nan,) * 3
        low, high = stats.ratio_interval(totals, counts)
        return float(totals.sum() / counts.sum()), float(low[0]), float(high[0])


class Levels:
    """The numbers behind the figure."""

    def __init__(self, chosen, over, columns, by, labels, metrics):
        self.chosen, self.over, self.by, self.columns = chosen, over, by, columns
        levels = chosen.labels(over)
        self.levels = sorted(levels, key=float) if numeric(levels) else levels
        self.panels = chosen.labels(columns) if columns else [None]
        self.labels = labels
        self.metrics = metrics

    def cells(self, panel, label):
        """Number of the cell at each level, None where the study has none."""
        where = {**({self.columns: panel} if self.columns else {}), **({self.by: label} if label is not None else {})}
        cells = [self.chosen.cell(**where, **{self.over: level}) for level in self.levels]
        there = [cell for cell in cells if cell is not None]
        if label == ALONE and not there and self.columns:  # run once for all panels, too
            there = [c for c in [self.chosen.cell(**{self.by: label})] if c is not None]
        return there * len(cells) if label == ALONE and len(there) == 1 else cells

    def curve(self, metric, panel, label):
        """(value, low, high), an entry a level."""
        return np.array([metric.of(cell) for cell in self.cells(panel, label)]).T

    def central(self, metric, panel):
        """The central grid's, at each level the mean over all lines' cells; not where one is infinite."""
        values = np.array([[metric.of(cell, True)[0] for cell in self.cells(panel, l)] for l in self.labels])
        known = ~np.isnan(values)
        totals = np.where(known, values, 0.0).sum(axis=0)
        clear = known.any(axis=0) & np.isfinite(totals)
        return np.divide(totals, known.sum(axis=0), out=np.full(totals.shape, np.nan), where=clear)

    def places(self):
        """(x of each level, shift of a line, whether spaced by logarithms)"""
        if not numeric(self.levels):
            return np.arange(len(self.levels), dtype=float), 0.06, False
        x = np.array([float(level) for level in self.levels])
        spread = x.min() > 0.0 and x.max() > SPAN * x.min()
        x = np.log(x) if spread else x
        return x, 0.008 * (np.ptp(x) or 1.0), spread


def forage(chosen):
    """Whether the agents of these runs are foragers."""
    return bool(chosen.rows("SELECT 1 FROM agent WHERE run = (SELECT MIN(run) FROM temp.chosen)"
                            " AND kind = 'forager' LIMIT 1"))


def look(by, label, labels):
    """Colour and marker of a line."""
    if label is None:
        return style.BLUE, "o"
    return style.rule_style(label, labels) if by == "rule" else style.label_style(label, labels)


def numeric(labels):
    try:
        return np.isfinite([float(label) for label in labels]).all()
    except ValueError:
        return False


class ValueAxis:
    """The y axis of a row: linear from zero, or logarithmic with zeros at the bottom; what never comes stands
    above a line."""

    def __init__(self, values):
        finite = values[np.isfinite(values)]
        self.empty = len(finite) == 0
        if self.empty:
            finite = np.array([0.0, 1.0])
        self.log = panels.wants_log(finite)
        self.never = np.isposinf(values).any()
        positive = finite[finite > 0.0]
        self.zero = positive.min() / 2.6 if self.log else 0.0
        self.has_zero = self.log and (finite <= 0.0).any()
        low, high = min(0.0, finite.min()), max(0.0, finite.max())
        if self.log:
            self.low, self.ceiling = (self.zero / 1.5 if self.has_zero else positive.min() / 1.6), 1.6 * high
            self.high = self.ceiling * (1.9 if self.never else 1.0)
            self.above = 1.4 * self.ceiling
        else:
            room = (high - low) or 1.0
            self.low, self.ceiling = low - (0.05 * room if low < 0.0 else 0.0), high + 0.06 * room
            self.high = self.ceiling + (0.16 * room if self.never else 0.0)
            self.above = self.ceiling + 0.08 * room

    def at(self, values):
        with np.errstate(invalid="ignore"):
            placed = np.where(np.isposinf(values), self.above, values)
            return np.where(placed <= 0.0, self.zero, placed) if self.log else placed

    def apply(self, axes):
        if self.log:
            style.log_axis(axes, self.low, self.high)
            if self.has_zero:
                ticks = [t for t in axes.get_yticks() if 1.7 * self.zero < t <= self.high]
                formatter = axes.yaxis.get_major_formatter()
                names = [formatter(t) for t in ticks]
                axes.set_yticks([self.zero, *ticks], ["0", *names])
                axes.axhline(1.6 * self.zero, color=style.GREY, lw=0.7, ls=(0, (2, 2)), zorder=1)
        else:
            axes.set_ylim(self.low, self.high)
        if self.never:
            axes.axhline(self.ceiling, color=style.GREY, lw=0.7, ls=(0, (2, 2)), zorder=1)
            ticks = [] if self.empty else [t for t in axes.get_yticks() if self.low <= t < self.ceiling]
            axes.set_yticks([*ticks, self.above], [*(f"{t:g}" for t in ticks), "never"])
            axes.set_ylim(self.low, self.high)


def panel(axes, levels, metric, name, axis):
    axis.apply(axes)
    x, shift, _ = levels.places()
    if metric.has_central:
        axes.plot(x, axis.at(levels.central(metric, name)), "-", color=style.BLACK, lw=1.3, zorder=2.5)
    for k, label in enumerate(levels.labels):
        color, marker = look(levels.by, label, levels.labels)
        value, low, high = levels.curve(metric, name, label)
        if not np.isfinite(value).any() and not np.isinf(value).any():
            continue
        at = x + shift * (k - 0.5 * (len(levels.labels) - 1))
        faint = 1.0 if numeric(levels.levels) else 0.35  # there is nothing between names
        axes.plot(at, np.where(np.isinf(value), np.nan, axis.at(value)), ls=style.rule_dash(label), color=color, lw=1.2,
                  alpha=faint, zorder=3)  # no line leads to what never comes
        known = ~np.isnan(low) & ~np.isnan(high)
        axes.vlines(at[known], axis.at(low)[known], axis.at(high)[known], color=color, lw=0.9, alpha=0.75, zorder=2)
        beyond = np.isinf(value) | (axis.log & (value <= 0.0))
        never = np.isinf(value)
        for mask, face, sign in ((~beyond, color, marker), (beyond & ~never, "white", marker), (never, "white", "^")):
            axes.plot(at[mask], axis.at(value)[mask], sign, color=color, mfc=face, ms=4.6, mew=1.0,
                      zorder=4, clip_on=False)


def level_axis(axes, levels, lowest):
    x, shift, _ = levels.places()
    beside = 0.5 * shift * len(levels.labels) + (0.35 if not numeric(levels.levels) else 0.0)
    room = max(0.06 * np.ptp(x), beside) or 0.5
    axes.set_xlim(x.min() - room, x.max() + room)
    names = [data.percent(l) if levels.over == "loss" else l for l in levels.levels]
    shown, before = [], -np.inf
    for place, name in zip(x, names):  # names must not touch
        shown.append(name if place - before > 0.11 * (np.ptp(x) or 1.0) or not numeric(levels.levels) else "")
        before = place if shown[-1] else before
    axes.set_xticks(x, shown if lowest else [""] * len(x))
    if lowest and not numeric(levels.levels) and max(map(len, names)) * len(names) > 30:
        for text in axes.get_xticklabels():
            text.set(rotation=40, ha="right", rotation_mode="anchor")


def all_values(levels, metric):
    """Whatever is drawn of a metric."""
    found = []
    for name in levels.panels:
        found += [levels.curve(metric, name, label).ravel() for label in levels.labels]
        found += [levels.central(metric, name)] if metric.has_central else []
    values = np.concatenate(found)
    values = values[~np.isnan(values)]
    if len(values) == 0:
        raise data.UserError(f"no {metric.name} is defined in these runs; nothing to draw")
    return values


def title_of(levels):
    name = TITLES.get(levels.over, levels.over.replace("_", " "))
    return name + (" (spaced by logarithms)" if levels.places()[2] else "")


def draw(levels, entries):
    """The figure, with a legend of these entries."""
    rows, columns = len(levels.metrics), len(levels.panels)
    names = [data.percent(l) if levels.over == "loss" else l for l in levels.levels]
    long = not numeric(levels.levels) and max(map(len, names)) * len(names) > 30
    width = max(3.0 * columns + 1.0, 7.6)
    per_line = max(2, int((width - 0.8) / 1.35))
    lines = math.ceil(len(entries) / per_line)
    left = 0.9 / width
    scales = [ValueAxis(all_values(levels, metric)) for metric in levels.metrics]
    sentences = caption(levels, scales)
    room = panels.caption_room(width, left, sentences)
    below = 1.02 + 0.2 * lines + room + (0.045 * max(map(len, names)) if long else 0.0)
    height = 2.25 * rows + 0.35 + below
    figure = style.new_figure(width, height)
    grid = figure.add_gridspec(rows, columns, left=left, right=0.985, top=1 - 0.35 / height, bottom=below / height,
                               wspace=0.08, hspace=0.13)
    for i, (metric, axis) in enumerate(zip(levels.metrics, scales)):
        for j, name in enumerate(levels.panels):
            axes = figure.add_subplot(grid[i, j])
            panel(axes, levels, metric, name, axis)
            level_axis(axes, levels, i == rows - 1)
            axes.tick_params(labelleft=j == 0)
            if i == 0 and name is not None:
                axes.set_title(panels.label_name(levels.columns, name), fontweight="bold", loc="left", pad=4)
            if j == 0:
                axes.set_ylabel(panels.metric_name(metric.name, metric.subject, short=True)
                                + (" (log)" if axis.log else ""))
            if i == rows - 1:
                axes.set_xlabel(title_of(levels), labelpad=1.5)
    if entries:
        panels.legend(figure, (left, (0.56 + room) / height), entries, min(per_line, len(entries)))
    panels.write_caption(figure, left, sentences, room)
    return figure


def caption(levels, scales):
    chosen = levels.chosen
    drawn = [a for a in (levels.over, levels.columns, levels.by) if a]
    others = chosen.described(*drawn)
    each = "robots" if forage(chosen) else "vehicles"
    whose = "of all together; means over" if all(m.of_fleet for m in levels.metrics) else f"means over {each} and"
    sentences = [
        f"At the end of the runs; {whose} {chosen.repetitions} paired"
        f" repetitions{', ' + others if others else ''}; strokes: 95 % bootstrap interval over repetitions.",
    ]
    if any(m.median for m in levels.metrics):
        over = "repetitions" if all(m.of_fleet for m in levels.metrics if m.median) else f"{each} and repetitions"
        names = " and ".join(panels.metric_name(m.name).replace(" [s]", "") for m in levels.metrics if m.median)
        sentences.append(f"Of {names}: medians over {over}, counting who never gets there.")
    if any(m.has_central for m in levels.metrics):
        sentences.append("Black: the central grid, which has every look once, mean over the lines' runs.")
    if any(axis.has_zero for axis in scales):
        sentences.append("Hollow, below the dotted line of a logarithmic axis: zero.")
    if any(axis.never for axis in scales):
        sentences.append("Arrows above a dotted line: most of them never do.")
    if ALONE in levels.labels and any(len(set(levels.cells(p, ALONE))) < len(levels.levels) for p in levels.panels):
        sentences.append(f"{ALONE}: run once, for it does not depend on the axis.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--over", required=True, help="axis below the panels")
    parser.add_argument("--panels", help="axis with a column a label")
    parser.add_argument("--by", default="rule", help="axis with a line a label")
    parser.add_argument("--rules", "--labels", default="", dest="labels", help="labels of that axis, with ; between")
    parser.add_argument("--metrics", "--metric", default="cells_false_share", help="series or scalars, with ; between")
    parser.add_argument("--threshold", default="0.8", help="of metrics of alarms")
    parser.add_argument("--team", action="store_true", help="of all together: agent −1")
    arguments, chosen = data.parse(parser)
    by = arguments.by if arguments.by != "rule" or "rule" in chosen.axes else None
    drawn = [axis for axis in (arguments.over, arguments.panels, by) if axis]
    if len(set(drawn)) < len(drawn):
        raise data.UserError(f"--over, --panels and --by name one axis twice: {', '.join(drawn)}")
    chosen.require_axes(*drawn)
    labels = panels.chosen_labels(chosen, by, arguments.labels) if by else [None]
    metrics = [
        Metric(chosen, m, arguments.threshold, arguments.team) for m in panels.names_in(arguments.metrics, "--metrics")
    ]
    levels = Levels(chosen, arguments.over, arguments.panels, by, labels, metrics)
    entries = []
    for label in labels if by else []:
        color, marker = look(by, label, labels)
        entries.append(panels.line_entry(style.rule_dash(label), color, panels.label_name(by, label), marker))
    if any(m.has_central for m in metrics):
        entries.append(panels.line_entry("-", style.BLACK, "central grid"))
    style.write(draw(levels, entries), arguments.output)


if __name__ == "__main__":
    data.main(main)
