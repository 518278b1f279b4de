from enum import IntFlag

class Status(IntFlag):
    SLACK = 1
    SLIP = 2
    SENSOR_NOT_FINITE = 4
    SENSOR_FROZEN = 8
    LENGTH_JUMP = 16
    MOTION_NOT_FINITE = 32
    OUT_OF_RANGE = 64
    POSE_MISSING = 128
    POSE_UNREACHABLE = 256
    SENSOR_JUMP = 512
    UNSETTLED = 1024

class ShapeStatus(IntFlag):
    NOT_FINITE = 1
    NOT_CONVERGED = 2
    UNSTABLE = 4
    OVER_CAPACITY = 8
    DISKS_TOUCH = 16
    MEMORY_UNCERTAIN = 32

class GoalStatus(IntFlag):
    NOT_USABLE = 1
    NOT_CONVERGED = 2
    OUT_OF_REACH = 4
    HELD = 8
    REVERSAL = 16
    DEAD_BAND = 32
