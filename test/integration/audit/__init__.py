"""An independent computation of the results of analyze for random platoons, without code of the package: see ../audit_test.py."""

from mpmath import mp

mp.dps = 120
