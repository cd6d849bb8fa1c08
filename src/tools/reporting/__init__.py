"""The parts of the program report."""
