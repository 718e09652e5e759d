#!/usr/bin/python3
"""Robots that follow each other, on real logs: above, how far off they are over time; below, by
graph and rate of loss, the median error of each way to exchange beliefs.

    mrclam_track.py DATABASE OUTPUT [--study S]

OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

# way to exchange: colour
COLORS = {
    "none": style.GREY,
    "naive": style.VERMILLION,
    "local-update": style.PURPLE,
    "ci-det": style.BLUE,
    "ci-half": style.SKY,
    "channel-robust": style.ORANGE,
    "channel-robust of trajectories": style.GREEN,
}
OVER_TIME = ("none", "naive", "ci-det")
FACES = ((None, 5.5), ("white", 5.0))  # of the first rate of loss, and of the second
LARGEST = 60.0  # m; what is larger is written


def color_of(exchange):
    return COLORS.get(exchange, style.BLACK)


def over_time(axes, chosen, where):
    series = chosen.series(["rms_error_m"])["rms_error_m"]
    for exchange in OVER_TIME:
        cell = chosen.cell(exchange=exchange, **where)
        curve = panels.rms(series, cell)
        axes.plot(series.t_s, curve.value, color=color_of(exchange), lw=1.2, label=exchange)
    central = panels.rms(series, cell, "central")
    axes.plot(series.t_s, central.value, color=style.BLACK, lw=1.0, label="central filter")
    style.log_axis(axes, 0.03, 1000.0)
    axes.set_xlim(0.0, series.t_s[-1])
    axes.set_xlabel("time [s]")
    axes.set_title(
        f"True error a coordinate [m], root mean square over robots ({where['topology']},"
        f" {data.percent(where['loss'])} lost)", loc="left", fontweight="bold",
    )
    axes.legend(loc="upper left", bbox_to_anchor=(0.005, 1.0), ncol=2, fontsize=8.0)


def medians(axes, chosen, scalar, topology, exchanges, losses):
    places = np.arange(len(exchanges))[::-1].astype(float)
    for place, exchange in zip(places, exchanges):
        color = color_of(exchange)
        for offset, (face, size), loss in zip((0.14, -0.14), FACES, losses):
            cell = chosen.cell(topology=topology, exchange=exchange, loss=loss)
            value = np.mean([v[cell] for agent, v in scalar.items() if agent >= 0])
            if value > LARGEST or not np.isfinite(value):
                far = style.number(value) if np.isfinite(value) else "∞"
                axes.text(
                    LARGEST, place + offset, f"{far} →", color=color, fontsize=7.0,
                    ha="right", va="center",
                )
                continue
            axes.plot(
                value, place + offset, "o", color=color, mfc=face or color, ms=size, zorder=3
            )
    central = scalar[data.CENTRAL][chosen.cell(topology=topology)].mean()
    axes.axvline(central, color=style.BLACK, lw=1.0, ls=(0, (5, 2)), zorder=1)
    axes.set_xscale("log")
    axes.set_xlim(0.1, LARGEST)
    axes.set_xticks([0.1, 0.3, 1.0, 3.0, 10.0, 30.0], ["0.1", "0.3", "1", "3", "10", "30"])
    axes.minorticks_off()
    axes.set_yticks(places, exchanges)
    axes.set_ylim(-0.6, len(exchanges) - 0.4)
    axes.set_xlabel("median error [m]")
    axes.set_title(topology, loc="left", fontweight="bold")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("topology", "exchange", "loss")
    topologies, exchanges, losses = (chosen.labels(a) for a in ("topology", "exchange", "loss"))
    if len(losses) > len(FACES):
        raise data.UserError(f"{len(losses)} rates of loss; the figure has room for {len(FACES)}")
    figure = style.new_figure(10.0, 6.6)
    upper = figure.add_gridspec(1, 1, left=0.055, right=0.985, top=0.95, bottom=0.64)
    lower = figure.add_gridspec(
        1, len(topologies), left=0.215, right=0.985, top=0.53, bottom=0.2, wspace=0.06
    )
    over_time(figure.add_subplot(upper[0]), chosen, {"topology": topologies[0], "loss": losses[0]})
    scalar = chosen.scalar("position_error_median_m")
    for k, topology in enumerate(topologies):
        axes = figure.add_subplot(lower[k])
        medians(axes, chosen, scalar, topology, exchanges, losses)
        axes.tick_params(labelleft=k == 0)
    entries = [
        panels.line_entry("", style.GREY, f"{data.percent(loss)} lost", "o", mfc=face or style.GREY)
        for (face, _), loss in zip(FACES, losses)
    ]
    entries.append(panels.line_entry((0, (5, 2)), style.BLACK, "central filter"))
    panels.legend(figure, (0.215, 0.09), entries, 3)
    panels.write_caption(figure, 0.055, [
        "Five robots of the UTIAS MRCLAM data sets that see one another now and then, over a"
        " simulated radio; each believes in the position and velocity of all five.",
        f"Below: median over instants, subjects and robots of the distance from the truth, mean over"
        f" {chosen.repetitions} repetitions of phases and losses; ∞: more than half the time nothing"
        " is known. Above: errors rise where nobody sees a robot; no curve while most know nothing.",
    ])
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
