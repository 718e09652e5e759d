#!/usr/bin/python3
"""What a byte buys: error and honesty of beliefs against the bytes each agent sent, for every policy of talk and
every content. A column a radio.

    policies.py DATABASE OUTPUT [--study S]

The study has the axes policy, content and radio. OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

COLORS = (style.BLACK, style.VERMILLION, style.BLUE, style.GREEN)
# Policies by the beginning of their labels: marker, and dash of the line through those of a kind.
KINDS = (("every ", "o", "-"), ("on update", "s", None), ("news ", "^", "--"), ("adaptive", "*", None))


class Price:
    """What the agents of a cell sent, and what they then knew."""

    def __init__(self, chosen):
        chosen.require_axes("policy", "content", "radio")
        self.chosen = chosen
        self.policies, self.contents, self.radios = (chosen.labels(a) for a in ("policy", "content", "radio"))
        self.series = chosen.series(("rms_error_m", "claimed_sigma_m"))
        self.bytes = chosen.scalar("bytes_sent")

    def of(self, policy, content, radio):
        """(bytes an agent, error, its interval, claimed σ): root mean squares over agents, repetitions
        and instants; NaN where there is no such cell."""
        cell = self.chosen.cell(policy=policy, content=content, radio=radio)
        if cell is None:
            return (np.nan,) * 5
        sent = float(np.mean([of_agent[cell] for agent, of_agent in self.bytes.items() if agent >= 0]))
        error = self.over_time(panels.rms(self.series["rms_error_m"], cell, interval=True))
        claimed = self.over_time(panels.rms(self.series["claimed_sigma_m"], cell))
        return sent, error[0], error[1], error[2], claimed[0]

    @staticmethod
    def over_time(curve):
        """Root mean square over all instants but the first, at which nothing was said yet."""
        return [
            float(np.sqrt(np.nanmean(np.square(values[1:])))) if values is not None else np.nan
            for values in (curve.value, getattr(curve, "low", None), getattr(curve, "high", None))
        ]


def draw(axes, price, radio, row):
    for color, content in zip(COLORS, price.contents):
        for beginning, marker, dash in KINDS:
            chosen = [p for p in price.policies if p.startswith(beginning)]
            values = np.array([price.of(p, content, radio) for p in chosen])
            if not len(values) or not np.isfinite(values[:, 0]).any():
                continue
            values = values[np.argsort(values[:, 0])]
            sent, error, low, high, claimed = values.T
            y = error if row == 0 else claimed / error
            size = 9.0 if marker == "*" else 5.5
            axes.plot(sent, y, ls=dash or "", color=color, marker=marker, ms=size, lw=1.1, mfc=color, zorder=3)
            if row == 0:
                axes.vlines(sent, low, high, color=color, lw=0.9, alpha=0.7, zorder=2)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(lambda v, _: f"{v:g}")


def caption(price):
    chosen = price.chosen
    return [
        f"{chosen.repetitions} paired repetitions. Root mean squares over agents, repetitions and all instants but"
        " the first; strokes: 95 % bootstrap interval. Solid lines join periodic policies, dashed ones thresholds"
        " of news; bytes with headers.",
        "Below one a belief claims more than it knows.",
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    price = Price(chosen)
    columns = len(price.radios)
    figure = style.new_figure(4.6 * columns, 6.4)
    height = figure.get_figheight()
    grid = figure.add_gridspec(2, columns, wspace=0.08, hspace=0.08, left=0.09, right=0.985,
                               top=1 - 0.35 / height, bottom=1.55 / height)
    for row, label in enumerate(("error an axis (m)", "claimed σ over error")):
        first = None
        for k, radio in enumerate(price.radios):
            axes = figure.add_subplot(grid[row, k], sharey=first)
            first = first or axes
            draw(axes, price, radio, row)
            if row == 0:
                axes.set_title(f"radio: {radio}", fontweight="bold")
                axes.set_yscale("log")
                axes.yaxis.set_major_formatter(lambda v, _: f"{v:g}")
                axes.yaxis.set_minor_formatter(lambda v, _: f"{v:g}")
            else:
                axes.axhline(1.0, color=style.GREY, lw=0.9, ls=(0, (4, 2)), zorder=1)
                axes.set_xlabel("bytes an agent sent")
            axes.tick_params(labelbottom=row == 1, labelleft=k == 0)
            if k == 0:
                axes.set_ylabel(label)
    left = grid[0, 0].get_position(figure).x0
    entries = [panels.line_entry("-", c, f"says: {name}") for c, name in zip(COLORS, price.contents)]
    names = ("periodic", "on update", "on news", "adaptive")
    entries += [panels.line_entry(dash or "", style.GREY, name, marker)
                for name, (_, marker, dash) in zip(names, KINDS)]
    panels.legend(figure, (left, 0.6 / height), entries, 4)
    panels.write_caption(figure, left, caption(price))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
