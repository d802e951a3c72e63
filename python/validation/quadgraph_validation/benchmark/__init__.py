"""What `quadgraph bench` measures: passes, convergence of the solvers, other people's solvers, growth with size."""
