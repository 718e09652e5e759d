#!/usr/bin/python3
"""Which rule to take when: for every rule, on every graph and radio, what beliefs claim at the end of the
runs and what their true error is. A column a topology, a row a state of the radio.

    rules.py DATABASE OUTPUT [--study S]

The study has the axes rule and network, with labels "TOPOLOGY, RADIO". OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

OVERCONFIDENT, CAUTIOUS = style.VERMILLION, style.BLUE
BEST = "#dff0e6"
OVER = 1.0 + 1e-6  # an agent of larger ANEES claims more than is true: the ledger's is exact
HONEST = 1.1  # a claim within this factor of the truth is drawn in black


class Ends:
    """True error, its interval and claimed σ at the end of the runs of a cell."""

    def __init__(self, chosen):
        self.chosen = chosen
        chosen.require_axes("rule", "network")
        pairs = [label.partition(", ") for label in chosen.labels("network")]
        self.rules = chosen.labels("rule")
        self.topologies = list(dict.fromkeys(topology for topology, _, _ in pairs))
        self.radios = list(dict.fromkeys(radio for _, _, radio in pairs))
        self.series = chosen.series(("rms_error_m", "claimed_sigma_m"), at_end=True)
        has_ledger = chosen.has_series("ledger_anees")
        self.anees = chosen.series(("ledger_anees",), at_end=True)["ledger_anees"] if has_ledger else None

    def of(self, rule, topology, radio, agents="agents"):
        """(error, low, high, claimed); NaN where the study has no such cell or no value."""
        cell = self.chosen.cell(rule=rule, network=f"{topology}, {radio}")
        if cell is None:
            return (np.nan,) * 4
        error = panels.rms(self.series["rms_error_m"], cell, agents, interval=True)
        claimed = panels.rms(self.series["claimed_sigma_m"], cell, agents)
        return error.value[0], error.low[0], error.high[0], claimed.value[0]


    def worst_anees(self, rule, topology, radio):
        """By the ledger: the largest over agents of the mean over repetitions. Infinite if a belief
        was none, NaN where the study has no such cell."""
        cell = self.chosen.cell(rule=rule, network=f"{topology}, {radio}")
        if cell is None:
            return np.nan
        claimed = self.series["claimed_sigma_m"]
        if (claimed.of("count", "agents")[cell] < claimed.of("asked", "agents")[cell]).any():
            return np.inf
        total, count = (self.anees.of(array, "agents")[cell] for array in ("total", "count"))
        with np.errstate(invalid="ignore"):
            return float(np.nanmax(total.sum(axis=(0, 1)) / count.sum(axis=(0, 1))))

    def honest(self, rule, topology, radio):
        """Whether no agent claims more than is true."""
        return self.anees is not None and self.worst_anees(rule, topology, radio) <= OVER

    def best(self, topology, radio):
        """The rules that err least, to 1 %, of those that are honest."""
        errors = {r: self.of(r, topology, radio)[0] for r in self.rules if self.honest(r, topology, radio)}
        least = min(errors.values(), default=np.nan)
        return [rule for rule, error in errors.items() if error <= 1.01 * least]


def color_of(error, claimed):
    if not np.isfinite(claimed) or claimed < error / HONEST:
        return OVERCONFIDENT
    return CAUTIOUS if claimed > error * HONEST else style.BLACK


def dumbbell(axes, y, values, limits):
    """A line from what is claimed (a stroke) to what is true (a dot)."""
    error, low, high, claimed = values
    if not np.isfinite(error):
        return
    color = color_of(error, claimed)
    left, right = limits
    shown = float(np.clip(error, left, 0.9 * right))
    end = left * 1.03 if not np.isfinite(claimed) else float(np.clip(claimed, left * 1.03, right))
    axes.plot([shown, end], [y, y], "-", color=color, lw=2.2, alpha=0.45, zorder=2)
    if np.isfinite(claimed) and left < claimed < right:
        axes.plot([claimed], [y], "|", color=color, ms=9, mew=2.0, zorder=4)
    elif np.isfinite(claimed):
        axes.plot([end], [y], "<", color=color, ms=4.5, zorder=4, clip_on=False)
    axes.plot([low, high], [y, y], "-", color=style.BLACK, lw=0.9, zorder=3.5)
    marker = "o" if error < right else ">"
    axes.plot([shown], [y], marker, color=color, ms=5.0, zorder=5)
    remark = ""
    if not np.isfinite(claimed):
        remark = "no claim: indefinite"
    elif claimed <= left:
        remark = f"claims {style.number(claimed)}"
    if error >= right:
        remark += f"{', ' if remark else ''}errs {style.number(error)}"
    if remark:
        axes.text(
            left * 1.12, y + 0.2, remark, fontsize=6.0, color=color, va="bottom", zorder=6,
            bbox=dict(boxstyle="square,pad=0.05", fc="white", ec="none"),
        )


def draw(figure, grid, ends, limits):
    rules, topologies, radios = ends.rules, ends.topologies, ends.radios
    places = np.arange(len(rules))[::-1].astype(float)
    for i, radio in enumerate(radios):
        for k, topology in enumerate(topologies):
            axes = figure.add_subplot(grid[i, k])
            axes.set_xscale("log")
            axes.set_xlim(*limits)
            axes.set_ylim(-0.7, len(rules) - 0.3)
            axes.set_yticks(places, rules if k == 0 else [""] * len(rules))
            axes.grid(axis="y", alpha=0.5)
            axes.tick_params(axis="y", length=0)
            ticks = [t for t in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0) if limits[0] <= t <= limits[1]]
            axes.set_xticks(ticks, [f"{t:g}" for t in ticks] if i == len(radios) - 1 else [""] * len(ticks))
            axes.minorticks_off()
            central = [ends.of(r, topology, radio, "central")[0] for r in rules]
            axes.axvline(np.nanmean(central), color=style.BLACK, lw=0.9, ls=(0, (4, 2)), zorder=1)
            best = ends.best(topology, radio)
            for y, rule in zip(places, rules):
                if rule in best:
                    axes.axhspan(y - 0.45, y + 0.45, color=BEST, lw=0.0, zorder=0)
                dumbbell(axes, y, ends.of(rule, topology, radio), limits)
            if i == 0:
                axes.set_title(topology, fontweight="bold")
            if k == 0:
                axes.set_ylabel(f"radio: {radio}", fontweight="bold", fontsize=10)


def caption(ends):
    chosen = ends.chosen
    sentences = [
        f"Values at the end of the runs; {chosen.repetitions} paired repetitions. Root mean squares over"
        " agents and repetitions, thin lines: 95 % bootstrap interval of the true error.",
        f"Black: claim and truth within a factor {HONEST:g}. Axis in m a coordinate; what lies beyond it"
        " is written in the row.",
    ]
    if ends.anees is not None:
        sentences.append(
            "Shaded: errs least, to 1 %, of the rules under which no agent claims more than is true, by the"
            " ledger."
        )
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    ends = Ends(chosen)
    rows, columns = len(ends.radios), len(ends.topologies)
    figure = style.new_figure(2.75 * columns + 1.6, 0.205 * len(ends.rules) * rows + 2.3)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, columns, wspace=0.06, hspace=0.1, left=1.75 / figure.get_figwidth(), right=0.99,
        top=1 - 0.4 / height, bottom=1.35 / height,
    )
    errors = [
        ends.of(r, t, radio, agents)[0]
        for r in ends.rules for t in ends.topologies for radio in ends.radios
        for agents in ("agents", "central")
    ]
    finite = panels.finite([np.array(errors)], "error")
    limits = (0.5 * finite[finite > 0].min(), 1.3)
    draw(figure, grid, ends, limits)
    left = grid[0, 0].get_position(figure).x0
    kinds = [
        panels.line_entry("", style.BLACK, "true error", "o"),
        panels.line_entry("", style.BLACK, "claimed σ", "|"),
        panels.line_entry((0, (4, 2)), style.BLACK, "error of the central filter"),
        panels.line_entry("-", OVERCONFIDENT, "claims too much: overconfident"),
        panels.line_entry("-", CAUTIOUS, "claims too little: gives away"),
    ]
    panels.legend(figure, (left, 0.62 / height), kinds, 5)
    panels.write_caption(figure, left, caption(ends))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
