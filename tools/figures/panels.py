"""What the figures of the studies have in common: curves of a cell, panels of claim against truth,
sketches of the topologies, legends."""

import textwrap
from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

import stats
import style
from data import UserError, label_text, percent

# So many of the beliefs at an instant may be undefined (indefinite, or no estimate yet) before the
# curve breaks off: what is left over would not speak for the fleet.
MISSING_MAX = 0.5


@dataclass
class Curve:
    """A quantity over the instants; NaN leaves a gap. `thinned` marks instants at which some
    beliefs were undefined and left out."""

    value: np.ndarray
    thinned: np.ndarray
    low: np.ndarray = None
    high: np.ndarray = None


def _broken(value, count, asked):
    missing = 1.0 - np.divide(count, asked, out=np.zeros_like(count), where=asked > 0)
    value = np.where((count > 0) & (missing <= MISSING_MAX), value, np.nan)
    return value, (missing > 0) & np.isfinite(value)


def _ratio(total, count):
    return np.divide(total, count, out=np.full(total.shape, np.nan), where=count > 0)


def rms(series, cell, agents="agents", interval=False):
    """Root mean square over repetitions, agents and subjects, with a 95 % bootstrap interval over
    repetitions."""
    squares = series.of("squares", agents)[cell].sum(axis=-1)  # [repetition, t]
    count = series.of("count", agents)[cell].sum(axis=-1)
    asked = series.of("asked", agents)[cell].sum(axis=-1)
    value = np.sqrt(_ratio(squares.sum(axis=0), count.sum(axis=0)))
    value, thinned = _broken(value, count.sum(axis=0), asked.sum(axis=0))
    curve = Curve(value, thinned)
    if interval:
        low, high = stats.ratio_interval(squares, count)
        keep = np.isfinite(value)
        curve.low, curve.high = (np.where(keep, np.sqrt(a), np.nan) for a in (low, high))
    return curve


def mean(series, cell, agents="agents", interval=False):
    """Mean over repetitions, agents and subjects, with a 95 % bootstrap interval over repetitions."""
    totals, counts, asked = (
        series.of(a, agents)[cell].sum(axis=-1)  # [repetition, t]
        for a in ("total", "count", "asked")
    )
    total, count = totals.sum(axis=0), counts.sum(axis=0)
    curve = Curve(*_broken(_ratio(total, count), count, asked.sum(axis=0)))
    if interval:
        keep = np.isfinite(curve.value)
        curve.low, curve.high = (
            np.where(keep, a, np.nan) for a in stats.ratio_interval(totals, counts)
        )
    return curve


def anees(series, claimed, cell, dimension, agents="agents"):
    """Mean of NEES over repetitions, divided by the state's dimension: mean of the agents' values,
    with the least and the greatest agent's as `low` and `high`. A belief that is not positive
    definite has no `claimed` σ; its eᵀΩe says nothing and is left out."""
    valid = claimed.of("count", agents)[cell] == claimed.of("asked", agents)[cell]
    asked = series.of("asked", agents)[cell].sum(axis=0)  # [t, agent]
    total, count = (
        np.where(valid, series.of(a, agents)[cell], 0.0).sum(axis=0) for a in ("total", "count")
    )
    each = _ratio(total, count) / dimension
    value, thinned = _broken(
        np.nan_to_num(each, nan=0.0).sum(axis=1) / np.maximum((count > 0).sum(axis=1), 1),
        count.sum(axis=1),
        asked.sum(axis=1),
    )
    keep = np.isfinite(value)
    low = np.where(keep, np.min(np.where(count > 0, each, np.inf), axis=1), np.nan)
    high = np.where(keep, np.max(np.where(count > 0, each, -np.inf), axis=1), np.nan)
    return Curve(value, thinned, low, high)


def any_negative(series):
    """Whether the mean of some cell is below zero at some instant."""
    return any(np.nanmin(mean(series, c).value, initial=1.0) < 0.0 for c in series.cells)


def draw(axes, t_s, curve, color, dash="-", marker=None, width=1.6, zorder=3, alpha=1.0):
    """A curve; instants at which beliefs were left out have hollow markers."""
    axes.plot(t_s, curve.value, ls=dash, color=color, lw=width, zorder=zorder, alpha=alpha)
    if marker is None:
        return
    size = 4.0 if len(t_s) <= 8 else 3.0
    for mask, face in ((~curve.thinned, color), (curve.thinned, "white")):
        axes.plot(
            t_s[mask], curve.value[mask], marker, color=color, mfc=face, zorder=zorder + 0.1,
            ms=size, mew=0.9, alpha=alpha,
        )


def finite(arrays, what):
    """All finite values of some arrays. @raises UserError if there are none."""
    values = np.concatenate([np.atleast_1d(a) for a in arrays])
    values = values[np.isfinite(values)]
    if len(values) == 0:
        raise UserError(f"no {what} is defined in these runs; nothing to draw")
    return values


def chosen_labels(chosen, axis, text):
    """Labels of an axis that "A;B" names, all for an empty text.
    @raises UserError for one that is not there."""
    known = chosen.labels(axis)
    wanted = [label_text(label) for label in text.split(";") if label.strip()]
    for label in wanted:
        if label not in known:
            raise UserError(f"axis {axis} has no {label!r}; it has: {', '.join(known)}")
    return wanted or known


def label_name(axis, label):
    """A label as a reader says it: of a rule or method its name, of loss 30 % loss, else with its axis before it."""
    if axis in ("rule", "topology", "method"):
        return label
    return f"{percent(label)} loss" if axis == "loss" else f"{axis} {label}"


def names_in(text, option):
    """["a", "b"] of "a;b". @raises UserError without any."""
    names = [name.strip() for name in text.split(";") if name.strip()]
    if not names:
        raise UserError(f"{option}: no name given")
    return list(dict.fromkeys(names))


# metric of certainty grids: what it says, what it says in two short lines
METRICS = {
    "kl_to_central_nats": ("divergence from the central grid [nats]", "from the central\ngrid [nats]"),
    "entropy_nats": ("entropy [nats]", "entropy\n[nats]"),
    "disagreement_probability": ("largest difference of two vehicles", "largest difference\nof two vehicles"),
    "multiplicity_mean": ("how often the average look is counted", "how often a\nlook is counted"),
    "alarms_detected_share": ("share of targets with an alarm", "targets with\nan alarm"),
    "alarms_false": ("false alarms", "false alarms"),
    "alarm_error_m": ("error of alarms [m]", "error of\nalarms [m]"),
    "cells_detected_share": ("P_D: share of target cells found", "P_D by cell"),
    "cells_false_share": ("P_F: share of empty cells with an alarm", "P_F by cell"),
    "cells_hearsay": ("cells alarmed by hearsay alone", "cells alarmed by\nhearsay alone"),
    "alarms_found_s": ("time until all targets are found [s]", "all targets\nfound [s]"),
    "cells_seen_share": ("share of cells a vehicle looked at", "cells a vehicle\nlooked at"),
    "agents_a_cell": ("vehicles that looked at a cell", "vehicles that\nlooked at a cell"),
    "distance_flown_m": ("way of a vehicle [m]", "way of a\nvehicle [m]"),
    "bytes_sent": ("kB a vehicle sent", "kB a\nvehicle sent"),
    # of foragers
    "trips": ("trips", "trips"),
    "trips_an_hour": ("trips an hour", "trips\nan hour"),
    "trip_length_mean_m": ("length of a trip [m]", "length of\na trip [m]"),
    "trip_time_mean_s": ("time of a trip [s]", "time of\na trip [s]"),
    "first_arrival_s": ("first arrival [s]", "first\narrival [s]"),
    "recovery_s": ("first arrival after the change [s]", "arrival after\nthe change [s]"),
    "distance_driven_m": ("way driven [m]", "way\ndriven [m]"),
    "time_following_share": ("share of time on trails", "share of time\non trails"),
    "time_exploring_share": ("share of time exploring", "share of time\nexploring"),
    "crumb_error_m": ("error of crumbs [m]", "error of\ncrumbs [m]"),
    "crumbs_wrong_share": ("share of crumbs out of reach", "crumbs out\nof reach"),
}


def metric_name(metric, threshold=None, short=False):
    """A metric as a reader says it."""
    name = METRICS.get(metric, (metric, metric))[short].replace("P_D", "$P_D$").replace("P_F", "$P_F$")
    return name if threshold is None else f"{name}, over {threshold}"


def threshold_subject(chosen, metric, threshold):
    """The subject of a metric's rows: that threshold, or None for one that has no thresholds.
    @raises UserError if it was recorded for other thresholds."""
    known = [subject for subject in chosen.subjects(metric) if subject]
    if not known:
        return None
    for subject in known:
        if label_text(subject) == label_text(threshold):
            return subject
    raise UserError(f"{metric} was not recorded for threshold {threshold}, but for {', '.join(known)}")


def wants_log(values):
    """Whether values are better seen on a logarithmic axis: none is negative, and the positive ones span
    decades."""
    positive = np.sort(values[values > 0.0])
    if len(positive) == 0 or (values < 0.0).any():
        return False
    return positive[-1] > 50.0 * positive[len(positive) // 20]


def tick_ends(axes, nbins):
    """Few ticks of x, whose labels at the ends do not touch those of the neighbouring panels."""
    axes.locator_params(nbins=nbins)
    low, high = axes.get_xlim()
    ticks = [t for t in axes.get_xticks() if low <= t <= high]
    axes.set_xticks(ticks, [f"{t:g}" for t in ticks])
    for tick, align in ((0, "left"), (-1, "right")):
        if abs(ticks[tick] - (low, high)[tick]) < 0.02 * (high - low):
            axes.xaxis.get_major_ticks()[tick].label1.set_horizontalalignment(align)


def last(values):
    """The value at the last instant that has one, NaN if none has."""
    finite = values[np.isfinite(values)]
    return finite[-1] if len(finite) else np.nan


def shade_gap(axes, t_s, claimed, error, color):
    """Fills between claim and error: hatched where too much is claimed, plain where too little."""
    floor = axes.get_ylim()[0]
    low = np.maximum(claimed.value, floor * 0.5)
    style_of = dict(interpolate=True, lw=0.0, zorder=1)
    axes.fill_between(
        t_s, low, error.value, where=claimed.value < error.value, facecolor=color, alpha=0.16,
        **style_of,
    )
    axes.fill_between(
        t_s, low, error.value, where=claimed.value < error.value, facecolor="none",
        edgecolor=color, hatch="/////", alpha=0.45, **style_of,
    )
    axes.fill_between(
        t_s, low, error.value, where=claimed.value > error.value, facecolor=color, alpha=0.12,
        **style_of,
    )


def note(axes, text, where="top", color=style.BLACK):
    """A remark inside a panel."""
    y, va = {"top": (0.975, "top"), "bottom": (0.03, "bottom")}[where]
    axes.text(
        0.985, y, text, transform=axes.transAxes, ha="right", va=va, fontsize=7.2, color=color,
        zorder=6, linespacing=1.25,
        bbox=dict(boxstyle="square,pad=0.1", fc="white", ec="none", alpha=0.75),
    )


def sigma_range(curves):
    """Limits of the axis that all panels of claim and truth share. Claims far below every error run
    out of it at the bottom, errors far above the usual at the top; notes in the panels say how far.

    `curves`: all that are to be seen in full if possible."""
    values = finite([c.value for c in curves], "error")
    low = values[values > 0].min(initial=1.0)
    highs = [np.nanmax(c.value) for c in curves if np.isfinite(c.value).any()]
    high = min(max(highs), 4.0 * float(np.median(highs)))
    return 0.45 * low, max(2.2 * high, 2.0 * low)


def sketch(figure, box, topology, agents):
    """A small drawing of who talks to whom, where the topology is one that can be drawn."""
    edges = {
        "line": [(i, i + 1) for i in range(agents - 1)],
        "ring": [(i, (i + 1) % agents) for i in range(agents)],
        "full": [(i, j) for i in range(agents) for j in range(i)],
        "star": [(0, i) for i in range(1, agents)],
    }.get(topology)
    if edges is None or not 2 <= agents <= 12:
        return
    axes = figure.add_axes(box)
    axes.set_aspect("equal")
    axes.axis("off")
    angle = np.pi / 2 + 2 * np.pi * np.arange(agents) / agents
    if topology == "line":  # the open side below
        angle = -np.pi / 2 - 2 * np.pi * (np.arange(agents) + 0.5) / agents
    x, y = np.cos(angle), np.sin(angle)
    if topology == "star":
        angle = np.pi / 2 + 2 * np.pi * np.arange(agents - 1) / (agents - 1)
        x, y = np.append(0.0, np.cos(angle)), np.append(0.0, np.sin(angle))
    for i, j in edges:
        axes.plot([x[i], x[j]], [y[i], y[j]], "-", color=style.GREY, lw=1.0)
    axes.plot(x, y, "o", color=style.BLACK, ms=4.0)
    axes.set_xlim(-1.25, 1.25)
    axes.set_ylim(-1.25, 1.25)


def label_rows(figure, rows, topologies, agents):
    """Name and sketch of a topology to the left of each row of axes."""
    height, width = figure.get_figheight(), figure.get_figwidth()
    size, left = 0.52, 0.17  # inches
    for row, topology in zip(rows, topologies):
        box = row[0].get_position()
        middle = 0.5 * (box.y0 + box.y1)
        place = (left / width, middle - 0.05 / height, size / width, size / height)
        sketch(figure, place, topology, agents)
        figure.text(
            (left + size / 2) / width, middle - 0.12 / height, topology, fontsize=11,
            fontweight="bold", ha="center", va="top",
        )


def legend(figure, anchor, entries, columns):
    figure.legend(
        handles=entries, loc="lower left", bbox_to_anchor=anchor, ncol=columns, fontsize=8.5,
        handlelength=2.5, columnspacing=1.3, handletextpad=0.6, borderaxespad=0.0,
    )


CAPTION_PT = 7.5
CAPTION_LINE_IN = CAPTION_PT * 1.35 / 72.0


def _caption_lines(width_in, left, sentences):
    width = (0.985 - left) * width_in * 72.0 / (0.53 * CAPTION_PT)  # in letters
    return textwrap.wrap(" ".join(sentences), int(width))


def caption_room(width_in, left, sentences):
    """By how many inches the place of a caption must be higher than usual, to hold these sentences."""
    return max(0, len(_caption_lines(width_in, left, sentences)) - 3) * CAPTION_LINE_IN


def write_caption(figure, left, sentences, room_in=0.0):
    """What the runs were and how to read the figure, in small lines at the bottom. `room_in`: that of
    caption_room(), for which there is place below the legend."""
    figure.text(
        left, (0.46 + room_in) / figure.get_figheight(),
        "\n".join(_caption_lines(figure.get_figwidth(), left, sentences)),
        fontsize=CAPTION_PT, va="top", ha="left", color="#333333", linespacing=1.35,
    )


def line_entry(dash, color, label, marker=None, **more):
    return Line2D([], [], ls=dash, color=color, label=label, marker=marker, lw=1.6, **more)


def fill_entry(label, hatched):
    return Patch(
        facecolor="#dddddd" if hatched else "#ececec", edgecolor=style.GREY if hatched else "none",
        hatch="/////" if hatched else None, lw=0.0, label=label,
    )


def rule_entries(rules):
    """Legend entries: every rule with its colour and marker."""
    entries = []
    for rule in rules:
        color, marker = style.rule_style(rule, rules)
        entries.append(line_entry("-", color, rule, marker))
    return entries
