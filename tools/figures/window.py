#!/usr/bin/python3
"""What the length of a window costs: how far estimates are from the central filter, and how much news comes too
late, against the length of the window.

    window.py DATABASE OUTPUT [--study S]

OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen by an option of its name.
"""

import argparse

import numpy as np

import data
import panels
import style


def distances(chosen, cells):
    """Root mean square distance an axis of all agents from the central filter, [cell, t]."""
    series = chosen.series(("x_m", "y_m"))
    squares = 0.0
    for name in ("x_m", "y_m"):
        own, central = series[name].of("total", "agents"), series[name].of("total", "central")
        squares = squares + 0.5 * (own - central) ** 2
    return series["x_m"].t_s, [np.sqrt(squares[cell].mean(axis=(0, -1))) for cell in cells]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("window")
    windows = chosen.labels("window")
    cells = [chosen.cell(window=w) for w in windows]
    seconds = [float(w) for w in windows]
    t_s, apart = distances(chosen, cells)
    figure = style.new_figure(9.6, 3.9)
    left, right = figure.subplots(1, 2)
    figure.subplots_adjust(left=0.075, right=0.985, top=0.88, bottom=0.27, wspace=0.22)
    shades = np.linspace(0.85, 0.1, len(cells))
    for w, curve, shade in zip(windows, apart, shades):
        color = (shade, 0.25 + 0.4 * shade, 0.7)
        left.plot(t_s, np.maximum(curve, 1e-9), color=color, lw=1.5, label=f"{float(w):g} s")
    left.set_yscale("log")
    left.set_ylim(1e-5, 10.0)
    left.set_xlim(0.0, t_s[-1])
    left.set_xlabel("time [s]", labelpad=1.5)
    left.set_title("Distance from the central filter an axis [m]", loc="left", fontsize=10,
                   fontweight="bold")
    left.legend(title="window", ncol=2, fontsize=8, title_fontsize=8, loc="lower left")
    late = chosen.scalar("news_late")
    agents = [a for a in late if a >= 0]
    mean = [np.mean([late[a][cell] for a in agents]) for cell in cells]
    right.bar(range(len(cells)), mean, color=style.BLUE, width=0.6)
    right.set_xticks(range(len(cells)), [f"{s:g}" for s in seconds])
    right.set_xlabel("window [s]", labelpad=1.5)
    right.set_title("News that came too late, an agent and run", loc="left", fontsize=10,
                    fontweight="bold")
    panels.write_caption(figure, 0.075, [
        f"Root mean squares over {len(agents)} agents and {chosen.repetitions} paired repetitions.",
        "News are stamps with measurements; what is too late is dropped.",
    ])
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
