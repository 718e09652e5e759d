#!/usr/bin/python3
"""What a camera claims of an object's place against the angle of its view: by linearisation, by the
unscented transform, by Monte Carlo.

    geolocation.py DATABASE OUTPUT [--study S]

For the study scenarios/merino/ch3-geolocation. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np
from matplotlib.ticker import FuncFormatter

import data
import radio_panels
import style

REFERENCE = "monte-carlo"
# propagation: (name for a reader, colour, marker)
WAYS = {
    "linearised": ("linearised", style.VERMILLION, "s"),
    "unscented-wide": ("unscented, κ = 0", style.SKY, "D"),
    "unscented": ("unscented, κ = −5", style.BLUE, "o"),
    REFERENCE: ("Monte Carlo", style.BLACK, "x"),
}
# What is claimed differs by less than a line's width: ways are drawn side by side, degrees.
SHIFT = {"linearised": -0.6, "unscented-wide": 0.6, "unscented": 0.0, REFERENCE: 0.0}


class Scalars:
    """[angle, repetition] of what the camera recorded, by propagation."""

    def __init__(self, chosen, angles):
        self._chosen, self._angles = chosen, angles
        self._agent = chosen.agent("camera")

    def of(self, name, way):
        values = self._chosen.scalar_of(name, self._agent)
        return np.array([values[self._chosen.cell(angle_deg=a, propagation=way)] for a in self._angles])


def spread_panel(axes, scalars, x, ways):
    """Fig. 3.8: the claimed spread itself, along the line of sight and across it."""
    for name, dash, label in (
        ("look_sigma_along_m", "-", "along the view"),
        ("look_sigma_across_m", "--", "across it"),
    ):
        for way in ways:
            _, color, _ = WAYS[way]
            median = np.nanmedian(scalars.of(name, way), axis=1)
            if way == REFERENCE:
                axes.plot(x, median, "x", color=color, ms=5.0, zorder=4)
            else:
                axes.plot(x, median, dash, color=color, lw=1.1)
        axes.annotate(
            label, (x[-2], median[-2]), (-9, 2) if dash == "-" else (-2, -22), fontsize=8,
            ha="right" if dash == "-" else "center", textcoords="offset points",
        )
    style.log_axis(axes, 0.7, 50.0)
    axes.set_title("Claimed σ on the ground [m]", loc="left", fontweight="bold")


def ratio_panel(axes, scalars, x, ways):
    """Fig. 3.8 again, as a ratio: each repetition against Monte Carlo from the same pose."""
    reference = scalars.of("look_sigma_along_m", REFERENCE)
    axes.axhline(0.0, color=style.BLACK, lw=0.9, zorder=1)
    for way in ways:
        if way == REFERENCE:
            continue
        name, color, marker = WAYS[way]
        ratio = 100.0 * ((scalars.of("look_sigma_along_m", way) / reference) ** 2 - 1.0)
        means = radio_panels.points(axes, x + SHIFT[way], ratio, color, marker, name)
        axes.plot(x + SHIFT[way], means, "-", color=color, lw=0.8, zorder=2)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:+.0f} %".replace("-", "−") if v else "0"))
    axes.set_title("Variance along the view against Monte Carlo", loc="left", fontweight="bold")
    radio_panels.legend(axes, loc="upper left")


def divergence_panel(axes, scalars, x, ways):
    """Fig. 3.9. Divergences spread over decades: means of their logarithms."""
    for way in ways:
        name, color, marker = WAYS[way]
        logs = np.log10(scalars.of("look_kl_nats", way))
        centre, half = np.array([radio_panels.stats.mean_interval(row) for row in logs]).T
        value = 10.0**centre
        errors = [value - 10.0 ** (centre - half), 10.0 ** (centre + half) - value]
        label = f"{name}, drawn anew" if way == REFERENCE else name
        axes.errorbar(
            x, value, yerr=np.nan_to_num(errors), fmt=marker, color=color, ms=4.0, mew=0.8,
            elinewidth=1.0, capsize=2.0, label=label, zorder=3,
        )
        axes.plot(x, value, "-", color=color, lw=0.8, zorder=2)
    style.log_axis(axes, 1e-4, 3e-2)
    axes.set_title("Divergence from Monte Carlo [nats]", loc="left", fontweight="bold")
    radio_panels.legend(axes, loc="upper left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("angle_deg", "propagation")
    angles = chosen.labels("angle_deg")
    x, order = radio_panels.numbers(angles)
    angles, x = [angles[i] for i in order], x[order]
    found = chosen.labels("propagation")
    ways = [way for way in WAYS if way in found]
    if REFERENCE not in ways:
        raise data.UserError(f"{arguments.database}: no runs with propagation {REFERENCE!r}")
    scalars = Scalars(chosen, angles)
    figure, axes = radio_panels.new_figure(3, width_in=4.1)
    spread_panel(axes[0], scalars, x, ways)
    ratio_panel(axes[1], scalars, x, ways)
    divergence_panel(axes[2], scalars, x, ways)
    for panel in axes:
        panel.set_xlabel("angle of view from straight down [°]")
        panel.set_xlim(-3.0, 1.04 * x.max())
        panel.set_xticks(np.arange(0.0, x.max() + 1.0, 20.0))
    radio_panels.caption(
        figure, chosen,
        "A camera 40 m over a plane; σ of its pose 0.5 m and 0.02 rad an axis, of pixels 1. Left:"
        " medians; crosses by Monte Carlo, lines by the other ways, which nearly coincide. Middle,"
        " right: each look against 8000 draws from the same believed pose; black on the right: another"
        " 8000.",
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
