"""Many independent runs: what one of them is, and who runs them."""
