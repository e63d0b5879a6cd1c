"""From a state to a command: controllers, and the laws and small solvers behind them.

``controller`` is the interface. ``three_regimes`` is paper 000's: ``regimes`` gives the nominal command with the
``gains``, ``safety_filter`` keeps it admissible (eq. 7) with what ``forecast`` tabulates; ``least_violation`` is its
fallback. ``sequence_mpc`` plans whole thrust sequences, ``least_fuel`` is its cone program. ``pd`` and ``escape`` are
paper 001's, ``switched_lqr`` is paper 003's.
"""
