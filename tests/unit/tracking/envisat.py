"""Paper 002's target, Table I."""

import math

import numpy as np

from safestart.control.tracking_mpc.controller import Program
from safestart.control.tracking_mpc.sampled import Sampled
from safestart.control.tracking_mpc.theta_set import theta_set
from safestart.control.tracking_mpc.tumble import Tumble
from safestart.control.tracking_mpc.tuning import DockingCorridor, Tuning

INERTIA = ((17023.3, 397.1, -2171.4), (397.1, 124825.7, 344.2), (-2171.4, 344.2, 129112.2))
MEAN_MOTION = math.sqrt(3.986004418e14 / 7_144_800.0**3)
RATE = math.radians(3.53)
SHAPE = DockingCorridor()
START = np.array([1.5, 2.5, 1.5, 0.0, 0.0, 0.0])


def envisat(reference="lvlh", rate=(0.0, RATE, RATE)):
    return Tumble(INERTIA, (1.0, 0.0, 0.0, 0.0), rate, MEAN_MOTION, reference)


TUNED = Tuning()


def program(tuning=TUNED, period=1.0, window=300, tumble=None, tightening=None, held=False):
    tumble = tumble or envisat()
    motion = Sampled(MEAN_MOTION, period, held)
    attitudes = tumble.nodes(period, window)
    limit = theta_set(tuning, SHAPE, tumble, motion, attitudes)
    return Program(motion, SHAPE, tuning, limit, tightening), attitudes
