"""Guidance laws and the flights they fly: the three-regime controller with its filter (paper 000), and sequence MPC.

``gains`` holds the tuned and the paper's settings, ``regimes`` the nominal command, ``projection`` and
``least_violation`` the two small solvers of ``safety_filter`` (eq. 7), ``plan`` what is tabulated once per scenario.
``sequence_mpc`` plans whole thrust sequences, ``least_fuel`` is its cone program. ``truth`` says what the world does
beyond the plan, ``passage`` flies one interval and watches the corridor, ``flight`` is the compiled loop of the filter,
``pilots`` flies any controller in any of the ``worlds``; ``trajectory`` keeps one flight with its whole history.
"""
