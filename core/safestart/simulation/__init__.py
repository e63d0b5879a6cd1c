"""Closed-loop flights: a controller in a plant, watched at all times.

``loop`` flies any controller in any ``plant`` under any constraints and returns a ``record``; ``watch`` is the flight
under way, ``planar`` its compiled form (kernels in ``passage``). ``noise`` is what the world does beyond the plan,
``starts`` makes starts. ``compiled_loop`` flies paper 000's controller by the thousand.
"""
