"""Identification with scipy and numba, as one writes it without fric: μ, σ, F_pv and offset of every cable of a log.

The model is `per_pulley`: one Dahl state on each pulley's bearing, compiled by numba, one pass over all samples of a
cable. `scipy.optimize.least_squares` gets residuals only and differentiates by itself. Start: the robot file's values,
tolerances: scipy's own.

Usage: scipy_fit.py LOG.mcap ROBOT.toml OURS    OURS is what the example `fit` printed

Prints the time of all cables alone, without reading and compiling, for each of scipy's methods and scalings with and
without numba's `fastmath`, one cable after the other; how far each has ended from the least cost that any has found, of the
cable where that is most, in standard errors of independent residuals; then how far our values are from scipy's minimum over
the same samples, and for `run.sh` the lines `cable NAME mu sigma F_pv offset samples passes`, `seconds` and
`processor_seconds` of the fastest that has ended near, `all_cores_seconds` with as many cables at once as there are
cores, and `pass_seconds`, processor time of the model once over all samples of one cable.
"""

import functools
import math
import os
import statistics
import sys
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from mcap_ros2.reader import read_ros2_messages
from numba import njit
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation, Slerp

TOPICS = {"cable": "/cable_states", "reference": "/reference_forces", "pose": "/platform_pose"}
# The offset starts at zero, which says nothing of its size.
SMALLEST_SCALE = np.array([1e-3, 1.0, 1e-2, 1e-2])
RUNS = 3


def deviations(parameters, fixed_wrap_factors, last_wrap_factor, sensor_cos, force, displacement, speed, reference, used):
    """Force at the platform less its reference, for the samples used."""
    mu, sigma, viscous, offset = parameters
    pulleys = len(fixed_wrap_factors) + 1
    sigma /= pulleys
    gain = 1.0 / (1.0 - sensor_cos)
    stored = np.zeros(pulleys)
    out = np.empty(used.sum())
    place = 0
    for i in range(len(force)):
        drag = viscous * speed[i]
        distance = abs(displacement[i])
        sign = np.sign(displacement[i])
        tension = 0.0
        for j in range(pulleys):
            wrap_factor = fixed_wrap_factors[j] if j < pulleys - 1 else last_wrap_factor[i]
            friction = stored[j]
            if j == 0:
                behind = gain * (force[i] - sensor_cos * (friction + drag))
                before = behind - friction - drag
            else:
                before = tension
                behind = before + friction + drag
            if distance > 0.0:
                sliding = max(0.5 * mu * wrap_factor * (before + behind), 1e-30)
                friction = sign * sliding + (friction - sign * sliding) * math.exp(-sigma * distance / sliding)
                stored[j] = friction
            tension = gain * (force[i] - sensor_cos * (friction + drag)) if j == 0 else before + friction + drag
        if force[i] <= 0.0:
            stored[:] = 0.0
        if used[i]:
            out[place] = max(tension, 0.0) + offset - reference[i]
            place += 1
    return out


KERNELS = {
    "fastmath": njit(nogil=True, fastmath=True, error_model="numpy")(deviations),
    "exact": njit(nogil=True, error_model="numpy")(deviations),
}
# Scipy's default first; "size": the size of the start values.
METHODS = [("trf", 1.0), ("trf", "jac"), ("dogbox", "jac"), ("lm", "jac"), ("lm", "size")]
# A search that has ended further from the minimum than this many standard errors has ended early.
NEAR_ERRORS = 0.1


def read(path, topics):
    """Messages of each topic with their stamps in seconds after the log's first."""
    messages = {topic: [] for topic in topics}
    for message in read_ros2_messages(path, topics=topics):
        stamp = message.ros_msg.header.stamp
        messages[message.channel.topic].append((stamp.sec * 1_000_000_000 + stamp.nanosec, message.ros_msg))
    start = min(of_topic[0][0] for of_topic in messages.values() if of_topic)
    return {
        topic: (np.array([stamp - start for stamp, _ in of_topic]) * 1e-9, [message for _, message in of_topic])
        for topic, of_topic in messages.items()
    }


def wrap_factor(cable, positions, rotations):
    """2 sin(β/2) of the swivelling pulley's wrap β at each pose."""
    pulley = cable["pulleys"][-1]
    radius = pulley["radius_m"]
    axis = np.array(pulley["axis"]) / np.linalg.norm(pulley["axis"])
    attachment = positions + rotations.apply(cable["platform_m"]) - np.array(cable["base_m"])
    z = attachment @ axis
    x = np.linalg.norm(attachment - np.outer(z, axis), axis=1)
    phi = np.arctan2(z, x - radius)
    gamma = np.arccos(radius / np.hypot(x - radius, z))
    return 2.0 * np.sin(0.5 * (np.pi - (phi + gamma)))


def load(log, robot):
    """Of each cable: name, start values, and what `deviations` takes after them."""
    topics = {role: robot.get("log", {}).get(role, topic) for role, topic in TOPICS.items()}
    messages = read(log, list(topics.values()))
    stamps, cable_messages = messages[topics["cable"]]
    reference_stamps, reference_messages = messages[topics["reference"]]
    pose_stamps, poses = messages[topics["pose"]]
    names = list(cable_messages[0].name)
    reference_names = list(reference_messages[0].name)
    forces, lengths, speeds = (
        np.array([getattr(message, field) for message in cable_messages]) for field in ("effort", "position", "velocity")
    )
    references = np.array([message.effort for message in reference_messages])
    positions = np.array([[p.x, p.y, p.z] for p in (message.pose.position for message in poses)])
    turns = Rotation.from_quat([[q.x, q.y, q.z, q.w] for q in (message.pose.orientation for message in poses)])
    within = np.clip(stamps, pose_stamps[0], pose_stamps[-1])
    positions = np.column_stack([np.interp(within, pose_stamps, column) for column in positions.T])
    turns = Slerp(pose_stamps, turns)(within)
    has_pose = within == stamps
    cables = []
    for cable in robot["cable"]:
        sensor, *others, last = cable["pulleys"]
        assert sensor.get("sensor") and last["wrap"] == "pose", "written for a sensor pulley first and a swivelling one last"
        fixed = np.radians([pulley["wrap_deg"] for pulley in (sensor, *others)])
        column = names.index(cable["name"])
        force, length, speed = (np.ascontiguousarray(of[:, column]) for of in (forces, lengths, speeds))
        reference = references[:, reference_names.index(cable["name"])]
        reference = np.interp(stamps, reference_stamps, reference, left=np.nan, right=np.nan)
        friction = cable["friction"]
        start = [friction[key] for key in ("mu", "sigma_n_per_m", "viscous_n_s_per_m")] + [friction.get("offset_n", 0.0)]
        data = (
            2.0 * np.sin(0.5 * fixed),
            wrap_factor(cable, positions, turns),
            math.cos(fixed[0]),
            force,
            np.diff(length, prepend=length[0]),
            speed,
            reference,
            np.isfinite(reference) & (force > 0.0) & has_pose,
        )
        cables.append((cable["name"], np.array(start), data))
    return cables


def fit(cable, method, scale, kernel, **tolerances):
    """The parameters of one cable, twice the cost there and the passes over its samples."""
    _, start, data = cable
    passes = 0

    def residuals(parameters):
        nonlocal passes
        passes += 1
        return KERNELS[kernel](parameters, *data)

    scale = np.maximum(np.abs(start), SMALLEST_SCALE) if scale == "size" else scale
    found = least_squares(residuals, start, method=method, x_scale=scale, **tolerances)
    return found.x, 2.0 * found.cost, passes


def errors_from(least, squares, count):
    """How many standard errors of independent residuals raise the least sum of squares to `squares`."""
    return math.sqrt(max(squares / least - 1.0, 0.0) * count)


def seconds_of(work):
    """Time and processor time, medians of so many runs, and the last run's result."""
    times = []
    for _ in range(RUNS):
        start, processor = time.perf_counter(), time.process_time()
        result = work()
        times.append((time.perf_counter() - start, time.process_time() - processor))
    return *map(statistics.median, zip(*times)), result


def ours(path, cables):
    """How far our values are from scipy's minimum over the samples that we have used, of each cable."""
    lines = [line.split() for line in open(path, encoding="utf-8") if line.startswith("cable ")]
    values = {name: ([float(number) for number in numbers[:4]], int(numbers[5])) for _, name, *numbers in lines}
    for name, _, (*signals, used) in cables:
        found, warm_up = values[name]
        used = used.copy()
        used[np.flatnonzero(used)[:warm_up]] = False
        data = (*signals, used)
        squares = np.sum(KERNELS["exact"](np.array(found), *data) ** 2)
        _, least, _ = fit((name, np.array(found), data), "lm", "size", "exact", xtol=1e-14, ftol=1e-14)
        yield errors_from(least, squares, used.sum())


def main(log, robot_file, ours_file):
    with open(robot_file, "rb") as file:
        robot = tomllib.load(file)
    cables = load(log, robot)
    _, start, data = cables[0]
    for kernel in KERNELS.values():
        kernel(start, *data)  # compiles
    runs = {}
    for method, scale in METHODS:
        for kernel in KERNELS:
            run = functools.partial(fit, method=method, scale=scale, kernel=kernel)
            runs[method, scale, kernel] = *seconds_of(lambda: list(map(run, cables))), run
    least = [min(squares) for squares in zip(*([squares for _, squares, _ in fits] for _, _, fits, _ in runs.values()))]
    fastest = None
    for (method, scale, kernel), (seconds, processor_seconds, fits, run) in runs.items():
        errors = max(
            errors_from(low, squares, data[-1].sum())
            for low, (_, squares, _), (_, _, data) in zip(least, fits, cables)
        )
        cost, passes = sum(squares for _, squares, _ in fits) / 2, sum(passes for _, _, passes in fits)
        print(
            f"scipy {method:6} x_scale {scale!s:4} {kernel:8} {seconds:.3f} s, {passes} passes, cost {cost:.6f} N², "
            f"{errors:.3f} standard errors from the minimum"
        )
        if errors <= NEAR_ERRORS and (fastest is None or seconds < fastest[0]):
            fastest = seconds, processor_seconds, fits, run
    print("ours: at most {:.3f} standard errors from scipy's minimum over the same samples".format(
        max(ours(ours_file, cables))))
    seconds, processor_seconds, fits, run = fastest
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        all_cores_seconds, *_ = seconds_of(lambda: list(pool.map(run, cables)))
    _, pass_seconds, _ = seconds_of(lambda: KERNELS["fastmath"](start, *data))
    for (name, _, data), (values, _, passes) in zip(cables, fits):
        print("cable", name, *(f"{value:.9g}" for value in values), data[-1].sum(), passes)
    print(f"seconds {seconds:.6f}")
    print(f"processor_seconds {processor_seconds:.6f}")
    print(f"all_cores_seconds {all_cores_seconds:.6f}")
    print(f"pass_seconds {pass_seconds:.6f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
