"""How the target turns: ``attitude`` is the interface; ``spin``, ``torque_free`` and ``table`` the ways to turn.

``in_lvlh`` takes an attitude from inertial axes to LVLH, ``body_frame`` holds the planar formulas.
"""
