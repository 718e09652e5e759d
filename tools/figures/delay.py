#!/usr/bin/python3
"""Mean wait in a transmitter's queue, and what a short queue drops, against load, with the closed
forms.

    delay.py DATABASE OUTPUT [--study S]

For the study scenarios/radio/character-delay. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np
from matplotlib import ticker

import data
import radio_panels
import radio_theory
import style

SERVICE_MS = 1.0  # a packet on the air, on average
ROOM = 8  # of the short queue
SIZES = {"fixed": style.BLUE, "exponential": style.VERMILLION}
QUEUES = {"unbounded": ("o", "-"), "8 packets": ("s", (0, (4, 1.5)))}
NAMES = {
    ("fixed", "unbounded"): "equal sizes: M/D/1",
    ("exponential", "unbounded"): "exponential sizes: M/M/1",
    ("fixed", "8 packets"): f"equal sizes, room for {ROOM}: M/D/1/{ROOM}",
    ("exponential", "8 packets"): f"exponential sizes, room for {ROOM}: M/M/1/{ROOM}",
}


def wait_and_share(sizes, queue, load):
    """(mean wait in services, share that gets in) of the closed forms."""
    exponential = sizes == "exponential"
    if queue == "unbounded":
        wait = radio_theory.m_m_1_wait if exponential else radio_theory.m_d_1_wait
        return wait(load), 1.0
    bounded = radio_theory.m_m_1_k if exponential else radio_theory.m_d_1_k
    return bounded(load, ROOM)


def measured(chosen, name, sizes, queue):
    """(loads, [load, repetition] of a scalar of the sender) of the cells that there are."""
    values = chosen.scalar_of(name, chosen.agent("sender"))
    loads, rows = [], []
    for label in chosen.labels("load"):
        cell = chosen.cell(sizes=sizes, queue=queue, load=label)
        if cell is not None:
            loads.append(float(label))
            rows.append(values[cell])
    return np.array(loads), np.array(rows)


def wait_panel(axes, chosen):
    for (sizes, queue), name in NAMES.items():
        color, (marker, dash) = SIZES[sizes], QUEUES[queue]
        loads, waits = measured(chosen, "queue_delay_mean_s", sizes, queue)
        if len(loads) == 0:
            continue
        fine = np.linspace(0.02, max(loads), 400)
        theory = [SERVICE_MS * wait_and_share(sizes, queue, load)[0] for load in fine]
        radio_panels.theory(axes, fine, theory, color, dash)
        radio_panels.points(axes, loads, 1e3 * waits, color, marker, name)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(ticker.LogLocator(base=10.0, subs=(1.0, 3.0)))
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda v, _: f"{v:g}"))
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.set_ylim(0.03, 40.0)
    axes.set_ylabel("mean wait [ms]")
    axes.set_title("Wait before the first bit", loc="left", fontweight="bold")
    radio_panels.legend(
        axes, radio_panels.theory_entry("lines: closed forms"), loc="lower right"
    )


def loss_panel(axes, chosen):
    queue = "8 packets"
    for sizes, color in SIZES.items():
        marker, dash = QUEUES[queue]
        loads, shares = measured(chosen, "delivery_ratio", sizes, queue)
        if len(loads) == 0:
            continue
        fine = np.linspace(0.02, max(loads), 400)
        theory = [1.0 - wait_and_share(sizes, queue, load)[1] for load in fine]
        radio_panels.theory(axes, fine, theory, color, dash)
        radio_panels.points(axes, loads, 1.0 - shares, color, marker)
    axes.set_ylim(bottom=-0.01)
    axes.set_ylabel("share dropped")
    axes.set_title(f"What a queue of {ROOM} drops", loc="left", fontweight="bold")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("sizes", "queue", "load")
    figure, axes = radio_panels.new_figure(2)
    wait_panel(axes[0], chosen)
    loss_panel(axes[1], chosen)
    for panel in axes:
        panel.set_xlabel("load (arrivals × mean time on the air)")
        panel.set_xlim(left=0.0)
    radio_panels.caption(
        figure, chosen,
        f"Poisson arrivals, {SERVICE_MS:g} ms on the air on average. Room for {ROOM} counts the"
        " packet that is being sent.",
    )
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
