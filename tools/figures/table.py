#!/usr/bin/python3
"""The numbers at the end of the runs, a line a cell: true error with its 95 % interval, what is
claimed, what the ledger says, ANEES, multiplicity. What the study did not record is left out.

    table.py DATABASE OUTPUT.md [--AXIS LABEL]… [--study S]

OUTPUT.md is a Markdown table; OUTPUT.csv beside it has the same rows with more digits. With an
output that ends with .csv only that is written. Options named after axes (--loss 0.1) choose cells.
"""

import argparse
import csv
import io
import os

import numpy as np

import data
import panels
import stats
import style

TIED = "all"  # label of an axis that makes no difference to the central filter


class Numbers:
    """The table's columns: a function a column, from (cell, "agents" or "central") to a value."""

    def __init__(self, chosen):
        self.columns = {}
        names = [
            n
            for n in ("rms_error_m", "claimed_sigma_m", "true_sigma_m", "nees", "multiplicity_mean")
            if chosen.has_series(n)
        ]
        series = chosen.series(names, at_end=True) if names else {}
        self._distance(chosen)
        if "rms_error_m" in series:
            self._error(series["rms_error_m"])
        for name, heading in (
            ("claimed_sigma_m", "claimed_sigma_m"),
            ("true_sigma_m", "ledger_sigma_m"),
        ):
            if name in series:
                values = series[name]
                self.columns[heading] = lambda c, who, s=values: panels.rms(s, c, who).value[0]
        if "nees" in series and "claimed_sigma_m" in series:
            nees, claims = series["nees"], series["claimed_sigma_m"]
            dimension = chosen.state_dimension()
            self.columns["anees"] = (
                lambda c, who: panels.anees(nees, claims, c, dimension, who).value[0]
            )
        if "multiplicity_mean" in series:
            self.columns["multiplicity"] = (
                lambda c, who: panels.mean(series["multiplicity_mean"], c, who).value[0]
            )
        if "claimed_sigma_m" in series:
            claimed = series["claimed_sigma_m"]

            def undefined(c, who):
                return 1.0 - claimed.of("count", who)[c].sum() / max(
                    claimed.of("asked", who)[c].sum(), 1.0
                )

            self.columns["undefined_share"] = undefined

    def _error(self, series):
        def bound(which):
            return lambda c, who: getattr(panels.rms(series, c, who, True), which)[0]

        self.columns["rms_error_m"] = lambda c, who: panels.rms(series, c, who).value[0]
        self.columns["rms_error_low_m"] = bound("low")
        self.columns["rms_error_high_m"] = bound("high")

    def _distance(self, chosen):
        scalar = chosen.scalar("distance_error_m")
        agents = [a for a in scalar if a >= 0]
        if not agents:
            return

        def values(c, who):  # [repetition, agent]
            return np.stack([scalar[a][c] for a in (agents if who == "agents" else [-1])], axis=1)

        def interval(c, who):
            found = values(c, who) if who == "agents" or -1 in scalar else np.full((1, 1), np.nan)
            defined = np.isfinite(found)
            total = np.where(defined, found, 0.0).sum(axis=1)[:, None]
            count = defined.sum(axis=1)[:, None].astype(float)
            value = total.sum() / count.sum() if count.sum() > 0 else np.nan
            low, high = stats.ratio_interval(total, count)
            return value, low[0], high[0]

        for i, name in enumerate(("distance_m", "distance_low_m", "distance_high_m")):
            self.columns[name] = lambda c, who, i=i: interval(c, who)[i]


def rows_of(chosen, numbers):
    """(labels, values) a line: all cells, then the central filter, once for all cells in which it
    is the same."""
    axes = chosen.axes
    lines = []
    for c, cell in enumerate(chosen.cells):
        lines.append(
            ([cell[a] for a in axes], [f(c, "agents") for f in numbers.columns.values()])
        )
    groups = {}
    for c, cell in enumerate(chosen.cells):
        values = [f(c, "central") for f in numbers.columns.values()]
        if np.isfinite(values[:1]).any():
            groups.setdefault(tuple(f"{v:.12g}" for v in values), ([], values))[0].append(cell)
    for cells, values in groups.values():
        labels = []
        for axis in axes:
            found = list(dict.fromkeys(cell[axis] for cell in cells))
            if axis == "rule":
                labels.append("central")
            else:
                labels.append(found[0] if len(found) == 1 else TIED)
        lines.append((labels, values))
    return lines


def csv_text(chosen, numbers, lines):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(chosen.axes + list(numbers.columns))
    for labels, values in lines:
        writer.writerow(labels + [f"{v:.9g}" if np.isfinite(v) else "" for v in values])
    return out.getvalue()


HEADINGS = {
    "distance_m": "distance to truth [m]",
    "rms_error_m": "true error [m] (95 %)",
    "claimed_sigma_m": "claimed σ [m]",
    "ledger_sigma_m": "ledger's σ [m]",
    "anees": "ANEES",
    "multiplicity": "multiplicity",
    "undefined_share": "indefinite",
}


def cell_text(name, values):
    value = values[name]
    if name == "undefined_share":
        return f"{100.0 * value:.0f} %" if value > 0 else ""
    text = style.plain_number(value)
    if name in ("distance_m", "rms_error_m"):
        ends = [values[name[:-1] + end + "_m"] for end in ("low", "high")]
        texts = [style.plain_number(end) for end in ends]
        if np.isfinite(ends).all() and texts != [text, text]:
            text += f" ({texts[0]} – {texts[1]})"
    return text


def markdown(chosen, numbers, lines):
    # Axes with one label are said once, above the table. One measure of the error is enough: that
    # a coordinate beside ANEES, else the distance, in which results on real logs are published.
    said = [a for a in chosen.axes if len(chosen.labels(a)) == 1]
    axes = [i for i, a in enumerate(chosen.axes) if a not in said]
    names = [n for n in HEADINGS if n in numbers.columns]
    if "distance_m" in names and "rms_error_m" in names:
        names.remove("distance_m" if "anees" in names else "rms_error_m")
    if "undefined_share" in names and all(values[-1] == 0.0 for _, values in lines):
        names.remove("undefined_share")
    table = [[chosen.axes[i] for i in axes] + [HEADINGS[n] for n in names]]
    for labels, values in lines:
        by_name = dict(zip(numbers.columns, values))
        table.append([labels[i] for i in axes] + [cell_text(n, by_name) for n in names])
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    text = [f"**{chosen.study}** at the end of the runs, {chosen.repetitions} repetitions"]
    text[0] += "".join(f", {a} {chosen.labels(a)[0]}" for a in said)
    text[0] += f"; {chosen.failed} failed runs left out" if chosen.failed else ""
    text.append("")
    for k, row in enumerate(table):
        text.append("| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths)) + " |")
        if k == 0:
            text.append("|" + "|".join("-" * (w + 2) for w in widths) + "|")
    return "\n".join(text) + "\n"


def main():
    arguments, chosen = data.parse(argparse.ArgumentParser(description=__doc__.split("\n\n")[0]))
    stem, ending = os.path.splitext(arguments.output)
    if ending not in (".md", ".csv"):
        raise data.UserError(f"{arguments.output}: a table ends with .md or .csv")
    numbers = Numbers(chosen)
    if not numbers.columns:
        raise data.UserError(f"{arguments.database}: study {chosen.study!r} recorded no errors")
    lines = rows_of(chosen, numbers)
    data.write_text(stem + ".csv", csv_text(chosen, numbers, lines))
    if ending == ".md":
        data.write_text(arguments.output, markdown(chosen, numbers, lines))


if __name__ == "__main__":
    data.main(main)
