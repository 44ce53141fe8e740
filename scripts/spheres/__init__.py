"""Parts of scripts/sphere."""
