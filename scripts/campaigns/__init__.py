"""What `scripts/campaign` is made of."""
