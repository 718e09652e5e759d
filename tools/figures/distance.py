#!/usr/bin/python3
"""Delivery against distance for each model of propagation, with the closed forms.

    distance.py DATABASE OUTPUT [--study S]

For the study scenarios/radio/character-distance. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import radio_panels
import radio_theory
import style

FRAME_BYTES = 50
SIGMA_DB = 4.0
# model: (name for a reader, share heard at a distance) as in scenarios/radio/character-distance.study.toml
MODELS = {
    "disk": ("disk, 50 m", lambda d: radio_theory.disk(d, 50.0)),
    "grey-zone": ("grey zone, 25 to 75 m", lambda d: radio_theory.grey_zone(d, 25.0, 75.0)),
    "log-distance": (
        "log-distance",
        lambda d: float(radio_theory.frame_success(radio_theory.snr_db(d), FRAME_BYTES)),
    ),
    "shadowed": (
        f"with shadowing, σ = {SIGMA_DB:g} dB",
        lambda d: radio_theory.shadowed_success(radio_theory.snr_db(d), FRAME_BYTES, SIGMA_DB),
    ),
}


def delivered(chosen, model, distances):
    """[distance, repetition]: share heard; 0 where nobody is in reach."""
    ratio = chosen.scalar_of("delivery_ratio", chosen.agent("sender"))
    rows = [ratio[chosen.cell(model=model, distance_m=d)] for d in distances]
    return np.nan_to_num(np.array(rows), nan=0.0)


def means_panel(axes, chosen, distances, x):
    fine = np.linspace(2.0, x.max(), 1200)
    for (model, (name, share)), color, marker in zip(
        MODELS.items(), radio_panels.COLORS, radio_panels.MARKERS
    ):
        if model not in chosen.labels("model"):
            continue
        radio_panels.theory(axes, fine, [share(d) for d in fine], color)
        radio_panels.points(axes, x, delivered(chosen, model, distances), color, marker, name)
    axes.set_title("Share of packets heard", loc="left", fontweight="bold")
    radio_panels.legend(axes, radio_panels.theory_entry("lines: closed forms"))


def links_panel(axes, chosen, distances, x):
    """Each link of one run with shadowing, and the share of links that deliver most."""
    color = radio_panels.COLORS[3]
    for distance, at in zip(distances, x):
        shares = chosen.link_shares(chosen.cell(model="shadowed", distance_m=distance))
        axes.plot(
            np.full(len(shares), at), shares, "o", color=style.GREY, ms=2.4, alpha=0.25, mew=0.0
        )
    fine = np.linspace(2.0, x.max(), 600)
    mean = [MODELS["shadowed"][1](d) for d in fine]
    radio_panels.theory(axes, fine, mean, color, width=1.4)
    axes.set_title("Shadowing, link by link", loc="left", fontweight="bold")
    at = x.max() * 0.75
    axes.annotate(
        "mean over links,\nclosed form", (at, MODELS["shadowed"][1](at)), (at, 0.2), fontsize=8,
        color=color, arrowprops=dict(arrowstyle="-", color=color, lw=0.6), zorder=5,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("model", "distance_m")
    distances = chosen.labels("distance_m")
    x, order = radio_panels.numbers(distances)
    distances, x = [distances[i] for i in order], x[order]
    shadowed = "shadowed" in chosen.labels("model")
    figure, axes = radio_panels.new_figure(2 if shadowed else 1)
    means_panel(axes[0], chosen, distances, x)
    if shadowed:
        links_panel(axes[1], chosen, distances, x)
    for panel in axes:
        panel.set_xlabel("distance [m]")
        panel.set_xlim(0.0, 1.02 * x.max())
        panel.set_ylim(-0.03, 1.05)
    radio_panels.caption(
        figure, chosen,
        f"Frames of {FRAME_BYTES} bytes; log-distance: exponent 3, 46.7 dB at 1 m, 0 dBm over a"
        " noise of −105 dBm, BER = ½ exp(−SNR/1.28). Shadowing is drawn once a link: most links are"
        " good or bad, few in between. Right: a dot is a link of the first repetition.",
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
