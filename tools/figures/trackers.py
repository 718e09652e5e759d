#!/usr/bin/python3
"""What hearsay does to tracks, by fusion rule: how far an agent's tracks are from the targets over time,
and at the end how many targets it misses, how many tracks follow nothing, how many a target too much.

    trackers.py DATABASE OUTPUT [--study S]

The study has the axis rule. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

KINDS = (
    ("missed_targets", "targets missed", style.GREY),
    ("false_tracks", "tracks of nothing", style.VERMILLION),
    ("double_tracks", "second tracks of a target", style.ORANGE),
)
APART = 4  # a marker every so many instants, and another rule's at another one: some curves lie on others
BY_DIRECTION = ("inverse-ci", "ellipsoidal")  # dashed: there are more rules than colours


def over_time(axes, series, chosen, rules):
    for i, rule in enumerate(rules):
        color, marker = style.rule_style(rule, rules)
        curve = panels.mean(series, chosen.cell(rule=rule))
        dash = "--" if rule in BY_DIRECTION else "-"
        axes.plot(series.t_s, curve.value, dash, color=color, marker=marker, ms=5.0, label=rule,
                  markevery=(i % APART, APART))
    style.time_axis(axes, series.t_s)
    axes.set_ylim(0.0, None)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("GOSPA [m]")
    axes.set_title("Distance of an agent's tracks from all targets", loc="left", fontweight="bold")
    axes.legend(loc="upper left", bbox_to_anchor=(0.06, 1.0), ncol=2, fontsize=8.0)


def at_end(axes, all_series, chosen, rules):
    places = np.arange(len(rules))[::-1].astype(float)
    left = np.zeros(len(rules))
    for name, label, color in KINDS:
        series = all_series[name]
        values = [panels.last(panels.mean(series, chosen.cell(rule=r)).value) for r in rules]
        axes.barh(places, values, left=left, height=0.6, color=color, label=label)
        left += values
    for place, end in zip(places, left):
        axes.text(end + 0.02 * left.max(), place, style.number(end), va="center", fontsize=8.0)
    axes.set_yticks(places, rules)
    axes.grid(axis="y", visible=False)
    axes.set_xlim(0.0, 1.12 * left.max())
    axes.set_xlabel("mean number at the end of the run, of an agent")
    axes.set_title("What is missing, and what is too much", loc="left", fontweight="bold")
    axes.legend(loc="lower right", fontsize=8.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("rule")
    rules = chosen.labels("rule")
    series = chosen.series(("gospa_m", *(name for name, _, _ in KINDS)))
    figure = style.new_figure(10.0, 4.4)
    grid = figure.add_gridspec(1, 2, left=0.06, right=0.985, top=0.92, bottom=0.22, wspace=0.26)
    over_time(figure.add_subplot(grid[0]), series["gospa_m"], chosen, rules)
    at_end(figure.add_subplot(grid[1]), series, chosen, rules)
    sentences = [
        f"Means over agents and {chosen.repetitions} repetitions.",
        "GOSPA of order 2 adds up the errors of tracks that follow a target, and half the squared"
        " cut-off for each target without a track and each track without a target.",
    ]
    panels.write_caption(figure, 0.06, sentences)
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
