#!/usr/bin/python3
"""Carrier sense in saturation: throughput and collisions against the number of stations, with
Bianchi's model.

    carrier_sense.py DATABASE OUTPUT [--study S]

For the study scenarios/radio/character-carrier-sense. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse
import math

import numpy as np
from matplotlib import ticker

import data
import radio_panels
import radio_theory
import style

WINDOW_MAX = 1024  # as in scenarios/radio/shared.toml


def doublings(window):
    return int(round(math.log2(WINDOW_MAX / window)))


def share(stations, window):
    """Of time that carries payload which arrives."""
    return radio_theory.bianchi_share(
        stations, radio_panels.SLOT_S, radio_panels.PAYLOAD_S, radio_panels.EXCHANGE_S,
        radio_panels.EXCHANGE_S, window, doublings(window),
    )


def collisions(chosen):
    """[cell, repetition]: share of frames that do not arrive."""
    sums = {}
    for name in ("frames", "packets_delivered"):
        sums[name] = sum(np.nan_to_num(v) for v in chosen.scalar(name).values())
    return 1.0 - sums["packets_delivered"] / sums["frames"]


def panel(axes, chosen, values, theory, title):
    for window, color, marker in zip(
        chosen.labels("window"), radio_panels.COLORS, radio_panels.MARKERS
    ):
        stations, order = radio_panels.numbers(chosen.labels("stations"))
        labels = [chosen.labels("stations")[i] for i in order]
        rows = [values[chosen.cell(window=window, stations=n)] for n in labels]
        fine = np.arange(1, int(stations.max()) + 1)
        radio_panels.theory(axes, fine, [theory(int(n), int(window)) for n in fine], color)
        name = f"window {window} … {WINDOW_MAX}"
        radio_panels.points(axes, stations[order], rows, color, marker, name)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(ticker.FixedLocator(stations))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.set_xlabel("stations")
    axes.set_title(title, loc="left", fontweight="bold")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("window", "stations")
    figure, axes = radio_panels.new_figure(2)
    goodput = chosen.scalar_of("goodput_bps", chosen.agent("sink")) / radio_panels.RATE_BPS
    panel(axes[0], chosen, goodput, share, "Share of time that carries payload")
    panel(
        axes[1], chosen, collisions(chosen),
        lambda n, window: radio_theory.bianchi(n, window, doublings(window))[1],
        "Share of frames that collide",
    )
    axes[0].set_ylim(0.0, 1.0)
    axes[1].set_ylim(bottom=-0.01)
    radio_panels.legend(axes[0], radio_panels.theory_entry("lines: Bianchi 2000"), loc="lower left")
    radio_panels.caption(
        figure, chosen,
        "Stations always have a packet for one sink, all hear one another; frames of 8584 bits at"
        " 1 Mbit/s, acknowledged, repeated until they arrive.",
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
