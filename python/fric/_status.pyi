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
