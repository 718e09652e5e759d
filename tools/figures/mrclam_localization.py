#!/usr/bin/python3
"""Cooperative localization on real logs: a row of panels for each number of landmarks. How far off
the robots are on average, and how far off for what they claim, against how often they speak, for
each rule and rate of loss.

    mrclam_localization.py DATABASE OUTPUT [--study S]

OUTPUT ends with .png, .svg or .pdf.
"""

import argparse

import numpy as np

import data
import panels
import style

# A rate of loss: dash, marker, its face (None: the rule's colour).
LOOKS = (("-", "o", None), ((0, (4.0, 1.6)), "s", "white"), ((0, (1.0, 1.4)), "^", None))
APART = 0.07  # between what stands at the same period
QUANTITIES = (
    ("position_error_mean_m", "Mean distance from the true position [m]"),
    ("pose_anees", "ANEES of the poses, 1 if consistent"),
)


def over_agents(scalar, cell):
    """Mean over agents, of each repetition."""
    return np.nanmean([values[cell] for agent, values in scalar.items() if agent >= 0], axis=0)


def draw_panel(axes, chosen, scalar, landmarks, periods, losses):
    alone = chosen.cell(landmarks=landmarks, rule="none")
    central = np.nanmean(scalar[data.CENTRAL][alone])
    axes.axhline(central, color=style.BLACK, lw=1.0, ls=(0, (5, 2)), zorder=2)
    axes.axhline(over_agents(scalar, alone).mean(), color=style.GREY, lw=1.4, zorder=2)
    rules = [r for r in chosen.labels("rule") if r != "none"]
    x = np.arange(len(periods), dtype=float)
    for r, rule in enumerate(rules):
        color, _ = style.rule_style(rule, chosen.labels("rule"))
        for k, ((dash, marker, face), loss) in enumerate(zip(LOOKS, losses)):
            cells = [
                chosen.cell(landmarks=landmarks, rule=rule, period=p, loss=loss) for p in periods
            ]
            values = np.array([over_agents(scalar, c) for c in cells])
            place = r * len(losses) + k - 0.5 * (len(rules) * len(losses) - 1)
            at = x + APART * place
            axes.vlines(at, values.min(axis=1), values.max(axis=1), color=color, lw=0.9, zorder=2.5)
            axes.plot(
                at, values.mean(axis=1), ls=dash, color=color, lw=1.3, marker=marker, ms=4.5,
                mfc=face or color, zorder=3,
            )
    axes.set_xticks(x, [f"{data.label_text(p)} s" for p in periods])
    axes.set_xlim(-0.35, len(periods) - 0.65)
    axes.grid(axis="x", visible=False)


def legend_entries(chosen, losses):
    entries = [
        panels.line_entry("-", style.GREY, "alone"),
        panels.line_entry((0, (5, 2)), style.BLACK, "central filter of all five"),
    ]
    for rule in chosen.labels("rule"):
        if rule == "none":
            continue
        color, _ = style.rule_style(rule, chosen.labels("rule"))
        for (dash, marker, face), loss in zip(LOOKS, losses):
            entries.append(
                panels.line_entry(
                    dash, color, f"{rule}, {data.percent(loss)} lost", marker, mfc=face or color
                )
            )
    return entries


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments, chosen = data.parse(parser)
    chosen.require_axes("landmarks", "rule", "period", "loss")
    rows, periods, losses = (chosen.labels(a) for a in ("landmarks", "period", "loss"))
    if len(losses) > len(LOOKS):
        raise data.UserError(f"{len(losses)} rates of loss; the figure has room for {len(LOOKS)}")
    figure = style.new_figure(9.2, 2.6 * len(rows) + 1.7)
    height = figure.get_figheight()
    grid = figure.add_gridspec(
        len(rows), 2, left=0.115, right=0.985, top=1 - 0.4 / height, bottom=1.6 / height,
        wspace=0.16, hspace=0.16,
    )
    for k, (name, title) in enumerate(QUANTITIES):
        scalar = chosen.scalar(name)
        for i, landmarks in enumerate(rows):
            axes = figure.add_subplot(grid[i, k])
            draw_panel(axes, chosen, scalar, landmarks, periods, losses)
            if name == "pose_anees":
                axes.axhline(1.0, color=style.BLACK, lw=0.6, zorder=1)
                low, high = axes.dataLim.y0, axes.dataLim.y1
                style.log_axis(axes, 0.8 * min(low, 1.0), 1.25 * high)
            else:
                axes.set_ylim(0.0, None)
            axes.tick_params(labelbottom=i == len(rows) - 1)
            if i == 0:
                axes.set_title(title, loc="left", fontweight="bold")
            if i == len(rows) - 1:
                axes.set_xlabel("each robot speaks every …")
            if k == 0:
                axes.set_ylabel(f"{data.label_text(landmarks)} landmarks", fontweight="bold")
    panels.legend(figure, (0.115, 0.62 / height), legend_entries(chosen, losses), 4)
    panels.write_caption(figure, 0.115, [
        "Five robots of the UTIAS MRCLAM data sets over a simulated radio; means over robots and"
        f" {chosen.repetitions} repetitions of phases and losses, bars from the least to the largest"
        " repetition.",
        "Alone and in the central filter nothing depends on the radio.",
    ])
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
