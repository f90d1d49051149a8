"""Gratings: whose peak is whose, and wavelengths as strain and temperature."""
