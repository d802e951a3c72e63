"""Coefficients that differ from place to place."""
