"""No more than the scene needs: what a bake for an error budget measures, chooses and says."""
