#!/usr/bin/python3
"""Rumour on real logs: a row of panels a topology. In each, one panel a fusion rule of what the
beliefs claim and what their error is, for each rate of loss; then how often the average measurement
is counted.

    mrclam.py DATABASE OUTPUT [--study S]

OUTPUT ends with .png, .svg or .pdf. Axes other than topology, rule and loss: --AXIS LABEL.

There is no band of consistency: the logs' errors are correlated in time.
"""

import argparse

import numpy as np

import data
import panels
import style

SERIES = ("rms_error_m", "claimed_sigma_m", "multiplicity_mean")
DASHED = (0, (3.2, 1.4))
# The first rate of loss is drawn strong, others weaker: width, marker, opacity.
LOOKS = ((1.8, "o", 1.0), (1.0, "v", 0.75), (0.8, "^", 0.55))


class Logs:
    """The numbers behind the figure."""

    def __init__(self, chosen):
        chosen.require_axes("topology", "rule", "loss")
        self.chosen = chosen
        self.topologies = self.chosen.labels("topology")
        self.rules = self.chosen.labels("rule")
        self.losses = self.chosen.labels("loss")
        if len(self.losses) > len(LOOKS):
            raise data.UserError(
                f"{len(self.losses)} rates of loss; the figure has room for {len(LOOKS)}:"
                " choose one with --loss"
            )
        self.series = self.chosen.series(SERIES)
        self.distance = self.chosen.scalar("distance_error_m")
        error = self.series["rms_error_m"]
        self.t_s = error.t_s
        self.robots = int((error.agents >= 0).sum())
        self.subjects = int(error.asked.max())

    def cells(self, topology, rule):
        """(loss, how it looks, cell) of each rate of loss that the study has there."""
        for loss, look in zip(self.losses, LOOKS):
            cell = self.chosen.cell(topology=topology, rule=rule, loss=loss)
            if cell is not None:
                yield loss, look, cell

    def distance_m(self, cell):
        """Mean distance of estimate and landmark at the end; NaN if no belief has one."""
        values = np.array([v[cell] for agent, v in self.distance.items() if agent >= 0])
        return np.nanmean(values) if np.isfinite(values).any() else np.nan

    def undefined(self, cell):
        """Share of beliefs that are undefined at the end."""
        claimed = self.series["claimed_sigma_m"]
        return 1.0 - (
            claimed.of("count", "agents")[cell][:, -1].sum()
            / claimed.of("asked", "agents")[cell][:, -1].sum()
        )


def sigma_panel(axes, logs, topology, rule):
    color, _ = style.rule_style(rule, logs.rules)
    floor = axes.get_ylim()[0]
    above, below, claims = [], [], []
    central_drawn = False
    for loss, (width, marker, alpha), cell in logs.cells(topology, rule):
        error = panels.rms(logs.series["rms_error_m"], cell, interval=True)
        claimed = panels.rms(logs.series["claimed_sigma_m"], cell)
        if not central_drawn:
            central = panels.rms(logs.series["rms_error_m"], cell, "central")
            panels.draw(axes, logs.t_s, central, style.BLACK, width=1.0, zorder=2)
            central_drawn = True
        axes.fill_between(
            logs.t_s, error.low, error.high, color=color, alpha=0.3 * alpha, lw=0.0, zorder=2.5
        )
        panels.draw(axes, logs.t_s, error, color, "-", marker, width, 3, alpha)
        panels.draw(axes, logs.t_s, claimed, color, DASHED, None, width, 3.5, alpha)
        above.append(style.plain_number(logs.distance_m(cell)))
        if logs.undefined(cell) > 0:
            below.append(
                f"{100.0 * logs.undefined(cell):.0f} % indefinite\nat {data.percent(loss)} loss"
            )
        elif panels.last(claimed.value) < floor:
            claims.append(panels.last(claimed.value))
    if above:
        panels.note(axes, " · ".join(above) + " m")
    if claims:
        below.append(f"↓ claims {style.number(min(claims))} m")
    if below:
        panels.note(axes, "\n".join(below), "bottom", color if claims else style.BLACK)


def multiplicity_panel(axes, logs, topology):
    axes.axhline(1.0, color=style.BLACK, lw=0.8, zorder=1)
    for k, rule in enumerate(logs.rules):
        color, marker = style.rule_style(rule, logs.rules)
        for _, (width, _, alpha), cell in logs.cells(topology, rule):
            curve = multiplicity(logs, cell)
            panels.draw(axes, logs.t_s, curve, color, "-", marker, width, 4 - 0.1 * k, alpha)


def multiplicity(logs, cell):
    curve = panels.mean(logs.series["multiplicity_mean"], cell)
    curve.value = np.where(curve.value > 0, curve.value, np.nan)
    return curve


def limits(logs):
    """Of the axes of error and of multiplicity."""
    error, claimed = logs.series["rms_error_m"], logs.series["claimed_sigma_m"]
    cells = range(len(logs.chosen.cells))
    errors = [panels.rms(error, c) for c in cells] + [panels.rms(error, 0, "central")]
    low, high = panels.sigma_range(errors)
    claims = panels.finite([panels.rms(claimed, c).value for c in cells], "claim")
    near = claims[claims > 0.05 * low]  # room for those not absurd
    counts = panels.finite([multiplicity(logs, c).value for c in cells], "multiplicity")
    return (
        (min([low, *(0.6 * near)]), high),
        (min(0.5, 0.6 * counts.min()), max(3.0, 3.0 * counts.max())),
    )


def layout(logs):
    rows, rules = len(logs.topologies), len(logs.rules)
    figure = style.new_figure(1.5 * rules + 3.9, 2.05 * rows + 2.11)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, rules + 2, width_ratios=[1.0] * rules + [0.30, 1.7], wspace=0.1, hspace=0.13,
        left=0.1, right=0.99, top=1 - 0.68 / height, bottom=1.46 / height,
    )
    table = []
    for i in range(rows):
        row = [figure.add_subplot(grid[i, k]) for k in (*range(rules), rules + 1)]
        for k, axes in enumerate(row):
            style.time_axis(axes, logs.t_s)
            axes.tick_params(labelbottom=i == rows - 1, labelleft=k in (0, rules))
        table.append(row)
    return figure, table


def caption(logs):
    chosen = logs.chosen
    sentences = [
        f"{logs.robots} robots, {logs.subjects} landmarks, logs of the UTIAS MRCLAM data sets over"
        f" a simulated radio; {chosen.repetitions} repetitions of its losses.",
        "Root mean squares over robots × landmarks, with the error's 95 % interval over"
        " repetitions.",
        "No band of consistency: the logs' errors are correlated in time, so that even a robot"
        " alone claims too much.",
        "Hollow: some beliefs have no estimate and are left out; no curve where they are more than"
        " half. Indefinite beliefs have an error, but no claim.",
    ]
    if panels.any_negative(logs.series["multiplicity_mean"]):
        sentences.append("Multiplicities below 0 are not drawn.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def headings(figure, table, logs):
    height = figure.get_figheight()
    rules = len(logs.rules)
    left, counted = (table[0][k].get_position().x0 for k in (0, rules))
    for x, title in (
        (left, "Claimed and true error a coordinate [m]"),
        (counted, "Multiplicity"),
    ):
        figure.text(x, 1 - 0.32 / height, title, fontsize=10.5, fontweight="bold", va="bottom")
    table[0][rules].set_title(
        "mean count of a measurement", loc="left", fontsize=9, color="#333333", pad=5
    )
    for k, rule in enumerate(logs.rules):
        color, _ = style.rule_style(rule, logs.rules)
        table[0][k].set_title(rule, color=color, fontweight="bold", pad=5)
    panels.label_rows(figure, table, logs.topologies, logs.robots)
    for axes in table[-1]:
        axes.set_xlabel("time [s]", labelpad=1.5)
    kinds = []
    for loss, (width, marker, alpha) in zip(logs.losses, LOOKS):
        entry = panels.line_entry(
            "-", style.GREY, f"true error, {data.percent(loss)} loss", marker, alpha=alpha
        )
        entry.set_linewidth(width)
        kinds.append(entry)
        entry = panels.line_entry(
            DASHED, style.GREY, f"claimed σ, {data.percent(loss)} loss", alpha=alpha
        )
        entry.set_linewidth(width)
        kinds.append(entry)
    kinds.append(panels.line_entry("-", style.BLACK, "true error of the central filter"))
    distances = " · ".join(data.percent(loss) for loss in logs.losses)
    kinds.append(
        panels.line_entry("", style.BLACK, f"numbers: mean distance at the end, {distances} loss")
    )
    panels.legend(figure, (left, 0.58 / height), kinds, 3)
    # three rows: the panel above is narrow
    of_rules = panels.rule_entries(logs.rules)
    panels.legend(figure, (counted - 0.012, 0.52 / height), of_rules, -(-len(of_rules) // 3))
    panels.write_caption(figure, left, caption(logs))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    logs = Logs(chosen)
    figure, table = layout(logs)
    of_error, of_count = limits(logs)
    for row, topology in zip(table, logs.topologies):
        for axes, rule in zip(row, logs.rules):
            style.log_axis(axes, *of_error)
            sigma_panel(axes, logs, topology, rule)
        style.log_axis(row[-1], *of_count)
        multiplicity_panel(row[-1], logs, topology)
    for row in table:
        for axes in row[1:-1]:
            axes.tick_params(labelleft=False)
    headings(figure, table, logs)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
