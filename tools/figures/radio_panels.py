"""What the figures of scenarios/radio have in common: measured points with their intervals, theory
as lines, legends and captions; and the numbers of the scenario files that the theory needs."""

import numpy as np
from matplotlib.lines import Line2D

import panels
import stats
import style

# scenarios/radio/shared.toml: a frame is a packet of 1023 bytes with 50 of header at 1 Mbit/s.
RATE_BPS = 1e6
PAYLOAD_S = 8184 / RATE_BPS
FRAME_S = 8584 / RATE_BPS
SLOT_S = 50e-6
# Interframe space, frame, space before the acknowledgement, acknowledgement. A frame that collides
# costs the same: all wait for the acknowledgement that does not come.
EXCHANGE_S = 128e-6 + FRAME_S + 28e-6 + 240e-6

COLORS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE)
MARKERS = ("o", "s", "^", "D", "v")


def points(axes, x, values, color, marker, label=None):
    """Means over repetitions with 95 % t intervals; `values` has a row for each x."""
    means, halves = np.array([stats.mean_interval(row) for row in values]).T
    axes.errorbar(
        x, means, yerr=np.nan_to_num(halves), fmt=marker, color=color, ms=4.0, mew=0.8,
        elinewidth=1.0, capsize=2.0, label=label, zorder=3,
    )
    return means


def theory(axes, x, y, color, dash="-", width=1.1):
    axes.plot(x, y, ls=dash, color=color, lw=width, zorder=2)


def theory_entry(label, color=style.GREY, dash="-"):
    return Line2D([], [], ls=dash, color=color, lw=1.1, label=label)



def legend(axes, *more, loc="best", fontsize=8):
    """The labelled points, then `more` entries, on white."""
    axes.legend(
        handles=[*axes.get_legend_handles_labels()[0], *more], fontsize=fontsize, loc=loc,
        frameon=True, facecolor="white", edgecolor="none", framealpha=0.85,
    )


def new_figure(count, width_in=4.6, height_in=3.9):
    """(figure, its `count` panels side by side), with room for a caption of two lines."""
    figure = style.new_figure(width_in * count, height_in)
    grid = figure.add_gridspec(
        1, count, left=0.62 / (width_in * count), right=1 - 0.12 / (width_in * count),
        top=1 - 0.32 / height_in, bottom=1.02 / height_in, wspace=0.24,
    )
    return figure, [figure.add_subplot(grid[0, i]) for i in range(count)]


def caption(figure, chosen, *sentences):
    repetitions = (
        f"{chosen.repetitions}\u00a0repetitions, 95\u00a0% intervals (most smaller than a point)."
    )
    failed = [f"{chosen.failed} failed runs left out."] if chosen.failed else []
    left = 0.2 / figure.get_figwidth()
    panels.write_caption(figure, left, [*sentences, repetitions, *failed])


def numbers(labels):
    """Axis labels as numbers, and their order."""
    values = np.array([float(label) for label in labels])
    return values, np.argsort(values)
