"""Figures of a platoon: measured statistics beside theory. One module per figure; `plot` is the command line."""
