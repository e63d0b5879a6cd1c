"""How the target turns: ``attitude`` is the interface, ``body_frame`` the planar case, every other file one way."""
