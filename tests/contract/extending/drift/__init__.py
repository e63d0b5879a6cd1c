"""An example process, as docs/extending.md describes one: how close a chaser drifts without thrust."""
