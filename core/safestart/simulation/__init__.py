"""Closed-loop flights: a controller in a plant, watched at all times.

``loop`` flies any controller in any ``plant`` under any constraints and returns a ``record``; ``watch`` is a flight in
progress, ``planar`` its compiled form (kernels in ``passage``). ``noise`` models disturbances and errors, ``starts``
makes starts. ``compiled_loop`` flies paper 000's controller thousands of times.
"""
