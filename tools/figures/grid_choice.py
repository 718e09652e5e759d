#!/usr/bin/python3
"""Which rule detects most at a given rate of false alarms: a table, a line a cell of the study, a column a rule.

    grid_choice.py DATABASE OUTPUT [--false 0.001] [--rows AXIS;AXIS] [--by rule] [--study S]

Of each rule that threshold counts, among those of record.alarms.thresholds, at which the mean P_F (share of the empty
cells over it, at the end of the runs) is at most --false and the mean P_D (share of the cells with a target) is
largest. OUTPUT ends with .md (with a .csv beside it) or .csv. Any other axis of the study is chosen by an option of
its name.
"""

import argparse
import itertools

import numpy as np

import data
import panels
import style
from grid_levels import ALONE, numeric
from roc import DETECTED, FALSE, ends_by_threshold


class Choice:
    """P_D with its interval, P_F and threshold of one rule in one cell; NaN where every threshold raises more."""

    def __init__(self, detected, false, cell, limit):
        self.value = self.low = self.high = self.false = float("nan")
        self.threshold = ""
        for threshold in sorted(detected, key=float):
            if threshold not in false:
                continue
            p_false = panels.mean(false[threshold], cell, "agents").value[0]
            if not p_false <= limit:
                continue
            curve = panels.mean(detected[threshold], cell, "agents", interval=True)
            if not self.value >= curve.value[0]:
                self.value, self.low, self.high = curve.value[0], curve.low[0], curve.high[0]
                self.false, self.threshold = p_false, threshold

    def text(self, best):
        if not np.isfinite(self.value):
            return "–"
        number = f"{self.value:.2f}"
        return f"{f'**{number}**' if best else number} ({self.low:.2f}…{self.high:.2f}) at {self.threshold}"


def in_order(labels):
    """Numbers by size, names as the study has them."""
    return sorted(labels, key=float) if numeric(labels) else labels


def cell_of(chosen, by, label, where):
    cell = chosen.cell(**{by: label}, **where)
    return chosen.cell(**{by: label}) if cell is None and label == ALONE else cell


def lines_of(chosen, by, labels, rows, limit):
    """[(labels of the rows' axes, {label: Choice})]"""
    detected, false = (ends_by_threshold(chosen, name) for name in (DETECTED, FALSE))
    lines = []
    for place in itertools.product(*(in_order(chosen.labels(axis)) for axis in rows)):
        choices = {}
        for label in labels:
            cell = cell_of(chosen, by, label, dict(zip(rows, place)))
            if cell is not None:
                choices[label] = Choice(detected, false, cell, limit)
        if choices:
            lines.append((place, choices))
    return lines


def as_markdown(chosen, rows, labels, lines, limit):
    heads = [*rows, *labels]
    out = [
        f"# P_D where at most {limit:g} of the empty cells raise an alarm",
        "",
        f"Means over vehicles and {chosen.repetitions} paired repetitions at the end of the runs, with 95 % bootstrap"
        " intervals over repetitions, at the threshold that detects most. Bold: the most of a line, and what its"
        " interval holds. –: every threshold raises more.",
        "",
        "| " + " | ".join(heads) + " |",
        "|" + "---|" * len(heads),
    ]
    for place, choices in lines:
        known = [c for c in choices.values() if np.isfinite(c.value)]
        top = max(known, key=lambda c: c.value, default=None)
        texts = [choices[l].text(top is not None and choices[l].value >= top.low) if l in choices else "" for l in labels]
        out.append("| " + " | ".join([*place, *texts]) + " |")
    if chosen.failed:
        out += ["", f"{chosen.failed} failed runs left out."]
    return "\n".join(out) + "\n"


def as_csv(rows, by, lines):
    out = [",".join([*rows, by, "p_detect", "low", "high", "p_false", "threshold"])]
    for place, choices in lines:
        for label, c in choices.items():
            numbers = [style.plain_number(v) if np.isfinite(v) else "" for v in (c.value, c.low, c.high, c.false)]
            out.append(",".join([*place, label, *numbers, c.threshold]))
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--false", type=float, default=0.001, dest="limit", help="largest P_F")
    parser.add_argument("--rows", default="", help="axes with a line a label, with ; between them")
    parser.add_argument("--by", default="rule", help="axis with a column a label")
    arguments, chosen = data.parse(parser)
    rows = panels.names_in(arguments.rows, "--rows") if arguments.rows else []
    chosen.require_axes(arguments.by, *rows)
    if not arguments.output.endswith((".md", ".csv")):
        raise data.UserError(f"{arguments.output}: a table ends with .md or .csv")
    labels = chosen.labels(arguments.by)
    lines = lines_of(chosen, arguments.by, labels, rows, arguments.limit)
    stem = arguments.output.rpartition(".")[0]
    data.write_text(stem + ".csv", as_csv(rows, arguments.by, lines))
    if arguments.output.endswith(".md"):
        data.write_text(arguments.output, as_markdown(chosen, rows, labels, lines, arguments.limit))


if __name__ == "__main__":
    data.main(main)
