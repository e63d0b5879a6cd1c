"""Guidance laws: the three-regime controller, its single-input safety filter and the flights they fly (paper 000).

``gains`` holds the tuned and the paper's settings, ``regimes`` the nominal command, ``projection`` and
``least_violation`` the two small solvers of ``safety_filter`` (eq. 7), ``plan`` what is tabulated once per
scenario, ``flight`` the closed loop against exact CWH truth, ``trajectory`` one flight with its whole history.
"""
