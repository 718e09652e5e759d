#!/usr/bin/python3
"""Vehicles that follow an object by what they tell each other: where each believes it is in one run, then true
error and claimed σ of each over time, a row a rule.

    track.py DATABASE OUTPUT [--rules A;B;…] [--repetition 1] [--seen A:0-36,B:42-86] [--no-map]
             [--study S]

`seen` says when an agent sees the object; maps are of one object. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is
chosen by an option of its name.
"""

import argparse

import numpy as np

import data
import panels
import style

SERIES = ("rms_error_m", "claimed_sigma_m", "x_m", "y_m", "x_error_m", "y_error_m")
DASHED = (0, (3.2, 1.4))


class Agent:
    """A series of one agent alone."""

    def __init__(self, series, agent):
        self._series = series
        self._chosen = series.agents == agent

    def of(self, array, agents):
        if agents == "central":
            return self._series.of(array, agents)
        return getattr(self._series, array)[..., self._chosen]


def seen_spans(text):
    """"A:0-36,B:42-86" as {"A": [(0, 36)], "B": [(42, 86)]}."""
    spans = {}
    try:
        for part in filter(None, text.split(",")):
            name, span = part.split(":")
            start, end = map(float, span.split("-"))
            spans.setdefault(name, []).append((start, end))
    except ValueError:
        raise data.UserError(f"--seen {text}: expected agents and spans in seconds such as A:0-36,B:42-86")
    return spans


def one_run(series, cell, repetition, agent):
    """Values of one agent and the first subject in one repetition."""
    of_agent = series.agents == agent
    total, count = (a[cell, repetition][..., of_agent][..., 0] for a in (series.total, series.count))
    return np.where(count > 0, total, np.nan)


def error_limits(series, cells, agents):
    """Of all error axes; a claim far below every error leaves the panel."""
    who = [Agent(series["rms_error_m"], a) for a in agents]
    errors = panels.finite([panels.rms(w, cell).value for w in who for cell in cells], "error")
    central = panels.finite(
        [panels.rms(series[name], cells[0], "central").value for name in ("rms_error_m", "claimed_sigma_m")],
        "central filter")
    low = min(np.nanmin(errors[errors > 0]), np.nanmin(central[central > 0]))
    return 0.5 * low, 1.4 * np.nanmax(errors)


def map_panel(axes, series, cell, repetition, agents, colors):
    x, y = (one_run(series[name], cell, repetition, data.CENTRAL) for name in ("x_m", "y_m"))
    ex, ey = (one_run(series[name], cell, repetition, data.CENTRAL) for name in ("x_error_m", "y_error_m"))
    axes.plot(x - ex, y - ey, color=style.BLACK, lw=2.6, alpha=0.35, solid_capstyle="round", zorder=2)
    for agent in agents:
        path = [one_run(series[name], cell, repetition, agent) for name in ("x_m", "y_m")]
        axes.plot(*path, color=colors[agent], lw=1.1, marker=".", ms=2.2, zorder=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_ylabel("y [m]", labelpad=1)


def time_panel(axes, series, cell, agent, color, spans):
    t_s = series["rms_error_m"].t_s
    own = {name: Agent(series[name], agent) for name in ("rms_error_m", "claimed_sigma_m")}
    error = panels.rms(own["rms_error_m"], cell, interval=True)
    claimed = panels.rms(own["claimed_sigma_m"], cell)
    for start, end in spans:
        axes.axvspan(start, end, color="#efe6cf", lw=0.0, zorder=0.4)
    panels.shade_gap(axes, t_s, claimed, error, color)
    for name, dash in (("rms_error_m", "-"), ("claimed_sigma_m", DASHED)):
        central = panels.rms(series[name], cell, "central")
        panels.draw(axes, t_s, central, style.BLACK, dash, width=0.9, zorder=2)
    axes.fill_between(t_s, error.low, error.high, color=color, alpha=0.45, lw=0.0, zorder=2.5)
    panels.draw(axes, t_s, error, color, "-", width=1.6)
    panels.draw(axes, t_s, claimed, color, DASHED, width=1.8, zorder=3.5)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--rules", default="", help="labels of the axis rule, with ; between them")
    parser.add_argument("--repetition", type=int, default=1, help="the run on the maps, from 1")
    parser.add_argument("--seen", default="", help="when an agent sees the object")
    parser.add_argument("--no-map", action="store_true", help="no maps, as of several objects")
    arguments, chosen = data.parse(parser)
    chosen.require_axes("rule")
    spans = seen_spans(arguments.seen)
    rules = [r for r in arguments.rules.split(";") if r] or chosen.labels("rule")
    series = chosen.series(SERIES)
    agents = [int(a) for a in series["rms_error_m"].agents if a >= 0]
    names = chosen.agent_names()
    colors = dict(zip(agents, (style.BLUE, style.ORANGE, style.GREEN, style.PURPLE, style.SKY)))
    maps = 0 if arguments.no_map else 1
    rows, columns = len(rules), maps + len(agents)
    figure = style.new_figure(3.0 * columns + 0.6, 2.2 * rows + 1.5)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        rows, columns, wspace=0.2, hspace=0.22, left=0.07, right=0.99, top=1 - 0.62 / height,
        bottom=1.32 / height, width_ratios=[1.35] * maps + [1.0] * len(agents),
    )
    cells = [chosen.cell(rule=rule) for rule in rules]
    for rule, cell in zip(rules, cells):
        if cell is None:
            raise data.UserError(f"--rules: no cell with rule {rule!r}; there are: "
                                 + "; ".join(chosen.labels("rule")))
    limits = error_limits(series, cells, agents)
    for i, (rule, cell) in enumerate(zip(rules, cells)):
        if maps:
            axes = figure.add_subplot(grid[i, 0])
            map_panel(axes, series, cell, arguments.repetition - 1, agents, colors)
            axes.set_title(rule, loc="left", pad=4, fontsize=9.5, fontweight="bold")
            axes.set_xlabel("x [m]" if i == rows - 1 else "", labelpad=1.5)
        for k, agent in enumerate(agents):
            axes = figure.add_subplot(grid[i, maps + k])
            style.time_axis(axes, series["rms_error_m"].t_s)
            style.log_axis(axes, *limits)
            time_panel(axes, series, cell, agent, colors[agent], spans.get(names[agent], []))
            axes.tick_params(labelleft=k == 0, labelbottom=i == rows - 1)
            heading = names[agent] if maps else f"{names[agent]}, {rule}"
            if i == 0 or not maps:
                axes.set_title(heading, color=colors[agent], fontweight="bold", loc="left", pad=4)
            if i == rows - 1:
                axes.set_xlabel("time [s]", labelpad=1.5)
    decorate(figure, chosen, arguments, bool(spans))
    style.write(figure, arguments.output)


def decorate(figure, chosen, arguments, spans):
    height = figure.get_figheight()
    figure.text(0.07, 1 - 0.3 / height,
                ("" if arguments.no_map else f"Repetition {arguments.repetition} on the map. ")
                + "Error and claimed σ a coordinate of each vehicle [m]",
                fontsize=10.5, fontweight="bold", va="bottom")
    entries = [
        panels.line_entry("-", style.GREY, "true error, with 95 % interval"),
        panels.line_entry(DASHED, style.GREY, "claimed σ"),
        panels.line_entry("-", style.BLACK, "black: of the central filter" + ("" if arguments.no_map else "; on maps, wide: the truth")),
        panels.fill_entry("claims too much: overconfident", True),
        panels.fill_entry("claims too little: gives away", False),
    ]
    if spans:
        entries.append(panels.Patch(facecolor="#efe6cf", label="it sees the object"))
    panels.legend(figure, (0.07, 0.62 / height), entries, 4 if figure.get_figwidth() > 11.0 else 3)
    others = chosen.described("rule")
    sentences = [f"Root mean squares over {chosen.repetitions} paired repetitions{'; ' + others if others else ''}."]
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    panels.write_caption(figure, 0.07, sentences)


if __name__ == "__main__":
    data.main(main)
