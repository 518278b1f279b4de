"""The flags of a cable, by name."""

from enum import IntFlag

from ._fric import STATUS_BITS

Status = IntFlag("Status", STATUS_BITS, module="fric")
Status.__doc__ = "What can be the matter with a cable in a cycle; 0 if nothing. `Status(int(bits))` names the flags."
