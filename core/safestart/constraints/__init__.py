"""What must hold at every time of a flight: ``constraint`` is the interface; polyhedra, and sets of accelerations."""
