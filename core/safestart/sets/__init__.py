"""Convex sets by their support functions, and the test whether one meets the corridor.

Directions: the planar corridor {y >= r_h, |x| <= x0 + c_x (y - r_h)} is a convex set that recedes in +y, so a
convex set R misses it exactly when some direction d = (sin a, cos a), |tan a| <= 1/c_x, of the dual cone
separates the two. Everything here works with that one angle ``a``, measured in the body frame from +y
towards +x. With sigma_R the support function of R, the margin

    m = min over a of  [ sigma_R(d) + x0 |sin a| - r_h cos a ]

is in metres: negative, it is minus the distance from R to the corridor; positive, it is how far R can be
pushed in the worst direction before the two part.
"""
