#!/usr/bin/python3
"""What rumour does to a fleet: a row of panels a topology. In each, one panel a fusion rule of what
the beliefs claim, what their true error is and what the ledger says it is; then ANEES with its 95 %
band; then how often the average measurement is counted.

    rumour.py DATABASE OUTPUT [--phase staggered] [--sensors complementary] [--loss 0.1] [--study S]

OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen in the same way.
"""

import argparse

import numpy as np

import data
import panels
import stats
import style

SERIES = ("rms_error_m", "claimed_sigma_m", "true_sigma_m", "nees", "multiplicity_mean")


DEFAULTS = {"phase": "staggered", "sensors": "complementary", "loss": "0.1"}


class Rumour:
    """The numbers behind the figure."""

    def __init__(self, chosen):
        chosen.require_axes("topology", "rule")
        self.chosen = chosen
        self.topologies = chosen.labels("topology")
        self.rules = chosen.labels("rule")
        self.series = chosen.series(SERIES)
        error = self.series["rms_error_m"]
        self.t_s = error.t_s
        self.agents = int((error.agents >= 0).sum())
        self.dimension = chosen.state_dimension()
        # ANEES values in the figure: one an agent and instant in each panel and rule
        self.comparisons = self.agents * len(self.t_s) * len(chosen.cells)

    def sigma_curves(self, topology, rule):
        """(error, claimed, ledger, central, share of beliefs undefined at the end) or None."""
        cell = self.chosen.cell(topology=topology, rule=rule)
        if cell is None:
            return None
        claimed = self.series["claimed_sigma_m"]
        asked = claimed.of("asked", "agents")[cell][:, -1].sum()
        defined = claimed.of("count", "agents")[cell][:, -1].sum()
        return (
            panels.rms(self.series["rms_error_m"], cell, interval=True),
            panels.rms(claimed, cell),
            panels.rms(self.series["true_sigma_m"], cell),
            panels.rms(claimed, cell, "central"),
            1.0 - defined / asked if asked else 0.0,
        )


def sigma_panel(axes, t_s, curves, color):
    error, claimed, ledger, central, undefined = curves
    floor, ceiling = axes.get_ylim()
    panels.shade_gap(axes, t_s, claimed, error, color)
    panels.draw(axes, t_s, central, style.BLACK, "-", width=1.0, zorder=2)
    axes.fill_between(t_s, error.low, error.high, color=color, alpha=0.45, lw=0.0, zorder=2.5)
    panels.draw(axes, t_s, error, color, "-", marker="o", width=1.8)
    panels.draw(axes, t_s, claimed, color, (0, (3.2, 1.4)), width=1.8, zorder=3.5)
    panels.draw(axes, t_s, ledger, style.BLACK, (0, (1.0, 1.5)), width=1.5, zorder=4)
    end_error, end_claim = error.value[-1], claimed.value[-1]
    if undefined == 0 and np.isfinite(end_error) and np.isfinite(end_claim):
        panels.note(axes, f"error = {style.ratio(end_error / end_claim)} claim")
    if undefined > 0:
        panels.note(axes, f"{100 * undefined:.0f} % of beliefs\nindefinite at the end", "bottom")
    elif end_claim < floor:
        panels.note(axes, f"↓ claims {style.number(end_claim)} m", "bottom", color)
    elif end_error > ceiling:
        panels.note(axes, f"↑ errs by {style.number(end_error)} m", "bottom", color)


def anees_panel(axes, rumour, topology):
    for comparisons, shade in ((rumour.comparisons, "#e6e6e6"), (1, "#c4c4c4")):
        low, high = stats.anees_band(rumour.dimension, rumour.chosen.repetitions, comparisons)
        axes.axhspan(low, high, color=shade, lw=0.0, zorder=0.5)
    beyond = []
    ceiling = axes.get_ylim()[1]
    for k, rule in enumerate(rumour.rules):
        cell = rumour.chosen.cell(topology=topology, rule=rule)
        if cell is None:
            continue
        nees, claimed = rumour.series["nees"], rumour.series["claimed_sigma_m"]
        curve = panels.anees(nees, claimed, cell, rumour.dimension)
        color, marker = style.rule_style(rule, rumour.rules)
        axes.vlines(rumour.t_s, curve.low, curve.high, color=color, lw=2.6, alpha=0.3, zorder=2)
        panels.draw(axes, rumour.t_s, curve, color, marker=marker, zorder=4 - 0.1 * k)
        if np.isfinite(curve.value[-1]) and curve.value[-1] > ceiling:
            beyond.append(f"{rule}: {style.number(curve.value[-1])} ↑")
    if beyond:
        panels.note(axes, "\n".join(beyond), "top")


def multiplicity_panel(axes, rumour, topology):
    axes.axhline(1.0, color=style.BLACK, lw=0.8, zorder=1)
    for k, rule in enumerate(rumour.rules):
        cell = rumour.chosen.cell(topology=topology, rule=rule)
        if cell is None:
            continue
        curve = panels.mean(rumour.series["multiplicity_mean"], cell)
        curve.value = np.where(curve.value > 0, curve.value, np.nan)
        color, marker = style.rule_style(rule, rumour.rules)
        panels.draw(axes, rumour.t_s, curve, color, marker=marker, zorder=4 - 0.1 * k)


def limits_of_multiplicity(rumour):
    series = rumour.series["multiplicity_mean"]
    cells = range(len(rumour.chosen.cells))
    values = panels.finite([panels.mean(series, c).value for c in cells], "multiplicity")
    return min(0.5, 0.6 * values[values > 0].min(initial=1.0)), max(3.0, 3.0 * values.max())


def caption(rumour):
    chosen = rumour.chosen
    sentences = [
        f"{rumour.agents} agents, 1 static target in {rumour.dimension}-D,"
        f" {chosen.described('topology', 'rule')}; {chosen.repetitions} paired repetitions.",
        "Means over agents (of squares for metres); error with its 95 % bootstrap interval over"
        " repetitions.",
        "ANEES: bars from the least to the greatest agent; grey, where a consistent one lies with"
        f" 95 %: dark for one value, light for all {rumour.comparisons} at once.",
        "Indefinite beliefs have an error, but no claim and no ANEES (hollow; no curve where they"
        " are more than half).",
    ]
    if panels.any_negative(rumour.series["multiplicity_mean"]):
        sentences.append("Multiplicities below 0 are not drawn.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def layout(rumour):
    """Figure and a grid of axes: for each topology the rules' panels, ANEES, multiplicity."""
    rows, rules = len(rumour.topologies), len(rumour.rules)
    figure = style.new_figure(1.38 * rules + 6.0, 2.05 * rows + 2.01)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, rules + 4, width_ratios=[1.0] * rules + [0.30, 1.7, 0.36, 1.7], wspace=0.1,
        hspace=0.13, left=0.088, right=0.992, top=1 - 0.68 / height, bottom=1.36 / height,
    )
    table = []
    for i in range(rows):
        sigma = [figure.add_subplot(grid[i, k]) for k in range(rules)]
        row = sigma + [figure.add_subplot(grid[i, rules + k]) for k in (1, 3)]
        for axes in row:
            style.time_axis(axes, rumour.t_s)
            if i < rows - 1:
                axes.tick_params(labelbottom=False)
        table.append(row)
    return figure, table


def headings(figure, table, rumour):
    height = figure.get_figheight()
    rules = len(rumour.rules)
    left, anees, counted = (table[0][k].get_position().x0 for k in (0, rules, rules + 1))
    for x, title in (
        (left, "Claimed and true standard error a coordinate [m]"),
        (anees, "ANEES"),
        (counted, "Multiplicity"),
    ):
        figure.text(x, 1 - 0.32 / height, title, fontsize=10.5, fontweight="bold", va="bottom")
    remarks = ("1: as sure as it should be", "mean count of a measurement")
    for k, remark in enumerate(remarks, start=rules):
        table[0][k].set_title(remark, loc="left", fontsize=9, color="#333333", pad=5)
    for k, rule in enumerate(rumour.rules):
        color, _ = style.rule_style(rule, rumour.rules)
        table[0][k].set_title(rule, color=color, fontweight="bold", pad=5)
    panels.label_rows(figure, table, rumour.topologies, rumour.agents)
    for row in table:
        for axes in row[1:rules]:
            axes.tick_params(labelleft=False)
    for axes in table[-1]:
        axes.set_xlabel("time [s]", labelpad=1.5)
    kinds = [
        panels.line_entry("-", style.GREY, "true error, with 95 % interval", "o"),
        panels.line_entry((0, (3.2, 1.4)), style.GREY, "claimed σ"),
        panels.line_entry((0, (1.0, 1.5)), style.BLACK, "true σ by the ledger"),
        panels.line_entry("-", style.BLACK, "σ of the central filter"),
        panels.fill_entry("claims too much: overconfident", True),
        panels.fill_entry("claims too little: gives away", False),
    ]
    panels.legend(figure, (left, 0.58 / height), kinds, 3)
    panels.legend(figure, (anees, 0.58 / height), panels.rule_entries(rumour.rules), 3)
    panels.write_caption(figure, left, caption(rumour))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser, DEFAULTS)
    rumour = Rumour(chosen)
    figure, table = layout(rumour)
    curves = {
        (topology, rule): rumour.sigma_curves(topology, rule)
        for topology in rumour.topologies
        for rule in rumour.rules
    }
    present = [c for c in curves.values() if c is not None]
    limits = panels.sigma_range([c for found in present for c in (found[0], found[2], found[3])])
    for i, topology in enumerate(rumour.topologies):
        for k, rule in enumerate(rumour.rules):
            axes = table[i][k]
            style.log_axis(axes, *limits)
            if curves[topology, rule] is None:
                panels.note(axes, "not in the study")
                continue
            color, _ = style.rule_style(rule, rumour.rules)
            sigma_panel(axes, rumour.t_s, curves[topology, rule], color)
        style.log_axis(table[i][-2], 0.08, 100.0)
        anees_panel(table[i][-2], rumour, topology)
        style.log_axis(table[i][-1], *limits_of_multiplicity(rumour))
        multiplicity_panel(table[i][-1], rumour, topology)
    headings(figure, table, rumour)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
