"""Reads an emulated bus with the vendors' SDKs, and prints the values as JSON.

    drives_masters.py dynamixel PORT BAUD_RATE
    drives_masters.py feetech PORT BAUD_RATE
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
    port.closePort()
    return said


if __name__ == "__main__":
    kind, path, baud_rate = sys.argv[1:]
    print(json.dumps({"dynamixel": dynamixel, "feetech": feetech}[kind](path, int(baud_rate))))
