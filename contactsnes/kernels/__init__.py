"""What is computed in C: its text, made of formulas."""
