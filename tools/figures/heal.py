#!/usr/bin/python3
"""A partition over time: how far the estimates of all agents lie apart and how large their error is,
before, during and after a cut; a row of panels a topology, a curve a rule.

    heal.py DATABASE OUTPUT --cut FROM UNTIL [--AXIS LABEL]… [--study S]

FROM and UNTIL are in seconds. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

SERIES = ("rms_error_m", "claimed_sigma_m", "disagreement_m")
DASHED = (0, (3.2, 1.4))
LEAST_M = 1e-4  # whoever is nearer agrees for every purpose


def spread(series, cell):
    """Root mean square over repetitions and subjects of the largest distance between any two."""
    return panels.rms(series, cell, "central", interval=True)


class Heal:
    """The numbers behind the figure."""

    def __init__(self, chosen, cut):
        chosen.require_axes("topology", "rule")
        self.chosen = chosen
        self.cut = cut
        self.topologies = chosen.labels("topology")
        self.rules = chosen.labels("rule")
        self.series = chosen.series(SERIES)
        error = self.series["rms_error_m"]
        self.t_s = error.t_s
        self.agents = int((error.agents >= 0).sum())

    def curves(self, topology, rule):
        """(disagreement, error, claim) over time, or None."""
        cell = self.chosen.cell(topology=topology, rule=rule)
        if cell is None:
            return None
        return (
            spread(self.series["disagreement_m"], cell),
            panels.rms(self.series["rms_error_m"], cell, interval=True),
            panels.rms(self.series["claimed_sigma_m"], cell),
        )


def panel(axes, heal, curves, dash="-", shaded=True):
    """One quantity, a curve a rule; later rules have wider lines, so that what lies under an equal
    curve is seen. Zero lies below every panel."""
    floor = axes.get_ylim()[0]
    for k, (rule, curve) in enumerate(curves.items()):
        color, _ = style.rule_style(rule, heal.rules)
        if shaded:
            axes.fill_between(
                heal.t_s, np.maximum(curve.low, 0.1 * floor), curve.high, color=color, alpha=0.25,
                lw=0.0, zorder=2,
            )
        value = np.where(curve.value > 0.0, curve.value, 0.1 * floor)
        axes.plot(heal.t_s, value, ls=dash, color=color, lw=1.1 + 0.5 * k, zorder=4 - 0.1 * k)


def sketch_cut(axes, heal):
    axes.axvspan(*heal.cut, color="#ececec", lw=0.0, zorder=0.5)


def layout(heal):
    rows = len(heal.topologies)
    figure = style.new_figure(10.4, 2.75 * rows + 1.75)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, 2, wspace=0.16, hspace=0.14, left=0.125, right=0.985, top=1 - 0.42 / height,
        bottom=1.3 / height,
    )
    table = []
    for i in range(rows):
        row = [figure.add_subplot(grid[i, k]) for k in range(2)]
        for axes in row:
            end = float(heal.t_s[-1])
            axes.set_xlim(0.0, end)
            axes.set_xticks(np.arange(0.0, end + 1.0, 20.0))
            axes.tick_params(labelbottom=i == rows - 1)
            sketch_cut(axes, heal)
        table.append(row)
    return figure, table


def caption(heal):
    chosen = heal.chosen
    others = chosen.described("topology", "rule")
    start, end = heal.cut
    sentences = [
        f"{heal.agents} agents{', ' + others if others else ''}; {chosen.repetitions} paired"
        f" repetitions; grey: two groups do not hear each other, {start:g} to {end:g} s.",
        "Root mean squares over repetitions, of errors over agents too, with 95 % bootstrap"
        " intervals.",
        f"Disagreement is the largest distance an axis between any two estimates; below"
        f" {LEAST_M * 1e3:g} mm it is not drawn.",
        "No curve where more than half of the beliefs have no estimate, or no claim.",
    ]
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def headings(figure, table, heal):
    height = figure.get_figheight()
    titles = (
        "How far estimates lie apart [m]",
        "True error and claimed σ (dashed) a coordinate [m]",
    )
    for axes, title in zip(table[0], titles):
        axes.set_title(title, loc="left", fontsize=10, fontweight="bold", pad=7)
    for axes in table[-1]:
        axes.set_xlabel("time [s]", labelpad=1.5)
    panels.label_rows(figure, table, heal.topologies, heal.agents)
    entries = [
        panels.line_entry("-", style.rule_style(rule, heal.rules)[0], rule) for rule in heal.rules
    ]
    left = table[0][0].get_position().x0
    panels.legend(figure, (left, 0.56 / height), entries, len(entries))
    panels.write_caption(figure, left, caption(heal))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--cut", nargs=2, type=float, required=True, metavar=("FROM", "UNTIL"))
    arguments, chosen = data.parse(parser)
    heal = Heal(chosen, arguments.cut)
    figure, table = layout(heal)
    found = {
        (topology, rule): curves
        for topology in heal.topologies
        for rule in heal.rules
        if (curves := heal.curves(topology, rule)) is not None
    }
    apart = panels.finite([c[0].value for c in found.values()], "disagreement")
    errors = panels.sigma_range([c[1] for c in found.values()])
    for row, topology in zip(table, heal.topologies):
        of_rule = {rule: found[topology, rule] for rule in heal.rules if (topology, rule) in found}
        style.log_axis(row[0], LEAST_M, 2.0 * apart.max())
        panel(row[0], heal, {rule: curves[0] for rule, curves in of_rule.items()})
        style.log_axis(row[1], 0.5 * errors[0], errors[1])
        panel(row[1], heal, {rule: curves[2] for rule, curves in of_rule.items()}, DASHED, False)
        panel(row[1], heal, {rule: curves[1] for rule, curves in of_rule.items()})
    headings(figure, table, heal)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
