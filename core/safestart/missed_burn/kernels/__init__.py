"""Compiled searches of the missed-burn proof, and the linear motion integrated with the true one."""
