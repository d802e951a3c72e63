"""Studies of QuadGraph: independent truth, accuracy, stability, charts, the papers' tables, other solvers."""
