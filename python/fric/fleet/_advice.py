"""Likely causes of a change of a parameter, and what to do about it on the machine."""

from __future__ import annotations

from typing import Literal, NamedTuple


class Advice(NamedTuple):
    """Cause and remedy of a change."""

    cause: str
    remedy: str


def advice(parameter: str, shape: Literal["step", "slope"], *, rises: bool) -> Advice:
    """Returns the likely cause of a step, a rise, or a fall of a parameter, or the meaning of the parameter if no cause is known."""
    name = parameter.rpartition(".")[2]
    for key in (parameter, name):
        known = _KNOWN.get((key, shape, rises)) or _KNOWN.get((key, shape, None))
        if known:
            return known
    if parameter.startswith(("before.", "after.")):
        return _ERRORS[parameter.startswith("after.")]
    if "." in parameter:
        effect = parameter.partition(".")[0]
        return Advice(f"the effect {effect} has changed", _COMPARE)
    return Advice(f"{parameter} has changed", _COMPARE)


_COMPARE = "run fric discover on a log from before and one from after the change, and compare what they name"
_SENSOR = "ask what was done to the sensor at the winch; calibrate it with known weights and tare it, then fit anew"

_KNOWN: dict[tuple[str, Literal["step", "slope"], bool | None], Advice] = {
    ("mu", "slope", True): Advice(
        "a bearing of this cable runs dry or wears",
        "turn each pulley of the cable by hand, clean and grease the stiff one or replace its bearing",
    ),
    ("mu", "slope", False): Advice("the bearings run in, or grease spreads", "nothing; fit anew when it has settled"),
    ("mu", "step", True): Advice(
        "a bearing has seized or was damaged, or the cable rubs on a flange or left its groove",
        "look at each pulley of the cable: groove, flange, play; replace what is damaged, then fit anew",
    ),
    ("mu", "step", False): Advice("pulleys were greased or replaced", "fit anew and put the new values into the robot file"),
    ("viscous_n_s_per_m", "slope", None): Advice(
        "the grease of the pulleys ages, or it gets warmer or colder",
        "compare with the temperature; grease the pulleys if that is not it",
    ),
    ("viscous_n_s_per_m", "step", None): Advice(
        "the pulleys were greased or replaced", "fit anew and put the new values into the robot file"
    ),
    ("sigma_n_per_m", "slope", None): Advice(
        "the contact at the pulleys changes: the cable wears, or a bearing gets play",
        "look at the cable where it runs over pulleys, and at the bearings' play",
    ),
    ("sigma_n_per_m", "step", None): Advice("cable or pulleys were replaced", "fit anew and put the new values into the robot file"),
    ("offset_n", "step", None): Advice("a force sensor was replaced, or tared under load", _SENSOR),
    ("offset_n", "slope", None): Advice(
        "the zero of the force sensor or its amplifier drifts", "tare the sensor; replace it if it goes on"
    ),
    ("gain", "step", None): Advice("the force sensor or its amplifier was replaced or set otherwise", _SENSOR),
    ("gain", "slope", None): Advice(
        "the force sensor or its amplifier ages", "calibrate the sensor with known weights; replace it if it goes on"
    ),
    ("noise_floor_n", "step", True): Advice(
        "a sensor, its cable or its shielding has got worse", "look at plugs and shields of both force sensors"
    ),
    ("noise_floor_n", "slope", True): Advice("a sensor or its amplifier ages", "look at plugs and shields of both force sensors"),
    ("flagged_ratio", "step", True): Advice(
        "the sensor drops out, freezes or jumps", "look at its plug and cable; fric replay names the flags"
    ),
    ("flagged_ratio", "slope", True): Advice(
        "the sensor drops out more and more", "look at its plug and cable; fric replay names the flags"
    ),
}
_ERRORS = {
    False: Advice(
        "the cable rubs otherwise than before, or the sensor shows something else", "see what mu and offset_n of the same cable say"
    ),
    True: Advice("the model leaves more, or less, than before", _COMPARE),
}
