"""The simulated bus is understood by dynamixel-sdk as a real one would be."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing

import pytest
from dynamixel_sdk import (
    COMM_RX_TIMEOUT,
    COMM_SUCCESS,
    GroupSyncRead,
    GroupSyncWrite,
    PortHandler,
    Protocol2PacketHandler,
)

from btlang.devices.dynamixel import control_table as table
from btlang.devices.dynamixel.fake_bus import FakeBus, FakeServo

HANDLER = Protocol2PacketHandler()
ERROR_LIMIT, ERROR_ACCESS, ERROR_RANGE, ALERT = 6, 7, 4, 128


@pytest.fixture
def bus() -> Iterator[FakeBus]:
    with FakeBus([FakeServo(1), FakeServo(2, model=1020), FakeServo(7, model=1220)]) as found:
        yield found


@pytest.fixture
def port(bus: FakeBus, monkeypatch: pytest.MonkeyPatch) -> Iterator[PortHandler]:
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 250)  # ms; a busy machine answers later than a bus
    found = PortHandler(bus.port)
    found.setBaudRate(1_000_000)
    with closing(found.ser):
        yield found


def test_servos_are_found(port: PortHandler) -> None:
    assert HANDLER.ping(port, 2) == (1020, COMM_SUCCESS, 0)
    assert HANDLER.ping(port, 3)[1] == COMM_RX_TIMEOUT
    assert HANDLER.broadcastPing(port) == ({1: [1060, 46], 2: [1020, 46], 7: [1220, 46]}, COMM_SUCCESS)


def test_values_are_written_and_read(bus: FakeBus, port: PortHandler) -> None:
    assert HANDLER.write4ByteTxRx(port, 1, 108, 0x01FDFFFF) == (COMM_SUCCESS, 0)
    assert HANDLER.read4ByteTxRx(port, 1, 108) == (0x01FDFFFF, COMM_SUCCESS, 0), "with byte stuffing"
    assert HANDLER.write1ByteTxRx(port, 1, table.TORQUE, 1) == (COMM_SUCCESS, 0)
    assert bus.servos[1].has_torque


def test_values_are_refused(bus: FakeBus, port: PortHandler) -> None:
    servo = bus.servos[1]
    assert HANDLER.write4ByteTxRx(port, 1, table.GOAL_POSITION, 5000) == (COMM_SUCCESS, ERROR_LIMIT)
    HANDLER.write1ByteTxRx(port, 1, table.TORQUE, 1)
    assert HANDLER.write1ByteTxRx(port, 1, table.OPERATING_MODE, 4) == (COMM_SUCCESS, ERROR_ACCESS)
    servo.memory[table.WATCHDOG] = table.WATCHDOG_TRIPPED
    assert HANDLER.write4ByteTxRx(port, 1, table.GOAL_POSITION, 2000) == (COMM_SUCCESS, ERROR_RANGE)
    servo.fail(0x20)
    assert HANDLER.read1ByteTxRx(port, 1, table.HARDWARE_ERROR) == (0x20, COMM_SUCCESS, ALERT)
    HANDLER.reboot(port, 1)
    assert HANDLER.read1ByteTxRx(port, 1, table.HARDWARE_ERROR) == (0, COMM_SUCCESS, 0)


@pytest.mark.parametrize("fast", [False, True])
def test_several_are_written_and_read_at_once(bus: FakeBus, port: PortHandler, fast: bool) -> None:
    write = GroupSyncWrite(port, HANDLER, table.PROFILE_VELOCITY, table.GOAL.size)
    read = GroupSyncRead(port, HANDLER, table.PROFILE_VELOCITY, table.GOAL.size)
    for id in bus.servos:
        write.addParam(id, list(table.GOAL.pack(5, 2000 + id)))
        read.addParam(id)
        bus.servos[id].write(table.TORQUE, b"\1")  # without torque, the goal follows the shaft
    assert write.txPacket() == COMM_SUCCESS
    assert (read.fastSyncRead() if fast else read.txRxPacket()) == COMM_SUCCESS
    assert {id: read.getData(id, table.GOAL_POSITION, 4) for id in bus.servos} == {1: 2001, 2: 2002, 7: 2007}


@pytest.mark.parametrize(("id", "first"), [(1, 224), (7, 208)])
def test_indirect_addresses_show_what_they_point_to(port: PortHandler, id: int, first: int) -> None:
    assert HANDLER.write2ByteTxRx(port, id, table.INDIRECT_ADDRESS + 2, table.TEMPERATURE) == (COMM_SUCCESS, 0)
    assert HANDLER.read1ByteTxRx(port, id, first + 1) == (30, COMM_SUCCESS, 0)


def test_a_servo_behind_a_silent_one_waits_in_vain(bus: FakeBus, port: PortHandler) -> None:
    bus.servos[2].silent = True
    read = GroupSyncRead(port, HANDLER, table.POSITION, 4)
    for id in bus.servos:
        read.addParam(id)
    read.txPacket()
    assert HANDLER.readRx(port, 1, 4)[1] == COMM_SUCCESS
    port.setPacketTimeoutMillis(20)
    assert HANDLER.readRx(port, 7, 4)[1] == COMM_RX_TIMEOUT
