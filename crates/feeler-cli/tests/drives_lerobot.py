"""Operates an emulated bus with LeRobot's motor classes, and prints the values as JSON.

    drives_lerobot.py dynamixel PORT
    drives_lerobot.py feetech PORT
    drives_lerobot.py feetech-scs PORT

The motor classes do not use PyTorch, but LeRobot's package imports it. If it is missing, an empty module takes its place.
"""

import json
import sys
import time
from types import ModuleType


class Absent(ModuleType):
    """Module whose attributes are types, which annotations may name."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


try:
    import torch  # noqa: F401
except ImportError:
    sys.modules["torch"] = Absent("torch")

from lerobot.motors import Motor, MotorCalibration, MotorNormMode  # noqa: E402

IDS = (1, 2, 3)
# A busy computer may delay emulated servos beyond the timeout of one attempt.
TRIES = 5


def near(values, expected, within):
    return all(abs(values[name] - expected[name]) <= within for name in expected)


def read_positions(bus):
    """Reads the normalised positions, one by one where LeRobot has no sync read (Feetech's protocol 1)."""
    if getattr(bus, "protocol_version", 0) == 1:
        return {name: bus.read("Present_Position", name, num_retry=TRIES) for name in bus.motors}
    return bus.sync_read("Present_Position", num_retry=TRIES)


def arrive(bus, goals):
    """Waits until the motors have arrived at `goals`, normalised from -100 to 100."""
    bus.sync_write("Goal_Position", goals)
    for _ in range(100):
        time.sleep(0.05)
        positions = read_positions(bus)
        if near(positions, goals, 2.0):
            return True
    print(positions, file=sys.stderr)
    return False


def calibrate(bus, said):
    """Sets the present positions as the middles of the ranges, and limits the ranges to half a turn."""
    homings = bus.set_half_turn_homings()
    positions = bus.sync_read("Present_Position", normalize=False, num_retry=TRIES)
    said["middle"] = all(abs(position - 2047) <= 2 for position in positions.values())
    calibration = {
        name: MotorCalibration(
            id=motor.id, drive_mode=0, homing_offset=homings[name], range_min=1024, range_max=3071
        )
        for name, motor in bus.motors.items()
    }
    bus.write_calibration(calibration)
    said["calibrated"] = bus.is_calibrated
    said["read_calibration"] = bus.read_calibration() == calibration


def motors(model):
    return {f"m{id_}": Motor(id_, model, MotorNormMode.RANGE_M100_100) for id_ in IDS}


def configured(bus):
    """Connects and configures the bus, with torque off. Returns what it said."""
    bus.connect()
    said = {"found": bus.broadcast_ping(num_retry=TRIES)}
    bus.disable_torque(num_retry=TRIES)
    bus.configure_motors()
    return said


def dynamixel(port):
    from lerobot.motors.dynamixel import DynamixelMotorsBus, OperatingMode

    bus = DynamixelMotorsBus(port, motors("xl330-m288"))
    said = configured(bus)
    for name in bus.motors:
        bus.write("Operating_Mode", name, OperatingMode.EXTENDED_POSITION.value, num_retry=TRIES)
    calibrate(bus, said)
    bus.enable_torque(num_retry=TRIES)
    said["extended"] = arrive(bus, {"m1": 50.0, "m2": -50.0, "m3": 0.0})
    with bus.torque_disabled():
        for name in bus.motors:
            bus.write("Operating_Mode", name, OperatingMode.CURRENT_POSITION.value, num_retry=TRIES)
            bus.write("Goal_Current", name, 300, num_retry=TRIES)
    said["limited"] = arrive(bus, {"m1": -20.0, "m2": 20.0, "m3": 30.0})
    currents = bus.sync_read("Present_Current", normalize=False, num_retry=TRIES)
    said["currents"] = all(abs(current) <= 300 for current in currents.values())
    for register in ("Hardware_Error_Status", "Present_Temperature", "Present_Input_Voltage"):
        said[register] = bus.read(register, "m2", normalize=False, num_retry=TRIES)
    bus.disconnect()
    return said


def feetech(port):
    from lerobot.motors.feetech import FeetechMotorsBus, OperatingMode

    bus = FeetechMotorsBus(port, motors("sts3215"))
    said = configured(bus)
    for name in bus.motors:
        bus.write("Operating_Mode", name, OperatingMode.POSITION.value, num_retry=TRIES)
        bus.write("P_Coefficient", name, 16, num_retry=TRIES)
    calibrate(bus, said)
    bus.enable_torque(num_retry=TRIES)
    bus.write("Torque_Limit", "m1", 500, num_retry=TRIES)
    said["position"] = arrive(bus, {"m1": 50.0, "m2": -50.0, "m3": 0.0})
    # Goals beyond the range are limited by LeRobot.
    said["returned"] = arrive(bus, {"m1": -90.0, "m2": 90.0, "m3": 10.0})
    for register in ("Status", "Present_Temperature", "Present_Voltage", "Torque_Limit"):
        said[register] = bus.read(register, "m1", normalize=False, num_retry=TRIES)
    bus.disconnect()
    return said


def feetech_scs(port):
    from lerobot.motors.feetech import FeetechMotorsBus

    bus = FeetechMotorsBus(port, motors("scs0009"), protocol_version=1)
    bus.connect()
    said = {"found": {motor.id: bus.ping(name, TRIES) for name, motor in bus.motors.items()}}
    bus.disable_torque(num_retry=TRIES)
    bus.configure_motors()
    # There is no homing offset: only the ranges are limited.
    calibration = {
        name: MotorCalibration(
            id=motor.id, drive_mode=0, homing_offset=0, range_min=256, range_max=767
        )
        for name, motor in bus.motors.items()
    }
    bus.write_calibration(calibration)
    said["calibrated"] = bus.is_calibrated
    said["read_calibration"] = bus.read_calibration() == calibration
    said["middle"] = near(read_positions(bus), {name: 0.0 for name in bus.motors}, 1.0)
    bus.enable_torque(num_retry=TRIES)
    said["position"] = arrive(bus, {"m1": 50.0, "m2": -50.0, "m3": 0.0})
    said["returned"] = arrive(bus, {"m1": -90.0, "m2": 90.0, "m3": 10.0})
    for register in ("Status", "Present_Temperature", "Present_Voltage", "Lock"):
        said[register] = bus.read(register, "m1", normalize=False, num_retry=TRIES)
    bus.disconnect()
    return said


if __name__ == "__main__":
    kind, port = sys.argv[1:]
    kinds = {"dynamixel": dynamixel, "feetech": feetech, "feetech-scs": feetech_scs}
    print(json.dumps(kinds[kind](port)))
