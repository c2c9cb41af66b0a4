#!/usr/bin/env python3
"""Compare simulated sessions with real NCLT sessions, statistic by statistic.

Usage: scripts/compare-simulation.py NCLT_DIR SIMULATED_DIR

Each directory holds one directory a session, named by its date, with NCLT's CSV files. The result is a Markdown
table on standard output: real sessions on the left, simulated ones on the right, `–` where a session lacks the
file. Needs Python 3 and nothing else. Exit status: 0 done, 2 error.

How the figures are taken, the same on both sides:

- Everything is planar: x north, y east, heading. Rows with NaN and rows whose time does not advance are left out.
- Sessions come at different rates (here 1 to 10 Hz), so all series are first interpolated at common times: every
  second for lengths, every two seconds (the paper's keyframes) for the rest. Nothing is interpolated across a
  silence of more than 5 s.
- Moving means at least 0.15 m/s over two seconds.
- Turning is the sum of the changes of the direction of travel between points 5 m apart along the path.
- A step error is the odometry's motion over two seconds against the true motion, as SE(2) logarithm; its spread is
  the robust standard deviation, 1.4826 times the median of the absolute values.
- The end drift is the distance at the end after the best rigid alignment of the first 200 m; the ATE is the root
  mean square distance after the best rigid alignment of everything.
- Landmark edges are pairs of keyframes, one in each half of the session, within 3 m and 30 degrees of heading.
"""

import math
import sys
from bisect import bisect_left
from pathlib import Path

LONGEST_SILENCE = 5.0
KEYFRAME_SECONDS = 2.0
LENGTH_SECONDS = 1.0
MOVING = 0.15
TURNING_METRES = 5.0
START_METRES = 200.0
RADIUS = 3.0
HEADING = math.radians(30.0)
NOTHING = "–"


class Problem(Exception):
    """Something to tell the user in one sentence."""


def wrap(angle):
    return math.remainder(angle, math.tau)


class Series:
    """Numbers over time: seconds, and one list a column. Columns named in `angles` are interpolated as angles."""

    def __init__(self, times, columns, angles=()):
        self.times, self.columns, self.angles = times, columns, set(angles)

    def at(self, time):
        """The columns at a time, or None outside the series and inside a silence."""
        after = bisect_left(self.times, time)
        if after == len(self.times):
            return None
        if self.times[after] == time:
            return [column[after] for column in self.columns]
        before = after - 1
        if before < 0 or self.times[after] - self.times[before] > LONGEST_SILENCE:
            return None
        share = (time - self.times[before]) / (self.times[after] - self.times[before])
        values = []
        for index, column in enumerate(self.columns):
            change = column[after] - column[before]
            if index in self.angles:
                change = wrap(change)
            values.append(column[before] + share * change)
        return values


def read(path, wanted, angles=()):
    """Reads the wanted columns (counted from 0, the time being column 0) of one of NCLT's files, or None."""
    if not path.is_file():
        return None
    times, columns = [], [[] for _ in wanted]
    with open(path, encoding="ascii", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            if not line.strip() or line.startswith("#"):
                continue
            fields = line.split(",")
            try:
                time = float(fields[0]) * 1e-6
                row = [float(fields[column]) for column in wanted]
            except (ValueError, IndexError):
                raise Problem(f"{path}, line {number}: expected at least {max(wanted) + 1} numbers") from None
            if any(not math.isfinite(value) for value in [time, *row]) or (times and time <= times[-1]):
                continue
            times.append(time)
            for column, value in zip(columns, row):
                column.append(value)
    return Series(times, columns, angles) if len(times) > 1 else None


def dead_reckoning(wheels, euler):
    """Positions from the wheels' mean speed along the heading of the IMU, as posecut-ingest --odometry wheels."""
    times, xs, ys, headings = [], [], [], []
    x = y = 0.0
    last = None
    for time, left, right in zip(wheels.times, *wheels.columns):
        attitude = euler.at(time)
        if attitude is None:
            continue
        pitch, heading = attitude
        speed = 0.5 * (left + right) * math.cos(pitch)
        if last is not None:
            way = 0.5 * (speed + last[1]) * (time - last[0])
            middle = last[2] + 0.5 * wrap(heading - last[2])
            x, y = x + way * math.cos(middle), y + way * math.sin(middle)
        last = (time, speed, heading)
        for column, value in zip((times, xs, ys, headings), (time, x, y, heading)):
            column.append(value)
    return Series(times, [xs, ys, headings], angles=(2,)) if len(times) > 1 else None


def grid(first, last, step):
    return [first + index * step for index in range(int((last - first) / step) + 1)]


def between(one, other):
    """The pose of `other` in the frame of `one`, as SE(2) logarithm."""
    cos, sin = math.cos(one[2]), math.sin(one[2])
    dx, dy = other[0] - one[0], other[1] - one[1]
    return log((cos * dx + sin * dy, -sin * dx + cos * dy, wrap(other[2] - one[2])))


def log(pose):
    x, y, angle = pose
    half = 0.5 * angle
    factor = 1.0 - half * half / 3.0 if abs(half) < 1e-6 else half / math.tan(half)
    return (factor * x + half * y, -half * x + factor * y, angle)


def exp(tangent):
    u, v, angle = tangent
    if abs(angle) < 1e-6:
        sine, cosine = 1.0 - angle * angle / 6.0, 0.5 * angle
    else:
        sine, cosine = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle
    return (sine * u - cosine * v, cosine * u + sine * v, angle)


def quantile(values, share):
    ordered = sorted(values)
    place = share * (len(ordered) - 1)
    low = int(place)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (place - low) * (ordered[high] - ordered[low])


def robust_deviation(values):
    return 1.4826 * quantile([abs(value) for value in values], 0.5)


def path_length(points):
    return sum(math.dist(one[:2], other[:2]) for one, other in zip(points, points[1:]))


def turning(points):
    """Sum of the absolute changes of direction between points TURNING_METRES apart, in full turns."""
    corners, here = [points[0]], points[0]
    for point in points[1:]:
        if math.dist(here[:2], point[:2]) >= TURNING_METRES:
            corners.append(point)
            here = point
    directions = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in zip(corners, corners[1:])]
    return sum(abs(wrap(b - a)) for a, b in zip(directions, directions[1:])) / math.tau


def align(moving, fixed):
    """The rigid motion of the plane that brings `moving` closest to `fixed` (Umeyama 1991, without scale)."""
    count = len(moving)
    mean = [[sum(point[axis] for point in points) / count for axis in (0, 1)] for points in (moving, fixed)]
    cos = sin = 0.0
    for p, q in zip(moving, fixed):
        px, py, qx, qy = p[0] - mean[0][0], p[1] - mean[0][1], q[0] - mean[1][0], q[1] - mean[1][1]
        cos += px * qx + py * qy
        sin += px * qy - py * qx
    angle = math.atan2(sin, cos)
    cos, sin = math.cos(angle), math.sin(angle)
    shift = (mean[1][0] - cos * mean[0][0] + sin * mean[0][1], mean[1][1] - sin * mean[0][0] - cos * mean[0][1])
    return lambda p: (cos * p[0] - sin * p[1] + shift[0], sin * p[0] + cos * p[1] + shift[1])


def landmark_edges(keyframes):
    """Pairs of the first and the second half that see the same place along the same heading."""
    middle = len(keyframes) // 2
    cells = {}
    for pose in keyframes[middle:]:
        if pose is not None:
            cells.setdefault((int(pose[0] // RADIUS), int(pose[1] // RADIUS)), []).append(pose)
    count = 0
    for pose in keyframes[:middle]:
        if pose is None:
            continue
        column, row = int(pose[0] // RADIUS), int(pose[1] // RADIUS)
        for near in [(column + i, row + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
            for other in cells.get(near, ()):
                if math.dist(pose[:2], other[:2]) <= RADIUS and abs(wrap(pose[2] - other[2])) <= HEADING:
                    count += 1
    return count


def odometry_statistics(prefix, odometry, truth):
    """Step errors and drift of one odometry."""
    first, last = max(odometry.times[0], truth.times[0]), min(odometry.times[-1], truth.times[-1])
    pairs = [(odometry.at(time), truth.at(time)) for time in grid(first, last, KEYFRAME_SECONDS)]
    errors = []
    for (measured, true), (measured_next, true_next) in zip(pairs, pairs[1:]):
        if None not in (measured, true, measured_next, true_next):
            errors.append(between(exp(between(measured, measured_next)), exp(between(true, true_next))))
    both = [pair for pair in pairs if None not in pair]
    measured, true = [pair[0] for pair in both], [pair[1] for pair in both]
    driven, start = 0.0, 1
    while start < len(true) and driven < START_METRES:
        driven += math.dist(true[start - 1][:2], true[start][:2])
        start += 1
    by_start, by_all = align(measured[:start], true[:start]), align(measured, true)
    squares = [math.dist(by_all(p), q[:2]) ** 2 for p, q in zip(measured, true)]
    return {
        f"{prefix}: step error forward (m)": f"{robust_deviation([e[0] for e in errors]):.3f}",
        f"{prefix}: step error sideways (m)": f"{robust_deviation([e[1] for e in errors]):.3f}",
        f"{prefix}: step error heading (rad)": f"{robust_deviation([e[2] for e in errors]):.4f}",
        f"{prefix}: end drift, start aligned (m)": f"{math.dist(by_start(measured[-1]), true[-1][:2]):.1f}",
        f"{prefix}: ATE, all aligned (m)": f"{math.sqrt(sum(squares) / len(squares)):.1f}",
    }


def statistics(directory):
    """The statistics of a session by name, in the order of rows; None without ground truth."""
    truth = read(directory / f"groundtruth_{directory.name}.csv", (1, 2, 6), angles=(2,))
    if truth is None:
        return None
    integrated = read(directory / "odometry_mu_100hz.csv", (1, 2, 6), angles=(2,))
    wheels = read(directory / "wheels.csv", (1, 2))
    euler = read(directory / "ms25_euler.csv", (2, 3), angles=(1,))
    reckoned = dead_reckoning(wheels, euler) if wheels and euler else None

    clock = integrated or reckoned or truth
    first, last = clock.times[0], clock.times[-1]
    fine = [pose for pose in map(truth.at, grid(first, last, LENGTH_SECONDS)) if pose is not None]
    keyframes = [truth.at(time) for time in grid(first, last, KEYFRAME_SECONDS)]
    speeds = [
        math.dist(one[:2], other[:2]) / KEYFRAME_SECONDS
        for one, other in zip(keyframes, keyframes[1:])
        if one is not None and other is not None
    ]
    moving = [speed for speed in speeds if speed >= MOVING]
    if not moving:
        raise Problem(f"{directory}: the robot never moves")
    length = path_length(fine)
    extent = [max(p[axis] for p in fine) - min(p[axis] for p in fine) for axis in (0, 1)]
    found = {
        "rows of ground truth a second": f"{(len(truth.times) - 1) / (truth.times[-1] - truth.times[0]):.1f}",
        "path length (m)": f"{length:.0f}",
        "duration (min)": f"{(last - first) / 60:.1f}",
        "mean speed while moving (m/s)": f"{sum(moving) / len(moving):.2f}",
        "median speed while moving (m/s)": f"{quantile(moving, 0.5):.2f}",
        "share of time stopped (%)": f"{100 * (1 - len(moving) / len(speeds)):.1f}",
        "turning (full turns)": f"{turning(fine):.0f}",
        "extent north x east (m)": f"{extent[0]:.0f} x {extent[1]:.0f}",
        "correct landmark edges": f"{landmark_edges(keyframes)}",
    }
    if integrated:
        found |= odometry_statistics("odometry_mu_100hz", integrated, truth)
    if reckoned:
        found |= odometry_statistics("wheels + ms25_euler", reckoned, truth)
    if wheels:
        ways = 0.0
        points = zip(zip(wheels.times, *wheels.columns), zip(wheels.times[1:], *(c[1:] for c in wheels.columns)))
        for (time, *speed), (time_next, *speed_next) in points:
            if time_next - time <= LONGEST_SILENCE:
                ways += abs(0.25 * (sum(speed) + sum(speed_next))) * (time_next - time)
        found["wheels' path / true path"] = f"{ways / length:.3f}"
    if euler:
        errors = []
        for time, heading in zip(euler.times, euler.columns[1]):
            pose = truth.at(time)
            if pose is not None:
                errors.append(math.degrees(wrap(heading - pose[2])))
        offset = quantile(errors, 0.5)
        rest = [abs((error - offset + 180) % 360 - 180) for error in errors]
        absolute = [abs(error) for error in errors]
        found["ms25_euler heading error: absolute, median (deg)"] = f"{quantile(absolute, 0.5):.1f}"
        found["ms25_euler heading error: absolute, 95 % (deg)"] = f"{quantile(absolute, 0.95):.1f}"
        found["ms25_euler heading error: signed median (deg)"] = f"{round(offset, 1) + 0.0:.1f}"
        found["ms25_euler heading error: median about that (deg)"] = f"{quantile(rest, 0.5):.1f}"
    return found


def sessions(directory):
    if not directory.is_dir():
        raise Problem(f"{directory}: is no directory; name the one that holds a directory for each session")
    found = {}
    for path in sorted(directory.iterdir()):
        values = statistics(path) if path.is_dir() else None
        if values:
            found[path.name] = values
        elif path.is_dir():
            print(f"{sys.argv[0]}: {path}: no usable groundtruth_{path.name}.csv, left out", file=sys.stderr)
    if not found:
        raise Problem(f"{directory}: there is no session with ground truth in it")
    return found


def table(real, simulated):
    names = list(dict.fromkeys(name for values in [*real.values(), *simulated.values()] for name in values))
    # A real session may lack what the first one has and the reverse: rows are grouped by their first word.
    groups = ["odometry_mu_100hz", "wheels", "wheels'", "ms25_euler"]
    place = {word.rstrip(":"): number for number, word in enumerate(groups, 1)}
    order = sorted(names, key=lambda name: place.get(name.split()[0].rstrip(":"), 0))
    columns = [(f"real {name}", values) for name, values in real.items()]
    columns += [(f"sim. {name}", values) for name, values in simulated.items()]
    rows = [["statistic", *(title for title, _ in columns)]]
    rows += [[name, *(values.get(name, NOTHING) for _, values in columns)] for name in order]
    widths = [max(len(row[index]) for row in rows) for index in range(len(rows[0]))]
    for number, row in enumerate(rows):
        cells = [row[0].ljust(widths[0])] + [cell.rjust(width) for cell, width in zip(row[1:], widths[1:])]
        print("| " + " | ".join(cells) + " |")
        if number == 0:
            print("|" + "-" * (widths[0] + 2) + "|" + "|".join("-" * (width + 1) + ":" for width in widths[1:]) + "|")


def main():
    if any(argument in ("-h", "--help") for argument in sys.argv[1:]):
        print(__doc__.strip())
        return 0
    if len(sys.argv) != 3:
        print(f"Usage: {sys.argv[0]} NCLT_DIR SIMULATED_DIR (--help tells more)", file=sys.stderr)
        return 2
    try:
        table(sessions(Path(sys.argv[1])), sessions(Path(sys.argv[2])))
    except (Problem, OSError) as problem:
        print(f"{sys.argv[0]}: error: {problem}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
