"""The page of rough surfaces, made by scripts/rough."""
