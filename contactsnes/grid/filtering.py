"""Products with symbols, which every pair of transforms can do."""


class Filtering:
    """Base of pairs of transforms: ``forward`` from ``real`` to ``spectrum``, and ``backward``."""

    def filter(self, symbol):
        """Multiply what stands in ``real`` by real symbols (count, *spectrum) of its precision, in
        place."""
        self.forward()
        self.spectrum *= symbol
        self.backward()
