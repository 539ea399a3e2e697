"""Reads an emulated bus with the vendors' SDKs, and prints the values as JSON.

    drives_masters.py dynamixel PORT BAUD_RATE
    drives_masters.py feetech PORT BAUD_RATE
    drives_masters.py feetech-scs PORT BAUD_RATE
"""

import json
import sys
import time


TRIES = 3


def patient(sdk, packets):
    """Lets `packets` wait half a second for a response and retry on timeout.

    Servos respond within 34 ms, but the emulated ones run in a program that a busy computer may delay.
    """
    sdk.port_handler.LATENCY_TIMER = 250
    once = packets.txRxPacket

    def again(port, packet):
        answer = once(port, list(packet))
        for _ in range(1, TRIES):
            if answer[1] != sdk.COMM_RX_TIMEOUT:
                break
            answer = once(port, list(packet))
        return answer

    packets.txRxPacket = again
    return packets


def signed(value, bits):
    """Two's complement."""
    return value - (1 << bits) if value & (1 << (bits - 1)) else value


def checked(sdk, packets):
    """Returns a function that asserts the success of a call to `packets` and returns its value."""

    def good(answer):
        *values, result, error = answer
        assert result == sdk.COMM_SUCCESS, packets.getTxRxResult(result)
        assert error == 0, packets.getRxPacketError(error)
        return values[0] if values else None

    return good


def dynamixel(path, baud_rate):
    import dynamixel_sdk as sdk

    port, once = sdk.PortHandler(path), sdk.PacketHandler(2.0)
    packets = patient(sdk, sdk.PacketHandler(2.0))
    assert port.openPort() and port.setBaudRate(baud_rate)
    good, said = checked(sdk, packets), {}

    said["model"] = good(packets.ping(port, 2))
    found, result = packets.broadcastPing(port)
    assert result == sdk.COMM_SUCCESS, packets.getTxRxResult(result)
    said["found"] = sorted(found)
    for servo in (1, 2, 3):
        good(packets.write1ByteTxRx(port, servo, 64, 0))
        good(packets.write1ByteTxRx(port, servo, 11, 1))
        good(packets.write1ByteTxRx(port, servo, 64, 1))
        good(packets.write1ByteTxRx(port, servo, 65, 1))
    said["led"] = good(packets.read1ByteTxRx(port, 3, 65))
    # EEPROM write with torque enabled, velocity above the limit, write to a read-only register.
    refused = [
        packets.write1ByteTxRx(port, 1, 11, 3),
        packets.write4ByteTxRx(port, 1, 104, 100_000),
        packets.write4ByteTxRx(port, 1, 132, 0),
    ]
    said["refused"] = [error for _, error in refused]
    start = good(packets.read4ByteTxRx(port, 2, 132))
    write = sdk.GroupSyncWrite(port, packets, 104, 4)
    for servo, velocity in ((1, 100), (2, -100), (3, 0)):
        assert write.addParam(servo, list(velocity.to_bytes(4, "little", signed=True)))
    assert write.txPacket() == sdk.COMM_SUCCESS
    time.sleep(0.3)
    read = sdk.GroupSyncRead(port, packets, 128, 8)
    for servo in (1, 2, 3):
        assert read.addParam(servo)
    assert read.txRxPacket() == sdk.COMM_SUCCESS
    said["velocities"] = [signed(read.getData(servo, 128, 4), 32) for servo in (1, 2, 3)]
    assert read.fastSyncRead() == sdk.COMM_SUCCESS
    said["fast"] = [signed(read.getData(servo, 128, 4), 32) for servo in (1, 2, 3)]
    said["turned"] = signed(read.getData(2, 132, 4), 32) - start
    said["modes"] = dynamixel_positions(sdk, packets, port, good)
    # The bus watchdog stops the motor, and rejects goals until it is cleared.
    good(packets.write1ByteTxRx(port, 1, 98, 5))
    time.sleep(0.4)
    said["watchdog"] = good(packets.read1ByteTxRx(port, 1, 98))
    said["stopped"] = good(packets.read4ByteTxRx(port, 1, 104))
    said["after"] = packets.write4ByteTxRx(port, 1, 104, 10)[1]
    result, error = packets.reboot(port, 2)
    assert (result, error) == (sdk.COMM_SUCCESS, 0)
    said["rebooting"] = once.ping(port, 2)[1] == sdk.COMM_RX_TIMEOUT
    time.sleep(0.5)
    said["torque"] = good(packets.read1ByteTxRx(port, 2, 64))
    port.closePort()
    return said


def dynamixel_positions(sdk, packets, port, good):
    """Moves servos 1 and 3 in each position mode; returns whether they arrive, and errors of refused goals."""
    said = {}
    for mode, distance in ((4, 5000), (5, -600), (3, -300)):
        goals = {}
        write = sdk.GroupSyncWrite(port, packets, 116, 4)
        for servo in (1, 3):
            good(packets.write1ByteTxRx(port, servo, 64, 0))
            good(packets.write1ByteTxRx(port, servo, 11, mode))
            if mode == 5:
                good(packets.write2ByteTxRx(port, servo, 102, 300))
            good(packets.write1ByteTxRx(port, servo, 64, 1))
            goals[servo] = signed(good(packets.read4ByteTxRx(port, servo, 132)), 32) + distance
            goal = goals[servo].to_bytes(4, "little", signed=True)
            assert write.addParam(servo, list(goal))
        assert write.txPacket() == sdk.COMM_SUCCESS
        time.sleep(2.0)
        read = sdk.GroupSyncRead(port, packets, 126, 10)
        for servo in goals:
            assert read.addParam(servo)
        assert read.txRxPacket() == sdk.COMM_SUCCESS
        errors = [signed(read.getData(servo, 132, 4), 32) - goal for servo, goal in goals.items()]
        said[f"arrived_{mode}"] = all(abs(error) < 16 for error in errors)
        currents = [abs(signed(read.getData(servo, 126, 2), 16)) for servo in goals]
        said[f"current_{mode}"] = all(current <= 300 for current in currents)
    # A goal beyond the turn in mode 3, and a current above the limit.
    refused = [
        packets.write4ByteTxRx(port, 1, 116, 5000),
        packets.write2ByteTxRx(port, 1, 102, 2000),
    ]
    said["refused"] = [error for _, error in refused]
    for servo in (1, 3):
        good(packets.write1ByteTxRx(port, servo, 64, 0))
        good(packets.write1ByteTxRx(port, servo, 11, 1))
        good(packets.write1ByteTxRx(port, servo, 64, 1))
    return said


def feetech_positions(sdk, packets, port, good):
    """Moves servos in position mode with half of their output; returns their final positions."""
    write = sdk.GroupSyncWrite(port, packets, 42, 2)
    goals = {1: 1000, 2: 3000, 3: 2048}
    for servo, goal in goals.items():
        good(packets.write1ByteTxRx(port, servo, 40, 0))
        good(packets.write1ByteTxRx(port, servo, 55, 0))
        good(packets.write1ByteTxRx(port, servo, 33, 0))
        # An offset of sign and magnitude: -100 counts.
        good(packets.write2ByteTxRx(port, servo, 31, sdk.SCS_TOSCS(-100, 11)))
        good(packets.write1ByteTxRx(port, servo, 55, 1))
        good(packets.write2ByteTxRx(port, servo, 46, 0))
        good(packets.write2ByteTxRx(port, servo, 48, 500))
        good(packets.write1ByteTxRx(port, servo, 40, 1))
        assert write.addParam(servo, [sdk.SCS_LOBYTE(goal), sdk.SCS_HIBYTE(goal)])
    assert write.txPacket() == sdk.COMM_SUCCESS
    time.sleep(3.0)
    positions = {servo: good(packets.read2ByteTxRx(port, servo, 56)) for servo in goals}
    offsets = {servo: good(packets.read2ByteTxRx(port, servo, 31)) for servo in goals}
    return {
        "arrived": all(abs(positions[servo] - goal) < 16 for servo, goal in goals.items()),
        "offset": sdk.SCS_TOHOST(offsets[1], 11),
    }


def feetech(path, baud_rate):
    import scservo_sdk as sdk

    port, once = sdk.PortHandler(path), sdk.PacketHandler(0)
    packets = patient(sdk, sdk.PacketHandler(0))
    assert port.openPort() and port.setBaudRate(baud_rate)
    good, said = checked(sdk, packets), {}

    said["model"] = good(packets.ping(port, 2))
    said["missing"] = once.ping(port, 9)[1] == sdk.COMM_RX_TIMEOUT
    for servo in (1, 2, 3):
        good(packets.write1ByteTxRx(port, servo, 55, 0))
        good(packets.write1ByteTxRx(port, servo, 33, 1))
        good(packets.write1ByteTxRx(port, servo, 55, 1))
        good(packets.write1ByteTxRx(port, servo, 40, 1))
    said["mode"] = good(packets.read1ByteTxRx(port, 3, 33))
    write = sdk.GroupSyncWrite(port, packets, 46, 2)
    for servo, velocity in ((1, 500), (2, -500), (3, 0)):
        word = sdk.SCS_TOSCS(velocity, 15)
        assert write.addParam(servo, [sdk.SCS_LOBYTE(word), sdk.SCS_HIBYTE(word)])
    assert write.txPacket() == sdk.COMM_SUCCESS
    time.sleep(0.3)
    read = sdk.GroupSyncRead(port, packets, 56, 8)
    for servo in (1, 2, 3):
        assert read.addParam(servo)
    assert read.txRxPacket() == sdk.COMM_SUCCESS
    said["velocities"] = [
        sdk.SCS_TOHOST(read.getData(servo, 58, 2), 15) for servo in (1, 2, 3)
    ]
    said["voltage"] = read.getData(1, 62, 1)
    said["temperature"] = read.getData(1, 63, 1)
    said["positions"] = feetech_positions(sdk, packets, port, good)
    port.closePort()
    return said


def feetech_scs(path, baud_rate):
    """Servos of the SCS series, whose words are big-endian."""
    import scservo_sdk as sdk

    port = sdk.PortHandler(path)
    packets = patient(sdk, sdk.PacketHandler(1))
    assert port.openPort() and port.setBaudRate(baud_rate)
    good, said = checked(sdk, packets), {}

    said["model"] = good(packets.ping(port, 2))
    read = sdk.GroupSyncRead(port, packets, 56, 8)
    write = sdk.GroupSyncWrite(port, packets, 42, 2)
    goals = {1: 442, 2: 582, 3: 512}
    for servo, goal in goals.items():
        assert read.addParam(servo)
        good(packets.write1ByteTxRx(port, servo, 48, 0))
        good(packets.write2ByteTxRx(port, servo, 9, 430))
        good(packets.write2ByteTxRx(port, servo, 11, 594))
        good(packets.write1ByteTxRx(port, servo, 48, 1))
        # The EEPROM is locked.
        good(packets.write2ByteTxRx(port, servo, 9, 0))
        good(packets.write2ByteTxRx(port, servo, 46, 40))
        assert write.addParam(servo, [sdk.SCS_LOBYTE(goal), sdk.SCS_HIBYTE(goal)])
    said["sync_read"] = read.txRxPacket() == sdk.COMM_SUCCESS
    said["limits"] = [good(packets.read2ByteTxRx(port, 1, address)) for address in (9, 11)]
    assert write.txPacket() == sdk.COMM_SUCCESS
    for servo in goals:
        good(packets.write1ByteTxRx(port, servo, 40, 1))
    time.sleep(0.3)
    velocities = [good(packets.read2ByteTxRx(port, servo, 58)) for servo in goals]
    said["velocities"] = [sdk.SCS_TOHOST(velocity, 15) for velocity in velocities]
    time.sleep(3.0)
    positions = [good(packets.read2ByteTxRx(port, servo, 56)) for servo in goals]
    said["arrived"] = all(abs(at - goal) < 4 for at, goal in zip(positions, goals.values()))
    # Beyond its limit, the servo stays at the limit.
    good(packets.write2ByteTxRx(port, 1, 42, 100))
    time.sleep(1.0)
    said["limited"] = abs(good(packets.read2ByteTxRx(port, 1, 56)) - 430) < 4
    said["voltage"] = good(packets.read1ByteTxRx(port, 1, 62))
    said["temperature"] = good(packets.read1ByteTxRx(port, 1, 63))
    port.closePort()
    return said


if __name__ == "__main__":
    kind, path, baud_rate = sys.argv[1:]
    masters = {"dynamixel": dynamixel, "feetech": feetech, "feetech-scs": feetech_scs}
    print(json.dumps(masters[kind](path, int(baud_rate))))
