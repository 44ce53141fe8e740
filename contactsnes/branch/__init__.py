"""From a scene and a load path to its branch of converged points: the Python face."""
