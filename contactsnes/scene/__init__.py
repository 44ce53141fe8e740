"""What is solved, as frozen data: scene, load path and steps, their units, and the resolution of
the cohesive zone."""
