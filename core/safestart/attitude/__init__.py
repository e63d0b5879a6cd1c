"""How the target turns: ``attitude`` is the interface, ``spin`` the steady one, ``body_frame`` its planar formulas."""
