"""Hostile inputs by seed: cases drawn from families, each run in a limited child and judged (docs/limits.md)."""
