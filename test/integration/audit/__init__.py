"""What analyze says of random platoons, computed again with nothing of the package: see ../audit_test.py."""

from mpmath import mp

mp.dps = 120
