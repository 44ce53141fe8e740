"""Figures of archives."""
