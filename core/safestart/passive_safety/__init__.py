"""Proofs about the switched rendezvous of paper 003: reach tubes of an affine hybrid system, and passive safety.

Units in this package are those of the published model: metres, minutes, kilograms (hence kg m/min^2 for thrust);
:mod:`safestart.passive_safety.model` states the conversions. State: (x, y, vx, vy), x radial and y along-track in
Hill's frame of the target (the axes of the safe-start family), metres and metres per minute.
"""
