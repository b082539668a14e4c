"""Attitude estimators that run over the sensor messages of a log, to compare with its own."""

from __future__ import annotations

from math import degrees, radians
from typing import Any

from mavwire.mavextra import state
from mavwire.rotmat import Matrix3, Vector3

__all__ = [
    "DCM_State", "DCM_update", "PX4_State", "PX4_update",
]  # fmt: skip


class DCM_State:
    """Two rotation matrices driven by the gyros at 50 Hz, ``dcm2`` with coning correction.

    The angles given are degrees, those kept radians.
    """

    def __init__(self, roll: float, pitch: float, yaw: float) -> None:
        self.dcm = Matrix3()
        self.dcm.from_euler(radians(roll), radians(pitch), radians(yaw))
        self.dcm2 = self.dcm.copy()
        self.mag, self.gyro, self.accel = Vector3(), Vector3(), Vector3()
        self.gps: Any = None
        self.rate, self.kp, self.kp_yaw = 50.0, 0.2, 0.3
        self.omega_P, self.omega_P_yaw = Vector3(), Vector3()
        self.omega_I, self.omega_I_sum, self.omega_I_sum_time = Vector3(), Vector3(), 0
        self.omega, self.ra_sum = Vector3(), Vector3()
        self.last_delta_angle, self.last_velocity = Vector3(), Vector3()
        self._take_angles()

    def _take_angles(self) -> None:
        self.roll, self.pitch, self.yaw = self.dcm.to_euler()
        self.roll2, self.pitch2, self.yaw2 = self.dcm2.to_euler()

    def update(self, gyro: Vector3, accel: Vector3, mag: Vector3, GPS: Any) -> None:
        """Take one sample of rad/s and m/s^2; the same sample again is ignored."""
        if self.gyro == gyro and self.accel == accel:
            return
        self.gyro, self.accel = gyro.copy(), accel.copy()
        delta_angle = gyro * (1.0 / self.rate)
        coning = (self.last_delta_angle % delta_angle) * (1.0 / 12.0)
        self.dcm.rotate(delta_angle)
        self.dcm.normalize()
        self.dcm2.rotate(delta_angle + coning)
        self.dcm2.normalize()
        self.last_delta_angle = delta_angle
        self._take_angles()


class PX4_State:
    """A rotation matrix driven by the gyros.

    The angles given are degrees, those kept radians; ``timestamp`` is in seconds.
    """

    def __init__(self, roll: float, pitch: float, yaw: float, timestamp: float) -> None:
        self.dcm = Matrix3()
        self.dcm.from_euler(radians(roll), radians(pitch), radians(yaw))
        self.gyro, self.accel = Vector3(), Vector3()
        self.timestamp = timestamp
        self.roll, self.pitch, self.yaw = self.dcm.to_euler()

    def update(self, gyro: Vector3, accel: Vector3, timestamp: float) -> None:
        """Take one sample of rad/s and m/s^2; the same sample again is ignored."""
        if self.gyro == gyro and self.accel == accel:
            return
        self.gyro, self.accel = gyro.copy(), accel.copy()
        self.dcm.rotate(gyro * (timestamp - self.timestamp))
        self.dcm.normalize()
        self.timestamp = timestamp
        self.roll, self.pitch, self.yaw = self.dcm.to_euler()


def DCM_update(IMU: Any, ATT: Any, MAG: Any, GPS: Any) -> DCM_State:
    """The DCM estimator after this sample; the first call starts it at ATT."""
    if state.SCALARS["dcm_state"] is None:
        state.SCALARS["dcm_state"] = DCM_State(ATT.Roll, ATT.Pitch, ATT.Yaw)
    estimator: DCM_State = state.SCALARS["dcm_state"]
    estimator.update(
        Vector3(IMU.GyrX, IMU.GyrY, IMU.GyrZ),
        Vector3(IMU.AccX, IMU.AccY, IMU.AccZ),
        Vector3(MAG.MagX, MAG.MagY, MAG.MagZ),
        GPS,
    )
    return estimator


def PX4_update(IMU: Any, ATT: Any) -> PX4_State:
    """The PX4 estimator after this sample; the first call starts it at ATT (radians)."""
    if state.SCALARS["px4_state"] is None:
        roll, pitch, yaw = degrees(ATT.Roll), degrees(ATT.Pitch), degrees(ATT.Yaw)
        state.SCALARS["px4_state"] = PX4_State(roll, pitch, yaw, IMU._timestamp)
    estimator: PX4_State = state.SCALARS["px4_state"]
    estimator.update(
        Vector3(IMU.GyroX, IMU.GyroY, IMU.GyroZ),
        Vector3(IMU.AccX, IMU.AccY, IMU.AccZ),
        IMU._timestamp,
    )
    return estimator
