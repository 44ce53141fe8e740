"""Branches of equilibria of any system: points, steps along load and arc length, folds, events,
bifurcations."""
