"""Flags of a cable, of a manipulator's shape, and of a goal, by name."""

from enum import IntFlag

from ._fric import GOAL_STATUS_BITS, SHAPE_STATUS_BITS, STATUS_BITS

Status = IntFlag("Status", STATUS_BITS, module="fric")
Status.__doc__ = "What can be the matter with a cable in a cycle; 0 if nothing. `Status(int(bits))` names the flags."

ShapeStatus = IntFlag("ShapeStatus", SHAPE_STATUS_BITS, module="fric.continuum")
ShapeStatus.__doc__ = "What can be the matter with a shape; 0 if nothing. `ShapeStatus(int(bits))` names the flags."

GoalStatus = IntFlag("GoalStatus", GOAL_STATUS_BITS, module="fric.continuum")
GoalStatus.__doc__ = "What a command has to say of its goal; 0 if nothing. `GoalStatus(int(bits))` names the flags."
