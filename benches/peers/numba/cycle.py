"""The cycle of fric-core written by hand for one robot, with numba: same equations and input as the Eigen peer.

cycle.py time lumped|per_pulley INPUT ROUNDS   |   cycle.py output lumped|per_pulley INPUT FILE
INPUT is what `cycle_instructions input FILE` writes. `time` prints nanoseconds per cycle, the best of the rounds, without
compiling. No status checks, no slip limit, no effects. Without `fastmath`, which would change the numbers.
"""

import math
import sys
import time
from pathlib import Path

import numpy as np
from numba import njit

PULLEYS = 3
RADIUS_M = 0.01
MASS_KG = 0.41
CENTER_OF_MASS_M = np.array([0.01, -0.02, 0.005])
GRAVITY_N = np.array([0.0, 0.0, -9.80665 * MASS_KG])


@njit
def dahl(friction_n, sliding_n, sigma_n_per_m, displacement_m):
    """Exact step of Dahl's law, [P] 16."""
    if displacement_m == 0.0:
        return friction_n
    target_n = math.copysign(sliding_n, displacement_m)
    return target_n + (friction_n - target_n) * math.exp(-sigma_n_per_m * abs(displacement_m) / sliding_n)


@njit
def step(is_lumped, parameters, pose, signals, last_length_m, stored_n, forces_n, outside, applied):
    """One cycle: forces at the platform and both wrenches out of pose and signals.

    The swivel axis of every last pulley is z.
    """
    x, y, z, w = pose[3], pose[4], pose[5], pose[6]
    r00, r01, r02 = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    r10, r11, r12 = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    r20, r21, r22 = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    outside[:] = 0.0
    for i in range(parameters.shape[0]):
        mu, sigma_n_per_m, viscous_n_s_per_m, offset_n = parameters[i, :4]
        base_x, base_y, base_z, platform_x, platform_y, platform_z = parameters[i, 4:10]
        arm_x = r00 * platform_x + r01 * platform_y + r02 * platform_z
        arm_y = r10 * platform_x + r11 * platform_y + r12 * platform_z
        arm_z = r20 * platform_x + r21 * platform_y + r22 * platform_z

        # The last pulley: direction from the attachment to the exit point, and 2 sin(β/2) of the wrap.
        radial_x, radial_y = pose[0] + arm_x - base_x, pose[1] + arm_y - base_y
        along = pose[2] + arm_z - base_z
        distance = math.sqrt(radial_x * radial_x + radial_y * radial_y)
        from_centre = distance - RADIUS_M
        centre_squared = from_centre * from_centre + along * along
        free = math.sqrt(centre_squared - RADIUS_M * RADIUS_M)
        cos = (from_centre * RADIUS_M - along * free) / centre_squared
        sin = (along * RADIUS_M + from_centre * free) / centre_squared
        across = (RADIUS_M + RADIUS_M * cos - distance) / free / distance
        direction_x, direction_y = radial_x * across, radial_y * across
        direction_z = (RADIUS_M * sin - along) / free
        wrap_factor = math.sqrt(2.0 * (1.0 + cos))

        sensor_force_n, length_m, speed_m_per_s = signals[i]
        displacement_m = length_m - last_length_m[i]
        if math.isnan(displacement_m):
            displacement_m = 0.0
        last_length_m[i] = length_m
        factors = (2.0, math.sqrt(2.0), wrap_factor)
        drag_n = viscous_n_s_per_m * speed_m_per_s
        if is_lumped:
            # One Dahl state on the macroscopic Coulomb friction of the cable; sensor pulley of 180°, [P] 14.
            turn = 1.0 if displacement_m > 0.0 else (-1.0 if displacement_m < 0.0 else 0.0)
            coulomb_n = 0.5 * sensor_force_n * (1.0 + turn * mu)
            viscous_n = 0.5 * drag_n
            for j in range(1, PULLEYS):
                coupling = turn * mu * factors[j]
                coulomb_n = coulomb_n * (2.0 + coupling) / (2.0 - coupling)
                viscous_n = (viscous_n * (2.0 + coupling) + 2.0 * drag_n) / (2.0 - coupling)
            sliding_n = abs(coulomb_n - 0.5 * sensor_force_n)
            stored_n[i, 0] = dahl(stored_n[i, 0], sliding_n, sigma_n_per_m, displacement_m)
            friction_n = stored_n[i, 0] + viscous_n
        else:
            # One Dahl state on each pulley. Sensor pulley of 180°: F_0 + F_1 = F_s whatever rubs.
            of_pulley = sigma_n_per_m / PULLEYS
            stored_n[i, 0] = dahl(stored_n[i, 0], mu * 0.5 * factors[0] * sensor_force_n, of_pulley, displacement_m)
            tension_n = 0.5 * (sensor_force_n + stored_n[i, 0] + drag_n)
            for j in range(1, PULLEYS):
                behind_n = tension_n + stored_n[i, j] + drag_n
                sliding_n = max(0.0, mu * 0.5 * factors[j] * (tension_n + behind_n))
                stored_n[i, j] = dahl(stored_n[i, j], sliding_n, of_pulley, displacement_m)
                tension_n += stored_n[i, j] + drag_n
            friction_n = tension_n - 0.5 * sensor_force_n
        force_n = 0.5 * sensor_force_n + friction_n + offset_n
        forces_n[i] = force_n
        outside[0] -= direction_x * force_n
        outside[1] -= direction_y * force_n
        outside[2] -= direction_z * force_n
        outside[3] -= (arm_y * direction_z - arm_z * direction_y) * force_n
        outside[4] -= (arm_z * direction_x - arm_x * direction_z) * force_n
        outside[5] -= (arm_x * direction_y - arm_y * direction_x) * force_n

    com_x, com_y, com_z = CENTER_OF_MASS_M[0], CENTER_OF_MASS_M[1], CENTER_OF_MASS_M[2]
    at_x = r00 * com_x + r01 * com_y + r02 * com_z
    at_y = r10 * com_x + r11 * com_y + r12 * com_z
    at_z = r20 * com_x + r21 * com_y + r22 * com_z
    gravity_x, gravity_y, gravity_z = GRAVITY_N[0], GRAVITY_N[1], GRAVITY_N[2]
    applied[0] = outside[0] - gravity_x
    applied[1] = outside[1] - gravity_y
    applied[2] = outside[2] - gravity_z
    applied[3] = outside[3] - (at_y * gravity_z - at_z * gravity_y)
    applied[4] = outside[4] - (at_z * gravity_x - at_x * gravity_z)
    applied[5] = outside[5] - (at_x * gravity_y - at_y * gravity_x)


@njit
def run(is_lumped, parameters, poses, signals, last_length_m, stored_n, forces_n, outside, applied):
    """All cycles; the outcome of each stays in its row."""
    for cycle in range(poses.shape[0]):
        step(
            is_lumped, parameters, poses[cycle], signals[cycle], last_length_m, stored_n,
            forces_n[cycle], outside[cycle], applied[cycle],
        )  # fmt: skip


def main(command, form, path, last):
    numbers = Path(path).read_text().split()
    cables, cycles = int(numbers[0]), int(numbers[1])
    numbers = np.array(numbers[2:], dtype=float)
    parameters = numbers[: 10 * cables].reshape(cables, 10)
    rows = numbers[10 * cables :].reshape(cycles, 7 + 3 * cables)
    poses = rows[:, :7].copy()
    signals = rows[:, 7:].reshape(cycles, cables, 3).copy()
    outcome = np.zeros((cycles, cables)), np.zeros((cycles, 6)), np.zeros((cycles, 6))
    state = np.full(cables, np.nan), np.zeros((cables, PULLEYS))
    is_lumped = form == "lumped"
    run(is_lumped, parameters, poses, signals, *state, *outcome)
    if command == "output":
        np.savetxt(last, np.hstack(outcome[:2]), fmt="%.17g")
        return
    times_s = []
    for _ in range(int(last)):
        start = time.perf_counter()
        run(is_lumped, parameters, poses, signals, *state, *outcome)
        times_s.append(time.perf_counter() - start)
    print(min(times_s) * 1e9 / cycles)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit("see the head of cycle.py for the two ways to call this")
    main(*sys.argv[1:])
