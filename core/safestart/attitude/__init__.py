"""How the target turns: ``attitude`` is the interface; ``spin``, ``torque_free`` and ``table`` implement it.

``in_lvlh`` converts an attitude from inertial axes to LVLH, ``body_frame`` holds the planar formulas.
"""
