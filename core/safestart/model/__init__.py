"""The frozen parts of every question, in SI units, and the comparison of regions on one grid."""
