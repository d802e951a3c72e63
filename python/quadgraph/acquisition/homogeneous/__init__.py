"""Coefficients that are the same throughout."""
