#!/usr/bin/python3
"""What a data mule carries: true error and claimed σ of the group that measures badly, a panel a rule
and service.

    mule.py DATABASE OUTPUT [--group b] [--visits 79-121,239-281] [--measured 20] [--study S]

OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen by an option of its name.
"""

import argparse

import numpy as np

import data
import panels
import style

SERIES = ("rms_error_m", "claimed_sigma_m")
COLUMNS = 4


class Group:
    """A series of some agents alone."""

    def __init__(self, series, agents):
        self._series = series
        self._chosen = np.isin(series.agents, agents)

    def of(self, array, agents):
        if agents == "central":
            return self._series.of(array, agents)
        return getattr(self._series, array)[..., self._chosen]


def spans(text):
    """"79-121,239-281" as [(79, 121), (239, 281)]."""
    try:
        pairs = [tuple(map(float, span.split("-"))) for span in text.split(",") if span]
        if any(len(pair) != 2 or pair[0] > pair[1] for pair in pairs):
            raise ValueError
    except ValueError:
        raise data.UserError(f"--visits {text}: expected spans in seconds such as 79-121,239-281")
    return pairs


def order(cells):
    """Cells as they are drawn: service by service, each with its rules."""
    return sorted(range(len(cells)), key=lambda i: list(dict.fromkeys(
        cell["service"] for cell in cells)).index(cells[i]["service"]))


def panel(axes, t_s, curves, color, visits, alone_m):
    error, claimed, central = curves
    for start, end in visits:
        axes.axvspan(start, end, color="#efe6cf", lw=0.0, zorder=0.4)
    floor = axes.get_ylim()[0]
    panels.shade_gap(axes, t_s, claimed, error, color)
    panels.draw(axes, t_s, central, style.BLACK, "-", width=1.0, zorder=2)
    if alone_m is not None:
        axes.plot(t_s, alone_m, ls=(0, (1.0, 1.5)), color=style.GREY, lw=1.3, zorder=2.2)
    axes.fill_between(t_s, error.low, error.high, color=color, alpha=0.45, lw=0.0, zorder=2.5)
    panels.draw(axes, t_s, error, color, "-", marker="o", width=1.6)
    panels.draw(axes, t_s, claimed, color, (0, (3.2, 1.4)), width=1.8, zorder=3.5)
    last_error, last_claim = panels.last(error.value), panels.last(claimed.value)
    panels.note(axes, f"at the end: error {style.number(last_error)} m,\n"
                      f"claims {style.number(last_claim)} m"
                      + (" ↓" if last_claim < floor else ""))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--group", default="b", help="agents whose names begin so")
    parser.add_argument("--visits", default="", help="when the mule is in reach of the group")
    parser.add_argument("--measured", type=float, help="sigma_m of each agent of the group, 1 Hz")
    arguments, chosen = data.parse(parser)
    chosen.require_axes("rule", "service")
    agents = chosen.agents_named(arguments.group)
    series = chosen.series(SERIES)
    t_s = series["rms_error_m"].t_s
    alone_m = None
    if arguments.measured:
        alone_m = arguments.measured / np.sqrt(len(agents) * (np.floor(t_s) + 1.0))
    group = {name: Group(values, agents) for name, values in series.items()}
    visits = spans(arguments.visits)
    cells = order(chosen.cells)
    curves = {
        i: (
            panels.rms(group["rms_error_m"], i, interval=True),
            panels.rms(group["claimed_sigma_m"], i),
            panels.rms(series["claimed_sigma_m"], i, "central"),
        )
        for i in cells
    }
    rows = -(-len(cells) // COLUMNS)
    figure = style.new_figure(11.6, 2.6 * rows + 1.45)
    height = figure.get_figheight()
    grid = figure.add_gridspec(rows, COLUMNS, wspace=0.09, hspace=0.24, left=0.062, right=0.992,
                               top=1 - 0.62 / height, bottom=1.36 / height)
    values = panels.finite(
        [c.value for i in cells for c in (curves[i][0], curves[i][2])], "error")
    limits = 0.5 * values[values > 0].min(), 1.5 * values.max()
    rules = chosen.labels("rule")
    for k, i in enumerate(cells):
        axes = figure.add_subplot(grid[k // COLUMNS, k % COLUMNS])
        style.time_axis(axes, t_s)
        style.log_axis(axes, *limits)
        cell = chosen.cells[i]
        color, _ = style.rule_style(cell["rule"], rules)
        panel(axes, t_s, curves[i], color, visits, alone_m)
        axes.set_title(f"{cell['rule']}, {cell['service']}", color=color, fontweight="bold",
                       loc="left", pad=4, fontsize=9.5)
        axes.tick_params(labelleft=k % COLUMNS == 0, labelbottom=k + COLUMNS >= len(cells))
        if k + COLUMNS >= len(cells):
            axes.set_xlabel("time [s]", labelpad=1.5)
    decorate(figure, chosen, agents, visits, alone_m)
    style.write(figure, arguments.output)


def decorate(figure, chosen, agents, visits, alone_m):
    height = figure.get_figheight()
    figure.text(0.062, 1 - 0.3 / height, "Claimed and true standard error a coordinate of the group"
                " that measures badly [m]", fontsize=10.5, fontweight="bold", va="bottom")
    entries = [
        panels.line_entry("-", style.GREY, "true error, with 95 % interval", "o"),
        panels.line_entry((0, (3.2, 1.4)), style.GREY, "claimed σ"),
        panels.line_entry("-", style.BLACK, "σ of the central filter"),
    ]
    if alone_m is not None:
        entries.append(panels.line_entry((0, (1.0, 1.5)), style.GREY,
                                         "σ of all that the group measured"))
    entries += [
        panels.fill_entry("claims too much: overconfident", True),
        panels.fill_entry("claims too little: gives away", False),
    ]
    if visits:
        entries.append(panels.Patch(facecolor="#efe6cf", label="the mule is there"))
    panels.legend(figure, (0.062, 0.62 / height), entries, 4)
    size = f"{len(agents)} agents" if len(agents) != 1 else "1 agent"
    sentences = [
        f"Root mean squares over the group's {size} and {chosen.repetitions} paired"
        " repetitions, intervals by bootstrap over repetitions.",
    ]
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    panels.write_caption(figure, 0.062, sentences)


if __name__ == "__main__":
    data.main(main)
