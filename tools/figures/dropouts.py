#!/usr/bin/python3
"""What a trouble of the radio does to every fusion rule, level by level: a row of panels a topology. In
each, one panel a rule of what the beliefs claim and what their true error is; then ANEES with its 95 %
band; then the bytes on the air; and, if the study recorded it, the time until all agree again.

    dropouts.py DATABASE OUTPUT --level AXIS [--OTHER-AXIS LABEL]… [--study S]

AXIS is the study's axis along which the trouble grows: loss, cut, up, rate, queue. Values are those at
the end of the runs. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import stats
import style

SERIES = ("rms_error_m", "claimed_sigma_m", "nees")
DASHED = (0, (3.2, 1.4))
# Axis of the study: what stands below the panels.
TITLES = {
    "loss": "share of packets lost",
    "burst": "mean burst of losses [packets]",
    "cut": "length of the cut",
    "up": "mean time up between outages",
    "rate": "bit rate of a transmitter [bit/s]",
    "queue": "policy of the full queue",
}


class Levels:
    """The numbers behind the figure: at the end of the runs, by topology, rule and level."""

    def __init__(self, chosen, level):
        self.chosen = chosen
        self.level = level
        self.levels = chosen.labels(level)
        chosen.require_axes("topology", "rule", level)
        self.topologies = chosen.labels("topology")
        self.rules = chosen.labels("rule")
        self.series = chosen.series(SERIES, at_end=True)
        self.dimension = chosen.state_dimension()
        self.agents = int((self.series["rms_error_m"].agents >= 0).sum())
        self.bytes_sent = chosen.scalar("bytes_sent")
        self.agree_s = chosen.scalar("agree_again_s").get(data.CENTRAL)
        self.comparisons = self.agents * len(chosen.cells)
        self.x = np.arange(len(self.levels), dtype=float)

    def names(self):
        """The levels as a reader says them."""
        return [data.percent(l) if self.level == "loss" else l for l in self.levels]

    def cells(self, topology, rule):
        """Number of the cell at each level, None where the study has none. Who hears nobody is the
        same at every level of a radio's trouble, and studies run it once."""
        cells = [
            self.chosen.cell(**{"topology": topology, "rule": rule, self.level: label})
            for label in self.levels
        ]
        there = [cell for cell in cells if cell is not None]
        return [there[0]] * len(cells) if rule == "none" and len(there) == 1 else cells

    def along(self, topology, rule, curve_of):
        """The curves of the cells, each of one instant, as one over the levels."""
        nothing = np.array([np.nan])
        found = [
            panels.Curve(nothing, np.array([False]), nothing, nothing)
            if cell is None else curve_of(cell)
            for cell in self.cells(topology, rule)
        ]
        parts = ([getattr(c, name) for c in found] for name in ("value", "thinned", "low", "high"))
        return panels.Curve(*(None if p[0] is None else np.concatenate(p) for p in parts))

    def error(self, topology, rule, agents="agents"):
        series = self.series["rms_error_m"]
        return self.along(topology, rule, lambda c: panels.rms(series, c, agents, interval=True))

    def claimed(self, topology, rule):
        series = self.series["claimed_sigma_m"]
        return self.along(topology, rule, lambda c: panels.rms(series, c))

    def central(self, topology):
        """Error of the central filter, from the first rule that has every level."""
        rule = max(self.rules, key=lambda r: sum(c is not None for c in self.cells(topology, r)))
        return self.error(topology, rule, "central")

    def anees(self, topology, rule):
        nees, claimed = self.series["nees"], self.series["claimed_sigma_m"]
        return self.along(
            topology, rule, lambda c: panels.anees(nees, claimed, c, self.dimension)
        )

    def kilobytes(self, topology, rule):
        """Mean over repetitions and agents, a level."""
        values = [v for agent, v in self.bytes_sent.items() if agent >= 0]
        return np.array([
            np.nan if cell is None else np.mean([np.nanmean(v[cell]) for v in values]) / 1e3
            for cell in self.cells(topology, rule)
        ])

    def agreement(self, topology, rule):
        """(median, 10 % and 90 % quantile of the repetitions, share that never agree) a level;
        infinite where they never do."""
        rows = []
        for cell in self.cells(topology, rule):
            times = np.array([np.nan]) if cell is None else self.agree_s[cell]
            times = np.sort(times[~np.isnan(times)])
            n = len(times)
            if n == 0:
                rows.append([np.nan] * 4)
                continue
            quantiles = [times[min(int(q * n), n - 1)] for q in (0.5, 0.1, 0.9)]
            rows.append([*quantiles, float(np.isinf(times).mean())])
        return np.array(rows).T


def sigma_panel(axes, levels, topology, rule, color):
    error, claimed = levels.error(topology, rule), levels.claimed(topology, rule)
    floor, ceiling = axes.get_ylim()
    panels.shade_gap(axes, levels.x, claimed, error, color)
    axes.plot(levels.x, levels.central(topology).value, "-", color=style.BLACK, lw=1.0, zorder=2)
    axes.fill_between(levels.x, error.low, error.high, color=color, alpha=0.45, lw=0.0, zorder=2.5)
    panels.draw(axes, levels.x, error, color, "-", marker="o", width=1.8)
    panels.draw(axes, levels.x, claimed, color, DASHED, width=1.8, zorder=3.5)
    remarks = []
    if not np.isfinite(claimed.value).all():
        remarks.append("no claim: more than\nhalf indefinite")
    if np.nanmin(claimed.value, initial=np.inf) < floor:
        remarks.append(f"↓ claims {style.number(np.nanmin(claimed.value))} m")
    if remarks:
        panels.note(axes, "\n".join(remarks), "bottom", color)
    if np.nanmax(error.value, initial=0.0) > ceiling:
        panels.note(axes, f"↑ errs by {style.number(np.nanmax(error.value))} m", "top", color)


def dodged(levels, k):
    """Places of rule k: beside one another, so that none hides another."""
    return levels.x + 0.09 * (k - 0.5 * (len(levels.rules) - 1))


def bars(axes, x, low, high, color):
    """From low to high, where both are there."""
    there = np.isfinite(low) & np.isfinite(high)
    axes.vlines(x[there], low[there], high[there], color=color, lw=2.2, alpha=0.35, zorder=2)


def anees_axis(axes):
    """Values up to 200; beyond there is room for triangles and what they stand for."""
    style.log_axis(axes, 0.08, 6e3)
    axes.set_yticks([0.1, 1.0, 10.0, 100.0], ["0.1", "1", "10", "100"])


def anees_panel(axes, levels, topology):
    for comparisons, shade in ((levels.comparisons, "#e6e6e6"), (1, "#c4c4c4")):
        low, high = stats.anees_band(levels.dimension, levels.chosen.repetitions, comparisons)
        axes.axhspan(low, high, color=shade, lw=0.0, zorder=0.5)
    floor, ceiling = axes.get_ylim()[0], 200.0
    beyond = []
    for k, rule in enumerate(levels.rules):
        curve = levels.anees(topology, rule)
        color, marker = style.rule_style(rule, levels.rules)
        x = dodged(levels, k)
        inside = np.where((curve.value > floor) & (curve.value < ceiling), curve.value, np.nan)
        bars(axes, x, np.minimum(curve.low, ceiling), np.minimum(curve.high, ceiling), color)
        shown = panels.Curve(inside, curve.thinned)
        panels.draw(axes, x, shown, color, "-", marker=marker, width=1.0, zorder=4 - 0.1 * k)
        above, below = curve.value >= ceiling, curve.value <= floor
        axes.plot(x[above], np.full(above.sum(), 1.7 * ceiling), marker="^", ls="", ms=4.5,
                  color=color, mfc="white", zorder=5)
        axes.plot(x[below], np.full(below.sum(), 1.4 * floor), marker="v", ls="", ms=4.5,
                  color=color, mfc="white", zorder=5)
        if above.any():
            beyond.append(f"{rule}: up to {style.number(np.nanmax(curve.value))} ↑")
        if below.any():
            beyond.append(f"{rule}: down to {style.number(np.nanmin(curve.value))} ↓")
    if beyond:
        panels.note(axes, "\n".join(beyond), "top")


def bytes_panel(axes, levels, topology):
    highest = 0.0
    for k, rule in enumerate(levels.rules):
        color, marker = style.rule_style(rule, levels.rules)
        values = levels.kilobytes(topology, rule)
        highest = max(highest, np.nanmax(values, initial=0.0))
        axes.plot(dodged(levels, k), values, marker + "-", color=color, lw=1.2, zorder=4 - 0.1 * k)
    axes.set_ylim(0.0, 1.15 * highest if highest > 0.0 else 1.0)


def agreement_panel(axes, levels, topology, ceiling):
    """Medians; who never agrees stands above the line."""
    axes.set_ylim(-0.04 * ceiling, 1.22 * ceiling)
    axes.axhline(ceiling * 1.02, color=style.GREY, lw=0.6, zorder=1)
    axes.text(-0.4, ceiling * 1.04, "never", fontsize=7.2, color=style.GREY, va="bottom")
    for k, rule in enumerate(levels.rules):
        color, marker = style.rule_style(rule, levels.rules)
        middle, low, high, _ = levels.agreement(topology, rule)
        x = dodged(levels, k)
        never = 1.12 * ceiling
        cut = [np.where(np.isinf(v), never, v) for v in (low, high, middle)]
        bars(axes, x, cut[0], cut[1], color)
        axes.plot(x, cut[2], marker, color=color, zorder=4 - 0.1 * k)


def level_axis(axes, levels, labelled):
    axes.set_xlim(-0.45, len(levels.levels) - 0.55)
    names = levels.names()
    axes.set_xticks(levels.x, names if labelled else [""] * len(names))
    if labelled and max(len(n) for n in names) > 4:
        for label in axes.get_xticklabels():
            label.set(rotation=45, ha="right", rotation_mode="anchor")


def layout(levels):
    rows, rules = len(levels.topologies), len(levels.rules)
    wide = [1.75, 1.35] + ([1.35] if levels.agree_s is not None else [])
    ratios = [1.0] * rules
    for width in wide:
        ratios += [0.36, width]
    figure = style.new_figure(1.38 * rules + 1.9 + 1.85 * sum(wide), 2.2 * rows + 2.2)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, len(ratios), width_ratios=ratios, wspace=0.1, hspace=0.14, left=0.085, right=0.993,
        top=1 - 0.68 / height, bottom=1.62 / height,
    )
    places = [*range(rules), *range(rules + 1, len(ratios), 2)]
    table = []
    for i in range(rows):
        row = [figure.add_subplot(grid[i, k]) for k in places]
        for axes in row:
            level_axis(axes, levels, i == rows - 1)
        table.append(row)
    return figure, table


def caption(levels):
    chosen = levels.chosen
    others = chosen.described("topology", "rule", levels.level)
    sentences = [
        f"{levels.agents} agents, states in {levels.dimension}-D{', ' + others if others else ''};"
        f" {chosen.repetitions} paired repetitions; values at the end of the runs.",
        "Errors are root mean squares over agents, subjects, repetitions, with the 95 % bootstrap"
        " interval over repetitions.",
        "ANEES: bars from the least to the greatest agent; grey, where a consistent one lies with"
        f" 95 %: dark for one value, light for all {levels.comparisons} at once; open triangles"
        " lie beyond.",
        "Indefinite beliefs have an error, but no claim and no ANEES (hollow; no curve where they"
        " are more than half).",
    ]
    if levels.agree_s is not None:
        sentences.append(
            "Agreement: median and middle 80 % of the repetitions, from the heal to the first second"
            " from which on no two estimates differ by more than the study's tolerance."
        )
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def headings(figure, table, levels):
    height = figure.get_figheight()
    rules = len(levels.rules)
    titles = {
        0: ("Claimed and true error a coordinate [m]", None),
        rules: ("ANEES", "1: as sure as it should be"),
        rules + 1: ("On the air", "kB an agent"),
        rules + 2: ("Agree again", "seconds after the heal"),
    }
    for k, (title, remark) in titles.items():
        if k >= len(table[0]):
            continue
        x = table[0][k].get_position().x0
        figure.text(x, 1 - 0.32 / height, title, fontsize=10.5, fontweight="bold", va="bottom")
        if remark:
            table[0][k].set_title(remark, loc="left", fontsize=9, color="#333333", pad=5)
    for k, rule in enumerate(levels.rules):
        color, _ = style.rule_style(rule, levels.rules)
        table[0][k].set_title(rule, color=color, fontweight="bold", pad=5)
    panels.label_rows(figure, table, levels.topologies, levels.agents)
    for row in table:
        for axes in row[1:rules]:
            axes.tick_params(labelleft=False)
    left = table[0][0].get_position().x0
    right = table[0][-1].get_position().x1
    figure.text(
        0.5 * (left + right), 0.98 / height, TITLES.get(levels.level, levels.level), ha="center",
        va="bottom", fontsize=9,
    )
    kinds = [
        panels.line_entry("-", style.GREY, "true error, with 95 % interval", "o"),
        panels.line_entry(DASHED, style.GREY, "claimed σ"),
        panels.line_entry("-", style.BLACK, "error of the central filter"),
        panels.fill_entry("claims too much: overconfident", True),
        panels.fill_entry("claims too little: gives away", False),
    ]
    panels.legend(figure, (left, 0.58 / height), kinds, 3)
    anees = table[0][rules].get_position().x0
    panels.legend(figure, (anees, 0.58 / height), panels.rule_entries(levels.rules), 3)
    panels.write_caption(figure, left, caption(levels))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--level", required=True, help="axis along which the trouble grows")
    arguments, chosen = data.parse(parser)
    levels = Levels(chosen, arguments.level)
    figure, table = layout(levels)
    rules = len(levels.rules)
    curves = [levels.error(t, r) for t in levels.topologies for r in levels.rules]
    limits = panels.sigma_range(curves + [levels.central(t) for t in levels.topologies])
    ceiling = None
    if levels.agree_s is not None:
        times = levels.agree_s[np.isfinite(levels.agree_s)]
        ceiling = max(10.0, 5.0 * np.ceil(times.max(initial=0.0) / 5.0))
    for row, topology in zip(table, levels.topologies):
        for axes, rule in zip(row, levels.rules):
            style.log_axis(axes, *limits)
            sigma_panel(axes, levels, topology, rule, style.rule_style(rule, levels.rules)[0])
        anees_axis(row[rules])
        anees_panel(row[rules], levels, topology)
        bytes_panel(row[rules + 1], levels, topology)
        if ceiling is not None:
            agreement_panel(row[rules + 2], levels, topology, ceiling)
    headings(figure, table, levels)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
