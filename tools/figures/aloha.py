#!/usr/bin/python3
"""Throughput of slotted ALOHA against offered load, for several numbers of stations, with the
closed forms.

    aloha.py DATABASE OUTPUT [--study S]

For the study scenarios/radio/character-aloha. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse
import math

import numpy as np

import data
import radio_panels
import radio_theory
import style


def successes(chosen, cell):
    """Share of slots with a frame that arrives, a repetition each."""
    goodput_bps = chosen.scalar_of("goodput_bps", chosen.agent("sink"))[cell]
    return goodput_bps / radio_panels.RATE_BPS / radio_panels.PAYLOAD_S * radio_panels.FRAME_S


def draw(axes, chosen):
    largest = 0.0
    for stations, color, marker in zip(
        chosen.labels("stations"), radio_panels.COLORS, radio_panels.MARKERS
    ):
        n = int(stations)
        cells = [
            (n * float(p), chosen.cell(stations=stations, probability=p))
            for p in chosen.labels("probability")
        ]
        cells = [(offered, cell) for offered, cell in cells if cell is not None]
        x = np.array([offered for offered, _ in cells])
        largest = max(largest, x.max())
        fine = np.linspace(0.0, min(float(n), 3.6), 400)
        radio_panels.theory(axes, fine, radio_theory.slotted_aloha(n, fine / n), color)
        rows = [successes(chosen, cell) for _, cell in cells]
        radio_panels.points(axes, x, rows, color, marker, f"{n} stations")
    fine = np.linspace(0.0, 3.6, 400)
    radio_panels.theory(axes, fine, radio_theory.slotted_aloha_many(fine), style.BLACK, "--")
    axes.axhline(1.0 / math.e, color=style.GREY, lw=0.6, ls=":", zorder=1)
    axes.text(0.02, 1.0 / math.e + 0.005, "1/e", fontsize=8, color=style.GREY)
    radio_panels.legend(
        axes,
        radio_panels.theory_entry("n p (1 − p)ⁿ⁻¹, p = G/n"),
        radio_panels.theory_entry("G exp(−G), many stations", style.BLACK, "--"),
        loc="upper right",
    )
    axes.set_xlim(0.0, 1.03 * max(largest, 1.0))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("G: frames offered in a slot")
    axes.set_ylabel("frames that arrive in a slot")
    axes.set_title("Slotted ALOHA", loc="left", fontweight="bold")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("stations", "probability")
    figure, axes = radio_panels.new_figure(1, 6.4, 4.2)
    draw(axes[0], chosen)
    radio_panels.caption(
        figure, chosen, "Stations that always have a frame take each slot with probability p."
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
