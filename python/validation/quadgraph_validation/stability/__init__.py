"""Where methods fail, and whether they say so: what `quadgraph stability` runs (docs/stability.md)."""
