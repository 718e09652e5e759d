"""How hearsay's figures look: colours, lines, axes, and how they are written.

Colours are those of Okabe and Ito, which colour-blind readers can tell apart; every rule also has
a marker of its own and every quantity a dash, so that a grey print can be read, too.
"""

import os

import matplotlib
import numpy as np
from matplotlib import ticker
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from data import UserError, write_whole

BLACK, GREY = "#000000", "#707070"
ORANGE, SKY, GREEN, BLUE = "#E69F00", "#56B4E9", "#009E73", "#0072B2"
VERMILLION, PURPLE = "#D55E00", "#CC79A7"

# rule: colour, marker
_RULES = {
    "none": (GREY, "x"),
    "naive": (VERMILLION, "v"),
    "channel": (ORANGE, "^"),
    "channel-robust": (GREEN, "s"),
    "ci-det": (BLUE, "o"),
    "ci-trace": (SKY, "D"),
    "most-certain": (PURPLE, "P"),
    # of certainty grids
    "maximum": (BLUE, "o"),
    "strongest": (SKY, "D"),
    "dictatorship": (PURPLE, "P"),
    "geometric-mean": (PURPLE, "h"),
    "linear-pool": (SKY, "p"),
    "elementwise-maximum": (BLUE, "H"),
    "averaged-parameters": (SKY, "d"),
}
# Who shares a colour with a rule of the same figure is dashed.
_DASHED = ("geometric-mean", "linear-pool", "elementwise-maximum", "averaged-parameters")
# of what has no look of its own
_LABELS = ((BLUE, "o"), (ORANGE, "s"), (GREEN, "^"), (PURPLE, "D"), (SKY, "v"), (VERMILLION, "P"), (GREY, "h"),
           (BLACK, "X"))
# of vehicles, beside one another on a map
AGENTS = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, GREY, BLACK)
_OTHERS = ((PURPLE, "X"), (BLACK, "*"), (GREEN, "<"), (ORANGE, "h"), (SKY, ">"), (BLUE, "p"), (GREY, "H"),
           (VERMILLION, "d"))

RC = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "lines.linewidth": 1.6,
    "lines.markersize": 4.0,
    "hatch.linewidth": 0.5,
    "legend.frameon": False,
    "svg.hashsalt": "hearsay",
    "svg.fonttype": "none",
    "figure.dpi": 100,
    "savefig.dpi": 150,
}


def apply():
    """From now on artists look so, whatever the user's own matplotlibrc says."""
    matplotlib.rcdefaults()
    matplotlib.rcParams.update(RC)


apply()  # legend entries may be made before their figure


def new_figure(width_in, height_in):
    """A figure in this style. It needs no display."""
    apply()
    figure = Figure(figsize=(width_in, height_in))
    FigureCanvasAgg(figure)
    return figure


def rule_style(rule, rules):
    """Colour and marker of a fusion rule; `rules` are all rules of the figure."""
    if rule in _RULES:
        return _RULES[rule]
    others = [r for r in rules if r not in _RULES]
    taken = {_RULES[r][0] for r in rules if r in _RULES}
    free = sorted(_OTHERS, key=lambda look: look[0] in taken)  # colours that nobody has yet come first
    return free[others.index(rule) % len(free)]


def label_style(label, labels):
    """Colour and marker of a label of any axis, by its place among `labels`; rules look as they always do. (Not only
    rules have a label "none".)"""
    if any(one in _RULES and one != "none" for one in labels):
        return rule_style(label, labels)
    return _LABELS[labels.index(label) % len(_LABELS)]


def rule_dash(rule):
    return (0, (4.0, 1.4)) if rule in _DASHED else "-"


def agent_colors(agents):
    """{number: colour} of some agents."""
    return {agent: AGENTS[i % len(AGENTS)] for i, agent in enumerate(agents)}


def number(value, digits=2):
    """A number for a reader: 0.22, 31, 1.6e-11 as 1.6×10⁻¹¹."""
    if not np.isfinite(value):
        return "–"
    if value == 0.0 or 1e-3 <= abs(value) < 1e4:
        text = f"{value:.{digits}g}"
        return text if "e" not in text else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    superscripts = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return f"{mantissa}×10{str(int(exponent)).translate(superscripts)}"


def plain_number(value, digits=3):
    """A number for a table: 0.220, 31.4, 1.60e-11, – where undefined."""
    if not np.isfinite(value):
        return "–"
    if value != 0.0 and not 1e-3 <= abs(value) < 1e4:
        return f"{value:.{digits - 1}e}"
    decimals = digits if abs(value) < 1.0 else max(digits - len(f"{abs(value):.0f}"), 0)
    return f"{value:.{decimals}f}"


def ratio(value):
    """A ratio for a reader: 0.62, 2.40, 31, 7.8×10⁶."""
    return f"{value:.2f}" if 0.1 <= value < 10.0 else number(value)


def log_axis(axes, low, high):
    """A logarithmic y axis from `low` to `high` with ticks that can be read over few and over many
    decades."""
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    decades = np.log10(high / low)
    if decades <= 4.2:
        subs = (1.0, 2.0, 5.0) if decades <= 1.6 else (1.0, 3.0) if decades <= 2.7 else (1.0,)
        axes.yaxis.set_major_locator(ticker.LogLocator(base=10.0, subs=subs, numticks=20))
        axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    else:
        step = next((s for s in (1, 2, 3, 5, 6, 10, 20, 30, 50) if decades / s <= 6.5), 100)
        first = int(np.ceil(np.log10(low) / step - 1e-9)) * step
        exponents = np.arange(first, np.floor(np.log10(high) + 1e-9) + 1, step)
        axes.yaxis.set_major_locator(ticker.FixedLocator(10.0**exponents))
        axes.yaxis.set_major_formatter(ticker.LogFormatterMathtext())
    axes.yaxis.set_minor_locator(ticker.NullLocator())


def time_axis(axes, t_s):
    """An x axis over the instants of the samples."""
    end = float(t_s[-1])
    axes.set_xlim(-0.03 * end, end * 1.05)
    steps = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 3600)
    step = next((s for s in steps if end / s <= 3.1), end / 3.0)
    ticks = np.arange(0.0, end * 1.02, step)
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    axes.get_xticklabels()[0].set_horizontalalignment("left")  # neighbours must not touch
    if ticks[-1] > 0.9 * end:
        axes.get_xticklabels()[-1].set_horizontalalignment("right")


def write(figure, output):
    """Writes the figure, whole or not at all, without dates: equal data give equal bytes. The
    ending chooses the format: .png, .svg or .pdf."""
    kind = os.path.splitext(output)[1].lstrip(".").lower()
    metadata = {
        "png": {"Software": None},
        "svg": {"Date": None, "Creator": None},
        "pdf": {"CreationDate": None, "ModDate": None, "Producer": None, "Creator": None},
    }.get(kind)
    if metadata is None:
        raise UserError(f"{output}: a figure ends with .png, .svg or .pdf")
    write_whole(output, lambda partial: figure.savefig(partial, format=kind, metadata=metadata))
