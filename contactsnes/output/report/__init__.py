"""An archive as one page of HTML, which needs nothing else: words, curves, fields, certificates."""
