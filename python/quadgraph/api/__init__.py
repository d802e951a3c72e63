"""What `import quadgraph` gives: typed classes around the compiled engine."""
