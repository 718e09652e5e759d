#!/usr/bin/python3
"""Throughput and delay of a shared channel against offered load, for slotted ALOHA, carrier sense
and frames that pass through one another, with the closed forms.

    sharing.py DATABASE OUTPUT [--study S]

For the study scenarios/radio/character-sharing. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np
from matplotlib import ticker

import carrier_sense
import data
import radio_panels
import radio_theory
import style

STATIONS = 20  # as in scenarios/radio/shared.toml, and the least window
WINDOW = 32
MODELS = {
    "none": ("frames pass through one another", style.GREY, "D"),
    "slotted-aloha": ("slotted ALOHA", style.VERMILLION, "s"),
    "carrier-sense": ("carrier sense, acknowledged", style.BLUE, "o"),
}


def arrives(model, load):
    """Frames that arrive in the time of a frame."""
    if model == "none":
        return load
    if model == "slotted-aloha":
        return radio_theory.slotted_aloha(STATIONS, load / STATIONS)
    saturated = carrier_sense.share(STATIONS, WINDOW) / radio_panels.PAYLOAD_S
    return min(load, saturated * radio_panels.FRAME_S)


def delay_s(model, load):
    """Mean time from hand-over to arrival, or None where there is no closed form: a frame on the
    air, the wait for those of the same station, and for the next slot half a slot."""
    if model == "carrier-sense":
        return None
    wait = radio_theory.m_d_1_wait(load / STATIONS) + (0.5 if model == "slotted-aloha" else 0.0)
    return (1.0 + wait) * radio_panels.FRAME_S


def throughput_panel(axes, chosen, labels, loads):
    goodput = chosen.scalar_of("goodput_bps", chosen.agent("sink")) / radio_panels.RATE_BPS
    frames = goodput / radio_panels.PAYLOAD_S * radio_panels.FRAME_S
    fine = np.linspace(0.0, loads.max(), 400)
    for model, (name, color, marker) in MODELS.items():
        radio_panels.theory(axes, fine, [arrives(model, g) for g in fine], color)
        rows = [frames[chosen.cell(model=model, load=g)] for g in labels]
        radio_panels.points(axes, loads, rows, color, marker, name)
    axes.set_ylim(0.0, 1.05)
    axes.set_ylabel("frames that arrive in the time of a frame")
    axes.set_title("Throughput", loc="left", fontweight="bold")
    radio_panels.legend(
        axes, radio_panels.theory_entry("lines: closed forms"), loc="center right", fontsize=7.5
    )


def delay_panel(axes, chosen, labels, loads):
    delay = chosen.scalar_of("delay_mean_s", chosen.agent("sink"))
    fine = np.linspace(0.01, loads.max(), 200)
    for model, (_, color, marker) in MODELS.items():
        if delay_s(model, 1.0) is not None:
            radio_panels.theory(axes, fine, [1e3 * delay_s(model, g) for g in fine], color)
        rows = [1e3 * delay[chosen.cell(model=model, load=g)] for g in labels]
        radio_panels.points(axes, loads, rows, color, marker)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.set_ylim(bottom=5.0)
    axes.set_ylabel("hand-over to arrival, mean [ms]")
    axes.set_title("Delay of what arrives", loc="left", fontweight="bold")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("model", "load")
    loads, order = radio_panels.numbers(chosen.labels("load"))
    labels = [chosen.labels("load")[i] for i in order]
    figure, axes = radio_panels.new_figure(2)
    throughput_panel(axes[0], chosen, labels, loads[order])
    delay_panel(axes[1], chosen, labels, loads[order])
    for panel in axes:
        panel.set_xlabel("G: frames made in the time of a frame")
        panel.set_xlim(0.0, 1.03 * loads.max())
    radio_panels.caption(
        figure, chosen,
        f"{STATIONS} stations with Poisson arrivals and room for 16 packets each; a frame takes"
        " 8.584 ms. ALOHA sends each frame once. Without sharing throughput goes on along G."
        " Lines: G, G (1 − G/n)ⁿ⁻¹, and G up to what Bianchi's stations carry in saturation; a"
        " little above it more gets through as long as few stations have a queue.",
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
