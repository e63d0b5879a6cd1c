"""How the target turns: ``attitude`` is the interface, every other file is one way; ``body_frame`` is the planar case."""
