"""Shows how much of a drive's force any linear estimate can explain, by how far it looks ahead: `python emps_look_ahead.py drive.csv`.

`drive.csv` is what emps.py makes. The force is regressed on the speeds from AHEAD cycles later to 30 cycles before, on the direction of motion,
on a friction that fades with the speed, and on a constant: every linear filter of the encoder for speed and acceleration is among these. One
second is fitted, the next one is held out. A control loop can look ahead by none, fric's recordings by one. Needs numpy.
"""

import sys

import numpy as np

BEFORE = 30
CYCLE_S = 0.001
# Speed over which the direction changes, speed over which the extra friction fades, m/s.
REVERSAL_M_PER_S = 0.002
FADING_M_PER_S = 0.02

log = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
position_m, force_n = log["position_m"], log["motor_force_n"]
place = np.arange(len(position_m))
inside = (place > 2 * BEFORE) & (place < len(place) - 2 * BEFORE)
is_fitted = (place * CYCLE_S).astype(int) % 2 == 0
speed_m_per_s = np.diff(position_m, prepend=position_m[0]) / CYCLE_S
# Friction by the smoothed speed, for all alike.
smooth_m_per_s = np.gradient(np.convolve(position_m, np.ones(5) / 5, "same"), CYCLE_S)
direction = np.tanh(smooth_m_per_s / REVERSAL_M_PER_S)
friction = [direction, direction * np.exp(-abs(smooth_m_per_s) / FADING_M_PER_S), abs(smooth_m_per_s), np.ones(len(place))]

print("cycles ahead  rms held out [N]")
for ahead in (0, 1, 2, 4, 8):
    speeds = [np.roll(speed_m_per_s, cycle) for cycle in range(-ahead, BEFORE)]
    columns = np.column_stack(speeds + friction)
    fitted, held_out = inside & is_fitted, inside & ~is_fitted
    values, *_ = np.linalg.lstsq(columns[fitted], force_n[fitted], rcond=None)
    rest_n = (force_n - columns @ values)[held_out]
    print(f"{ahead:12}  {np.sqrt(np.mean(rest_n**2)):.2f}")
