#!/usr/bin/python3
"""Writes a small data set of the MRCLAM format into a folder: three robots on circles among four
landmarks, 20 s. The numbers are rounded, so that every machine writes the same.

    make_log.py FOLDER
"""

import math
import os
import sys

LANDMARKS = {6: (3.0, 0.0), 7: (-2.0, 3.0), 8: (-1.0, -3.0), 9: (4.0, 4.0)}
RADIUS, SPEED = 1.5, 0.3  # m, m/s
START = 1_000_000_000


def pose(robot, t):
    angle = 2.0 * robot + SPEED / RADIUS * t
    return (
        robot + RADIUS * math.cos(angle),
        RADIUS * math.sin(angle),
        (angle + math.pi / 2 + math.pi) % (2 * math.pi) - math.pi,
    )


def sighting(robot, t, place, k):
    """Range and bearing, with errors that repeat."""
    x, y, heading = pose(robot, t)
    bearing = math.atan2(place[1] - y, place[0] - x) - heading
    bearing = (bearing + math.pi) % (2 * math.pi) - math.pi
    return (
        math.hypot(place[0] - x, place[1] - y) + 0.1 * math.sin(37.0 * k),
        bearing + 0.03 * math.sin(53.0 * k),
    )


def write(folder, name, rows):
    with open(os.path.join(folder, name), "w", encoding="ascii") as file:
        file.write("# made for tests\n")
        file.writelines(" ".join(str(value) for value in row) + "\n" for row in rows)


def seconds(t):
    return f"{START + t:.3f}"


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    write(folder, "Barcodes.dat", [(s, 10 * s) for s in (1, 2, 3, 4, 5, *LANDMARKS)])
    write(folder, "Landmark_Groundtruth.dat", [(s, *p, 0.0, 0.0) for s, p in LANDMARKS.items()])
    tenths = [0.1 * k for k in range(-5, 206)]
    for robot in (1, 2, 3):
        truth = [(seconds(t), *(f"{v:.6f}" for v in pose(robot, t))) for t in tenths]
        write(folder, f"Robot{robot}_Groundtruth.dat", truth)
        drives = [(seconds(t), SPEED + 0.01 * math.sin(t), SPEED / RADIUS) for t in tenths]
        drives = [(t, f"{v:.4f}", f"{w:.4f}") for t, v, w in drives]
        write(folder, f"Robot{robot}_Odometry.dat", drives)
        seen = []
        for k in range(40):
            t = 0.5 * k + 0.05 * robot
            landmark = 6 + (k + robot) % 4
            companion = 1 + (robot + k % 2) % 3
            for subject, place in (
                (landmark, LANDMARKS[landmark]),
                (companion, pose(companion, t)),
            ):
                values = (f"{v:.3f}" for v in sighting(robot, t, place, 7 * k + robot))
                seen.append((seconds(t), 10 * subject, *values))
        write(folder, f"Robot{robot}_Measurement.dat", seen)


if __name__ == "__main__":
    main()
