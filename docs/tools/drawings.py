"""What each effect looks like in a log: simulated with it, compensated without it, drawn as SVG.

The robot is the winch of `examples/winch.toml` in its identification run. Left is the friction of the cable over time, measured
and by the model; right is what the model leaves of it, over the condition that the effect goes with.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import fric
import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

MEASURED, MODEL, OUT, IN = "#d55e00", "#0072b2", "#009e73", "#a0438d"
ROBOT = Path(__file__).resolve().parents[2] / "examples" / "winch.toml"
# Slower than this the cable may not slide yet, m/s.
SLIDING_M_PER_S = 0.05
# And slower than this the winch rests.
RESTING_M_PER_S = 0.002
BIN_COUNT = 60
# Stretches of the run, s: small steps with rests, strokes of 100 mm that grow faster, slow strokes of 400 mm.
STEPS, STROKES, SLOW = (7.0, 14.0), (18.0, 22.0), (22.5, 36.0)
# What makes an SVG the same each time.
mpl.rcParams.update({"svg.hashsalt": "fric", "font.size": 8.5, "svg.fonttype": "none", "font.family": "sans-serif"})


@dataclass(frozen=True)
class Look:
    """What to draw of an effect, and what to see in it; values other than those of the catalogue's example where they show more."""

    over: str
    window_s: tuple[float, float]
    sees: str
    values: dict[str, float] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)


LOOKS = {
    "coulomb": Look("load", SLOW, "Without `mu` in the file, all friction of the bearings is left. It grows in proportion to the load and changes its sign with the direction: two lines that open from zero."),
    "viscous": Look("speed", STROKES, "What is left grows in proportion to the speed. At low speed nothing is missing."),
    "presliding": Look("reversal", STEPS, "A model without `sigma_n_per_m` jumps from one side to the other at each reversal. The measured friction takes some tenths of a millimetre."),
    "stribeck": Look("speed", SLOW, "What is left is largest near standstill and is gone at a few times `velocity_m_per_s`. It changes its sign with the direction.", {"velocity_m_per_s": 0.15}),
    "direction_asymmetry": Look("speed", SLOW, "Friction is greater than the model's one way and smaller the other way: what is left has the same sign in both directions."),
    "bearing_drag": Look("load", SLOW, "What is left does not depend on the load: two level lines, one for each direction."),
    "load_nonlinearity": Look("load", SLOW, "What is left bends with the load: friction is greater than the model's at one end of the range and smaller at the other."),
    "friction_drift": Look("time and load", (22.5, 40.0), "What is left changes its sign with the direction. As a share of the load it grows evenly over the run, from nothing at its start."),
    "presliding_shape": Look("reversal", STEPS, "Before a reversal and far behind it nothing is missing. Between them the measured friction turns round on another curve."),
    "sensor_gain": Look("load", SLOW, "What is left is in proportion to the load and the same in both directions."),
    "sensor_offset": Look("load", SLOW, "What is left is the same whatever the load and the direction."),
    "sensor_drift": Look("time", (22.5, 40.0), "What is left is the same in both directions and grows evenly over the run."),
    "time_delay": Look("speed", STROKES, "The measured friction turns round later than the model's. What is left sits at the reversals, and is larger the faster the cable turns round."),
    "pulley_inertia": Look("acceleration", STROKES, "What is left is in proportion to the acceleration of the cable."),
    "pulley_eccentricity": Look("length", SLOW, "What is left ripples with the cable length, in step in both directions. Where the load is greater, it ripples more."),
    "cable_elasticity": Look("rest", STEPS, "While the winch rests and the load changes, the cable stretches and moves the pulleys: the measured friction changes. The model's stays as it was.", {"compliance_m_per_n": 0.0004}, {"hand_n": 2.0}),
    "dwell_stiction": Look("breakaway", STEPS, "After a rest the cable breaks away with more friction than it slides with: a peak that the model does not have."),
    "viscous_nonlinearity": Look("speed", STROKES, "What is left grows with the square of the speed and has the sign of the direction."),
    "friction_ripple": Look("length", SLOW, "What is left ripples with the cable length and changes its sign with the direction."),
    "winch_ripple": Look("length", SLOW, "What is left ripples with the cable length, in step in both directions and whatever the load.", {"period_m": 0.06}),
    "friction_warmup": Look("time and load", (0.0, 40.0), "What is left changes its sign with the direction. As a share of the load it changes quickly at first, then settles."),
    "pulley_defect": Look("load", SLOW, "What is left looks like a μ that is too small: two lines that open from zero. Only the reversals tell that it is one pulley."),
    "load_release": Look("rest", STEPS, "While the winch rests and the load falls, the measured friction falls with it. The model keeps what it has stored.", {}, {"hand_n": 2.0}),
    "gear_backlash": Look("reversal", STEPS, "After a reversal the winch turns by the play before the force answers. Then the curve is the model's, shifted by the play."),
    "sensor_nonlinearity": Look("load", SLOW, "What is left is a parabola over the load, the same in both directions."),
    "sensor_warmup": Look("time", (0.0, 40.0), "What is left is the same in both directions. It changes quickly at first, then settles."),
    "sensor_lag": Look("rate", STROKES, "What is left is in proportion to how fast the force changes: the sensor shows what was a moment ago.", {"time_constant_s": 0.012}),
    "empirical": Look("length", SLOW, "Whatever has no name: here a short piece of cable that rubs. The table follows it over the length; it can also follow the speed or the load.", {}, {"disturbances": ["local_defect:drag_n=0.15,from_start_m=0.1,width_m=0.03"]}),
}  # fmt: skip


class Case:
    """One effect in the log of the winch, and what the model without it makes of that."""

    def __init__(self, row: dict[str, Any], look: Look) -> None:
        truth, given = fric.Robot.read(ROBOT), fric.Robot.read(ROBOT)
        options = dict(look.options)
        if row["is_friction"]:
            key = row["parameters"][0]["key"]
            setattr(given.cable("cable").friction, key, None if key == "sigma_n_per_m" else 0.0)
        elif "disturbances" not in options:
            values = {parameter["key"]: value for parameter, value in zip(row["parameters"], row["example"])}
            options["effects"] = [{"kind": row["kind"], **values, **look.values}]
        log = fric.simulate(truth, seed=5, sensor_noise_n=0.004, reference_noise_n=0.002, **options)
        replay = fric.replay(given, log)
        self.time_s, self.length_m, self.speed_m_per_s = log.time_s, log.length_m[:, 0], log.speed_m_per_s[:, 0]
        self.load_n = replay.frictionless_n[:, 0]
        self.measured_n = log.reference_force_n[:, 0] - self.load_n
        self.model_n = replay.friction_n[:, 0]
        self.left_n = self.measured_n - self.model_n

    def condition(self, over: str) -> tuple[np.ndarray, str]:
        """What the right panel is over, and its name."""
        step_s = self.time_s[1] - self.time_s[0]
        match over:
            case "speed":
                return self.speed_m_per_s, "speed [m/s], positive paying out"
            case "load":
                return self.load_n, "load: cable force as if nothing rubbed [N]"
            case "length":
                return 1000.0 * self.length_m, "cable length [mm]"
            case "time" | "time and load":
                return self.time_s, "time [s]"
            case "acceleration":
                return np.gradient(self.speed_m_per_s, step_s), "acceleration of the cable [m/s²]"
            case "rate":
                smooth_n = np.convolve(self.load_n, np.ones(9) / 9.0, mode="same")
                return np.gradient(smooth_n, step_s), "rate of the load [N/s]"
        raise ValueError(over)

    def moving_off(self, *, after_rest: bool) -> slice:
        """Samples around a reversal of the slow strokes, or the longest step after a rest; paying out."""
        moves = self.speed_m_per_s > 1e-9
        window_s = STEPS if after_rest else SLOW
        starts = [start for start in np.flatnonzero(~moves[:-1] & moves[1:]) + 1 if window_s[0] < self.time_s[start] < window_s[1]]
        ends = [start + int(np.argmin(moves[start:])) for start in starts]
        start, end = max(zip(starts, ends), key=lambda pair: self.length_m[pair[1]] - self.length_m[pair[0]])
        return slice(start, end) if after_rest else slice(start - 60, start + 120)


def binned(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of y in bins of x that have some samples."""
    edges = np.linspace(np.percentile(x, 0.5), np.percentile(x, 99.5), BIN_COUNT + 1)
    place = np.digitize(x, edges) - 1
    middles, means = [], []
    for index in range(BIN_COUNT):
        inside = place == index
        if inside.sum() >= 6:
            middles.append(x[inside].mean())
            means.append(y[inside].mean())
    return np.array(middles), np.array(means)


def draw(row: dict[str, Any], path: Path) -> str:
    """Writes the drawing of an effect and gives what there is to see in it."""
    look = LOOKS[row["kind"]]
    case = Case(row, look)
    figure = Figure((7.6, 2.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    shown = (case.time_s >= look.window_s[0]) & (case.time_s <= look.window_s[1])
    every = max(1, int(shown.sum() / 700))
    for values, color, name in ((case.measured_n, MEASURED, "measured"), (case.model_n, MODEL, "model without it")):
        left.plot(case.time_s[shown][::every], values[shown][::every], color=color, lw=0.9, label=name)
    left.set(xlabel="time [s]", ylabel="friction [N]", title="in the log")
    left.legend(frameon=False, fontsize=7.5, loc="best")
    match look.over:
        case "reversal" | "breakaway":
            moving(case, look, right)
        case "rest":
            resting(case, look, right)
        case _:
            condition(case, look, right)
    for axes in (left, right):
        axes.grid(color="#dddddd", lw=0.5)
        axes.set_axisbelow(True)
    figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None}, facecolor="white")
    return look.sees


def moving(case: Case, look: Look, axes: Any) -> None:
    """Friction over the way."""
    after_rest = look.over == "breakaway"
    part = case.moving_off(after_rest=after_rest)
    turn = part.start if after_rest else part.start + 60
    way_mm = 1000.0 * (case.length_m[part] - case.length_m[turn])
    axes.plot(way_mm, case.measured_n[part], color=MEASURED, lw=1.0)
    axes.plot(way_mm, case.model_n[part], color=MODEL, lw=1.0)
    axes.set(xlabel=f"way from the {'rest' if after_rest else 'reversal'} [mm]", ylabel="friction [N]", title="after a rest" if after_rest else "at a reversal")
    axes.set_xlim(-0.5, way_mm.max() if after_rest else 3.0)


def resting(case: Case, look: Look, axes: Any) -> None:
    """What is left over time, the rests marked."""
    shown = (case.time_s >= look.window_s[0]) & (case.time_s <= look.window_s[1])
    time_s, rests = case.time_s[shown], np.abs(case.speed_m_per_s[shown]) < RESTING_M_PER_S
    axes.plot(time_s, np.convolve(case.left_n, np.ones(9) / 9.0, mode="same")[shown], color=MEASURED, lw=1.0)
    axes.fill_between(time_s, 0, 1, where=rests, transform=axes.get_xaxis_transform(), color="#eeeeee", lw=0, label="the winch rests")
    axes.legend(frameon=False, fontsize=7.5, loc="best")
    axes.set(xlabel="time [s]", ylabel="left of friction [N]", title="what the model leaves")


def condition(case: Case, look: Look, axes: Any) -> None:
    """What is left over what it goes with: all of it, or while the cable slides one way or the other."""
    x, name = case.condition(look.over)
    unit = "left of friction [N]"
    left_n = case.left_n
    if look.over == "time and load":
        left_n, unit = left_n / case.load_n, "left of friction / load"
    axes.axhline(0.0, color="#888888", lw=0.6)
    if look.over in ("speed", "acceleration", "rate"):
        middles, means = binned(x, left_n)
        axes.plot(middles, means, color=MEASURED, lw=1.0, marker=".", ms=4)
    else:
        for sign, color, word in ((1.0, OUT, "paying out"), (-1.0, IN, "reeling in")):
            sliding = sign * case.speed_m_per_s > SLIDING_M_PER_S
            middles, means = binned(x[sliding], left_n[sliding])
            axes.plot(middles, means, color=color, lw=1.0, marker=".", ms=4, label=word)
        axes.legend(frameon=False, fontsize=7.5, loc="best")
    # Noise alone has to look like nothing.
    least, greatest = axes.get_ylim()
    axes.set_ylim(min(least, -0.01), max(greatest, 0.01))
    axes.set(xlabel=name, ylabel=unit, title="what the model leaves")
